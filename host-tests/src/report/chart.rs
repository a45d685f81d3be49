//! Cost against error as a picture.

use std::error::Error;
use std::ops::Range;

use firmware::measure::SUBJECTS;
use plotters::prelude::*;

use super::scene::Scene;
use super::speed::Priced;
use crate::board::Board;

const SIZE: (u32, u32) = (900, 600);
/// Points outside are not drawn.
const ERRORS: Range<f64> = 1e-14..10.0;
const FONT: &str = "sans-serif";

/// Estimated cycles per simulated second against the error, one line for each arithmetic, as SVG.
pub fn speed_against_error(priced: &[Priced], scene: &Scene, board: &Board) -> Result<String, Box<dyn Error>> {
    let shown: Vec<_> = priced.iter().filter(|one| one.point.scene == scene && one.board == board).collect();
    let cycles = shown.iter().map(|one| one.cycles);
    let (least, most) = cycles.fold((f64::INFINITY, 0.0_f64), |(least, most), next| (least.min(next), most.max(next)));

    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .caption(format!("{}, {}", scene.title, board.cpu), (FONT, 20))
            .margin(12)
            .x_label_area_size(45)
            .y_label_area_size(75)
            .build_cartesian_2d(ERRORS.log_scale(), (least / 2.0..most * 2.0).log_scale())?;
        chart
            .configure_mesh()
            .x_desc("largest error of an angle, rad")
            .y_desc("estimated cycles per simulated second")
            .x_label_formatter(&|error| format!("{error:.0e}"))
            .y_label_formatter(&|cycles| format!("{cycles:.0e}"))
            .light_line_style(TRANSPARENT)
            .draw()?;
        for (index, subject) in SUBJECTS.iter().enumerate() {
            let colour = Palette99::pick(index).mix(0.9);
            let line = shown.iter().filter(|one| one.point.subject == subject);
            let line: Vec<_> = line.map(|one| (one.point.error.angle, one.cycles)).collect();
            let line: Vec<_> = line.into_iter().filter(|(error, _)| ERRORS.contains(error)).collect();
            chart
                .draw_series(LineSeries::new(line.iter().copied(), colour.stroke_width(2)))?
                .label(subject.name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
            chart.draw_series(line.into_iter().map(|point| Circle::new(point, 3, colour.filled())))?;
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.3))
            .label_font((FONT, 13))
            .draw()?;
        area.present()?;
    }
    Ok(svg)
}
