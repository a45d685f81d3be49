//! Both angles over the last seconds, as a chart of characters.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType};

/// How much simulated time is shown, s.
pub const SPAN: f64 = 5.0;
/// The angles that the chart may reach, degrees: the least that holds every angle shown is taken.
const REACHES: [f64; 5] = [10.0, 30.0, 60.0, 90.0, HALF_TURN];
const HALF_TURN: f64 = 180.0;
/// The colours and the marks of angle 1 and angle 2: a thin line and a thick one, which colour-blind eyes and terminals
/// tell apart, too.
const COLOURS: [Color; 2] = [Color::Cyan, Color::Yellow];
const MARKERS: [Marker; 2] = [Marker::Braille, Marker::Dot];

/// A time, s, and both angles then, degrees; turns count.
pub type Moment = (f64, [f64; 2]);

/// An angle, degrees, in (-180, 180] as it is shown: what rounds to straight up at a tenth of a degree is 180, never -180.
pub fn within_half_a_turn(degrees: f64) -> f64 {
    let tenths = (10.0 * degrees).round() / 10.0;
    degrees - 2.0 * HALF_TURN * ((tenths - HALF_TURN) / (2.0 * HALF_TURN)).ceil()
}

pub fn draw(frame: &mut Frame, area: Rect, past: &[Moment]) {
    let end = past.last().map_or(0.0, |(time, _)| *time).max(SPAN);
    let strands: Vec<_> =
        (0..2).flat_map(|rod| strands(past, rod).into_iter().map(move |strand| (rod, strand))).collect();
    let largest = strands.iter().flat_map(|(_, strand)| strand).fold(0.0_f64, |most, (_, angle)| most.max(angle.abs()));
    let reach = REACHES.into_iter().find(|reach| *reach >= largest).unwrap_or(HALF_TURN);
    let lines = strands.iter().map(|(rod, strand)| {
        let line = Dataset::default().data(strand).marker(MARKERS[*rod]).graph_type(GraphType::Line);
        line.style(COLOURS[*rod])
    });
    let faint = Style::new().dim();
    let title = Line::from(vec![
        Span::raw("angles, degrees: "),
        Span::styled("1 ⠤⠤", COLOURS[0]),
        Span::raw("  "),
        Span::styled("2 ••", COLOURS[1]),
    ]);
    let across = Axis::default().bounds([end - SPAN, end]).style(faint);
    let upwards = Axis::default().bounds([-reach, reach]).style(faint);
    let chart = Chart::new(lines.collect())
        .block(Block::bordered().title(title))
        .legend_position(None)
        .x_axis(across.labels([format!("{:.1} s", end - SPAN), format!("{end:.1} s")]))
        .y_axis(upwards.labels([format!("{:.0}", -reach), "0".to_owned(), format!("{reach:.0}")]));
    frame.render_widget(chart, area);
}

/// An angle over time within half a turn either way, cut where it passes straight up.
fn strands(past: &[Moment], rod: usize) -> Vec<Vec<(f64, f64)>> {
    // A hair above straight up is drawn on the chart's edge, not left out.
    let angle = |angles: [f64; 2]| within_half_a_turn(angles[rod]).clamp(-HALF_TURN, HALF_TURN);
    let points: Vec<_> = past.iter().map(|&(time, angles)| (time, angle(angles))).collect();
    points.chunk_by(|(_, one), (_, next)| (one - next).abs() < HALF_TURN).map(<[_]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turning_rod_is_cut_where_it_passes_straight_up() {
        let past: Vec<_> = (0..=20).map(f64::from).map(|tenth| (tenth / 10.0, [tenth * 36.0, 0.0])).collect();
        let cut = strands(&past, 0);
        // From 0 to 180 degrees, then on from just beyond, straight up and all around.
        assert_eq!(cut.iter().map(Vec::len).collect::<Vec<_>>(), [6, 10, 5]);
        assert!(cut.iter().flatten().all(|(_, angle)| *angle > -HALF_TURN && *angle <= HALF_TURN));
        assert_eq!(strands(&past, 1).len(), 1, "the other rod hangs");
    }

    #[test]
    fn straight_up_is_180_and_never_its_negative() {
        for up in [f64::from(std::f32::consts::PI).to_degrees(), 180.0, -180.0, 540.0, 180.04, -179.96] {
            assert_eq!(format!("{:.1}", within_half_a_turn(up)), "180.0", "{up}");
        }
        assert_eq!([180.1, -30.0].map(|degrees| within_half_a_turn(degrees).round()), [-180.0, -30.0]);
    }
}
