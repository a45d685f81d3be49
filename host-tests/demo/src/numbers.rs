//! The latest numbers in a column next to the panel, with the past energy errors as bars below
//! them, and a chart of both angles over the last seconds.

use double_pendulum::State;
use firmware::config::TICK_RATE;
use firmware::motion::Horizon;
use firmware::scenes::Report;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style, Stylize};
use ratatui::symbols::Marker;
use ratatui::text::Line;
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph, Sparkline};

use super::readings::{Readings, energy_error};

pub const NARROWEST: u16 = 15;
/// Beyond it a value would be too distant from its name.
const WIDEST: u16 = 24;
pub const ROWS: u16 = 13;
/// The smallest scale of the bars. Smaller errors are mainly the rounding of the energy.
const LEAST_SCALE: f32 = 1e-14;

pub fn draw(frame: &mut Frame, area: Rect, readings: &Readings) {
    let area = Rect {
        width: area.width.min(WIDEST),
        ..area
    };
    let lines: Vec<_> = rows(readings)
        .into_iter()
        .flat_map(|row| lines(row, area.width.into()))
        .collect();
    let heights = [Constraint::Length(lines.len() as u16), Constraint::Min(0)];
    let [table, bars] = Layout::vertical(heights).areas(area);
    frame.render_widget(Paragraph::new(lines), table);
    if !readings.past.is_empty() {
        energy_errors(frame, bars, &readings.past);
    }
}

fn rows(readings: &Readings) -> [(&'static str, String); 9] {
    let is_shown = readings.frame.is_some();
    let moves = readings.frame.is_some_and(|now| now.scene.has_angles());
    let now = readings.frame.unwrap_or_default();

    let degrees = readings
        .start
        .unwrap_or([now.start_angle.to_degrees(); 2])
        .map(|degrees| format!("{degrees:.1}°"));
    let start = if degrees[0] == degrees[1] {
        degrees[0].clone()
    } else {
        degrees.join(", ")
    };

    // The angles of a rod that turns over grow without limit, so they are shown within half a turn.
    let State { a1, a2, .. } = now.report.state;
    let [angle_1, angle_2] =
        [a1, a2].map(|angle| within_half_a_turn(f64::from(angle).to_degrees()));

    let rows = [
        ("time", is_shown, format!("{:.2} s", now.report.time)),
        (
            "mass ratio",
            is_shown,
            ((f64::from(now.mass_ratio) * 1e4).round() / 1e4).to_string(),
        ),
        ("start", moves, start),
        ("angle 1", moves, format!("{angle_1:.1}°")),
        ("angle 2", moves, format!("{angle_2:.1}°")),
        ("frames/s", is_shown, readings.rate().to_string()),
        ("dropped", is_shown, now.dropped.to_string()),
        ("½ pixel", is_shown, horizon(now.report.horizon)),
        (
            "energy error",
            moves && !now.scene.is_linear(),
            energy_error(now.report.energy_error, |error| format!("{error:+.1e}")),
        ),
    ];
    rows.map(|(name, is_known, value)| (name, if is_known { value } else { "-".to_owned() }))
}

/// Returns the accuracy horizon, which Braille makes unreadable on the panel itself.
fn horizon(horizon: Horizon) -> String {
    match horizon {
        Horizon::Always => "-".to_owned(),
        Horizon::Undecided => "?".to_owned(),
        Horizon::AtLeast(time) => format!(">{time:.1} s"),
        Horizon::Until(time) => format!("{time:.1} s"),
    }
}

fn lines((name, value): (&'static str, String), width: usize) -> Vec<Line<'static>> {
    let left = width.saturating_sub(name.chars().count());
    if value.chars().count() < left {
        return vec![Line::from(vec![
            name.dim(),
            format!("{value:>left$}").bold(),
        ])];
    }
    vec![
        Line::from(name).dim(),
        Line::from(format!("{value:>width$}")).bold(),
    ]
}

/// Draws the size of the energy error, the largest of each half second, as bars.
fn energy_errors(frame: &mut Frame, area: Rect, past: &[Report]) {
    const HEIGHT: f32 = 1000.0;
    const STEPS: u64 = TICK_RATE as u64 / 2;
    let largest = |bar: &[Report]| {
        bar.iter()
            .map(|report| report.energy_error.abs())
            .fold(0.0, f32::max)
    };
    let errors: Vec<_> = past
        .chunk_by(|one, next| one.step / STEPS == next.step / STEPS)
        .map(largest)
        .collect();

    let shown = &errors[errors.len().saturating_sub(area.width.into())..];
    let exponent = shown
        .iter()
        .copied()
        .fold(LEAST_SCALE, f32::max)
        .log10()
        .ceil() as i32;

    let long = format!("bars: full height 1e{exponent}");
    let scale = if long.len() <= usize::from(area.width) {
        long
    } else {
        format!("bars to 1e{exponent}")
    };
    let scale = Block::new().title(scale.dim());

    // The bars are whole numbers, so they are scaled to `HEIGHT` steps.
    let bars = shown
        .iter()
        .map(|error| (error / 10.0_f32.powi(exponent) * HEIGHT) as u64)
        .collect::<Vec<_>>();
    frame.render_widget(
        Sparkline::default()
            .data(bars)
            .max(HEIGHT as u64)
            .fg(Color::Yellow)
            .block(scale),
        area,
    );
}

const SPAN: f64 = 5.0;
const REACHES: [f64; 5] = [10.0, 30.0, 60.0, 90.0, HALF_TURN];
const HALF_TURN: f64 = 180.0;
/// A thin and a thick line can also be distinguished without colours.
const COLOURS: [Color; 2] = [Color::Cyan, Color::Yellow];
const MARKERS: [Marker; 2] = [Marker::Braille, Marker::Dot];

/// An angle that rounds to straight up at a tenth of a degree is 180, never -180.
fn within_half_a_turn(degrees: f64) -> f64 {
    const ROUNDING: f64 = 0.05;
    degrees - 2.0 * HALF_TURN * ((degrees - HALF_TURN - ROUNDING) / (2.0 * HALF_TURN)).ceil()
}

pub fn draw_angles(frame: &mut Frame, area: Rect, past: &[Report]) {
    let end = past.last().map_or(0.0, |last| last.time).max(SPAN);
    let past = &past[past.partition_point(|report| report.time < end - SPAN)..];
    let strands: Vec<_> = (0..2)
        .flat_map(|rod| {
            strands(past, rod)
                .into_iter()
                .map(move |strand| (rod, strand))
        })
        .collect();

    let largest = strands
        .iter()
        .flat_map(|(_, strand)| strand)
        .fold(0.0_f64, |most, (_, angle)| most.max(angle.abs()));
    let reach = REACHES
        .into_iter()
        .find(|reach| *reach >= largest)
        .unwrap_or(HALF_TURN);

    let lines = strands.iter().map(|(rod, strand)| {
        let line = Dataset::default().data(strand).graph_type(GraphType::Line);
        line.marker(MARKERS[*rod]).style(COLOURS[*rod])
    });

    let faint = Style::new().dim();
    let title = Line::from(vec![
        "angles, degrees: ".into(),
        "1 ⠤⠤  ".fg(COLOURS[0]),
        "2 ••".fg(COLOURS[1]),
    ]);
    let across = Axis::default().bounds([end - SPAN, end]).style(faint);
    let upwards = Axis::default().bounds([-reach, reach]).style(faint);
    let chart = Chart::new(lines.collect())
        .block(Block::bordered().title(title))
        .legend_position(None)
        .x_axis(across.labels([format!("{:.1} s", end - SPAN), format!("{end:.1} s")]))
        .y_axis(upwards.labels([
            format!("{:.0}", -reach),
            "0".to_owned(),
            format!("{reach:.0}"),
        ]));
    frame.render_widget(chart, area);
}

/// Returns the curve of an angle within half a turn, cut where the rod passes straight up.
fn strands(past: &[Report], rod: usize) -> Vec<Vec<(f64, f64)>> {
    let point = |Report { time, state, .. }: &Report| {
        let angle = within_half_a_turn(f64::from([state.a1, state.a2][rod]).to_degrees());

        // An angle slightly above straight up is drawn on the chart's edge.
        (*time, angle.clamp(-HALF_TURN, HALF_TURN))
    };
    let points: Vec<_> = past.iter().map(point).collect();
    points
        .chunk_by(|(_, one), (_, next)| (one - next).abs() < HALF_TURN)
        .map(<[_]>::to_vec)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turning_rod_is_cut_where_it_passes_straight_up() {
        let turned = |tenth: u8| State {
            a1: (f32::from(tenth) * 36.0).to_radians(),
            ..State::default()
        };
        let report = |tenth| Report {
            time: f64::from(tenth) / 10.0,
            state: turned(tenth),
            ..Report::default()
        };
        let past: Vec<_> = (0..=20).map(report).collect();
        let cut = strands(&past, 0);

        assert_eq!(cut.iter().map(Vec::len).collect::<Vec<_>>(), [6, 10, 5]);
        assert!(
            cut.iter()
                .flatten()
                .all(|(_, angle)| *angle > -HALF_TURN && *angle <= HALF_TURN)
        );
        assert_eq!(strands(&past, 1).len(), 1, "the other rod hangs");
    }

    #[test]
    fn straight_up_is_180_and_never_its_negative() {
        for up in [
            f64::from(std::f32::consts::PI).to_degrees(),
            180.0,
            -180.0,
            540.0,
            180.04,
            -179.96,
        ] {
            assert_eq!(format!("{:.1}", within_half_a_turn(up)), "180.0", "{up}");
        }
        assert_eq!(
            [180.1, -30.0].map(|degrees| within_half_a_turn(degrees).round()),
            [-180.0, -30.0]
        );
    }
}
