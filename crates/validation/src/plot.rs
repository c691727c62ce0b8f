//! Plots of error against Δt.

use crate::convergence::{Curve, Study};
use crate::report::short;
use crate::stepped_scene::CaseFailure;
use plotters::prelude::*;

const SIZE: (u32, u32) = (640, 400);
const F64: RGBColor = RGBColor(33, 86, 140);
const F32: RGBColor = RGBColor(194, 24, 91);
const INK: RGBColor = RGBColor(35, 33, 31);
const PAPER: RGBColor = RGBColor(251, 250, 247);

/// Both axes logarithmic, both precisions, as SVG.
///
/// # Errors
/// When the plot cannot be drawn: no point, or an error that is 0.
pub fn plot(study: &Study, curve: &Curve) -> Result<String, CaseFailure> {
    let mut text = String::new();
    draw(&mut text, study, curve)
        .map_err(|error| CaseFailure::Unexpected(format!("plot of {}: {error}", study.name)))?;
    Ok(text)
}

fn draw(text: &mut String, study: &Study, curve: &Curve) -> Result<(), Box<dyn std::error::Error>> {
    let steps = || curve.points.iter().map(|point| point.0);
    let errors = || curve.points.iter().flat_map(|point| [point.1, point.2]);
    let range = |low: f64, high: f64, room: f64| (low / room)..(high * room);
    let low = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min);
    let high = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let across = range(low(&mut steps()), high(&mut steps()), 1.3);
    let up = range(low(&mut errors()), high(&mut errors()), 2.0);
    let root = SVGBackend::with_string(text, SIZE).into_drawing_area();
    root.fill(&PAPER)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(14)
        .caption(study.title, ("sans-serif", 15, &INK))
        .x_label_area_size(42)
        .y_label_area_size(66)
        .build_cartesian_2d(across.log_scale(), up.log_scale())?;
    chart
        .configure_mesh()
        .bold_line_style(INK.mix(0.12))
        .light_line_style(TRANSPARENT)
        .max_light_lines(0)
        .x_desc("Δt in s")
        .y_desc("relative error")
        .x_label_formatter(&label)
        .y_label_formatter(&label)
        .draw()?;
    let name = study.order.map_or_else(|| "f64".to_owned(), |_| format!("f64, order {:.2}", curve.order));
    let series = [(name, F64, 0), ("f32".to_owned(), F32, 1)];
    for (name, colour, which) in series {
        let points = curve.points.iter().map(|&(step, f64, f32)| (step, if which == 0 { f64 } else { f32 }));
        chart
            .draw_series(LineSeries::new(points, colour.stroke_width(2)).point_size(3))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
    }
    chart.configure_series_labels().position(SeriesLabelPosition::LowerRight).background_style(PAPER).draw()?;
    root.present()?;
    Ok(())
}

/// What stands at an axis: 1, 2 and 5 of each decade, since all nine do not fit.
fn label(value: &f64) -> String {
    // Positions on the axis are powers, which rounding leaves a little beside the digit.
    let text = format!("{value:.1e}");
    let shown = ["1.0e", "2.0e", "5.0e"].iter().any(|digit| text.starts_with(digit));
    if shown { short(*value) } else { String::new() }
}
