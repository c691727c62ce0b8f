//! Plots of error against Δt.

use crate::convergence::{Curve, Study};
use rockproof_bench::plot::{Legend, Marks, Plot, PlotAxis, PlotError, Series};

/// Both axes logarithmic, both precisions, as SVG.
///
/// # Errors
/// When the plot cannot be drawn: no point.
pub fn plot(study: &Study, curve: &Curve) -> Result<String, PlotError> {
    let name = study.order.map_or_else(|| "f64".to_owned(), |_| format!("f64, order {:.2}", curve.order));
    let f64 = curve.points.iter().map(|&(step, f64, _)| [step, f64]).collect();
    let f32 = curve.points.iter().map(|&(step, _, f32)| [step, f32]).collect();
    let series = [(name, f64), ("f32".to_owned(), f32)].map(|(name, points)| Series {
        name,
        points,
        intervals: Vec::new(),
        titles: Vec::new(),
        marks: Marks::Joined,
    });
    Plot {
        title: study.title.to_owned(),
        x: PlotAxis::log("Δt (s)"),
        y: PlotAxis::log("relative error"),
        series: series.into(),
        legend: Legend::Beside,
    }
    .svg()
}
