//! Curves, bars, heat maps.

use super::LINE;
use super::drawing::{Anchor, Drawing, Label, Stroke, between, coordinate, light_color};
use super::frame::Frame;
use crate::chart::{BarSeries, Chart, ChartColor, ChartContent, Curve, HeatMap, LineStyle, PointLook};
use std::io;

/// The radius of points that lines join, and of others.
const SMALL: f64 = 3.0;
const LARGE: f64 = 4.5;

fn color(color: ChartColor) -> &'static str {
    light_color(&color.name())
}

/// The names of a legend: none where there is one curve without a name.
pub(super) fn legend_names(chart: &Chart) -> Vec<&str> {
    match &chart.content {
        ChartContent::Curves(curves, _) => {
            curves.iter().map(|curve| &*curve.name).filter(|name| !name.is_empty()).collect()
        }
        ChartContent::Bars(series) => series.iter().map(|series| &*series.name).collect(),
        ChartContent::Map(_) => Vec::new(),
    }
}

/// What stands before the name of that number in a legend.
pub(super) fn legend_mark(drawing: &mut Drawing<'_>, chart: &Chart, number: usize, [x, y]: [f64; 2]) -> io::Result<()> {
    match &chart.content {
        ChartContent::Curves(curves, _) => {
            let Some(curve) = curves.iter().filter(|curve| !curve.name.is_empty()).nth(number) else { return Ok(()) };
            if let Some(style) = curve.line {
                drawing.line(&[[x, y], [x + 20.0, y]], &stroke(curve, style))?;
            }
            match curve.marker {
                Some(marker) => mark(drawing, curve, marker, &PointLook::Plain, [x + 10.0, y]),
                None => Ok(()),
            }
        }
        ChartContent::Bars(series) => match series.get(number) {
            Some(series) => drawing.rectangle([x + 4.0, y - 5.0, 16.0, 10.0], color(series.color)),
            None => Ok(()),
        },
        ChartContent::Map(_) => Ok(()),
    }
}

/// The numbered points, in order: those that have a ring.
pub(super) fn key_of(content: &ChartContent) -> Vec<String> {
    let ChartContent::Curves(curves, _) = content else { return Vec::new() };
    let points = curves.iter().flat_map(|curve| &curve.points);
    let labels = points.filter_map(|point| match &point.look {
        PointLook::Ringed(label) => Some(label),
        PointLook::Plain | PointLook::Open => None,
    });
    labels.enumerate().map(|(number, label)| format!("{} {label}", number + 1)).collect()
}

fn stroke(curve: &Curve, style: LineStyle) -> Stroke<'static> {
    let dashes = match style {
        LineStyle::Solid | LineStyle::Steps => "",
        LineStyle::Dotted => "2 3",
        LineStyle::DashedSteps => "7 4",
    };
    Stroke { color: color(curve.color), width: 1.6, dashes }
}

/// Curves, below them the value they are held against.
pub(super) fn curves(
    drawing: &mut Drawing<'_>,
    frame: &Frame<'_>,
    curves: &[Curve],
    limit: Option<f64>,
) -> io::Result<()> {
    if let Some(y) = limit.and_then(|limit| frame.y.place(limit)) {
        let [left, right] = frame.x.pixels;
        drawing.line(&[[left, y], [right, y]], &Stroke { color: light_color("good"), width: 1.5, dashes: "6 4" })?;
    }
    for curve in curves {
        if let Some(style) = curve.line {
            // A point without a value breaks the line.
            let places: Vec<Option<[f64; 2]>> = curve.points.iter().map(|p| frame.place(p.x, p.y)).collect();
            for part in places.split(Option::is_none) {
                let mut line: Vec<[f64; 2]> = Vec::new();
                for at in part.iter().flatten() {
                    if let (LineStyle::Steps | LineStyle::DashedSteps, Some([_, before])) = (style, line.last()) {
                        line.push([at[0], *before]);
                    }
                    line.push(*at);
                }
                if line.len() > 1 {
                    drawing.line(&line, &stroke(curve, style))?;
                }
            }
        }
        for point in &curve.points {
            let (Some([x, y]), Some([low, high])) = (frame.place(point.x, point.y), point.interval) else { continue };
            let thin = Stroke { color: color(curve.color), width: 1.0, dashes: "" };
            let along_x = frame.names[1];
            let axis = if along_x { &frame.x } else { &frame.y };
            let ends = [axis.place_within(low), axis.place_within(high)];
            let at = |along: f64, aside: f64| if along_x { [along, y + aside] } else { [x + aside, along] };
            drawing.line(&[at(ends[0], 0.0), at(ends[1], 0.0)], &thin)?;
            for end in ends {
                drawing.line(&[at(end, -3.0), at(end, 3.0)], &thin)?;
            }
        }
    }
    for curve in curves {
        let Some(marker) = curve.marker else { continue };
        for point in &curve.points {
            let Some(at) = frame.place(point.x, point.y) else { continue };
            mark(drawing, curve, marker, &point.look, at)?;
        }
    }
    Ok(())
}

/// The numbers of ringed points, and below the chart what they are.
pub(super) fn key(drawing: &mut Drawing<'_>, frame: &Frame<'_>, content: &ChartContent) -> io::Result<()> {
    let ChartContent::Curves(curves, _) = content else { return Ok(()) };
    let ringed = curves.iter().flat_map(|curve| &curve.points).filter(|p| matches!(p.look, PointLook::Ringed(_)));
    for (number, point) in ringed.enumerate() {
        if let Some([x, y]) = frame.place(point.x, point.y) {
            drawing.words(&Label::new(&(number + 1).to_string(), [x + 8.0, y - 7.0], Anchor::Start))?;
        }
    }
    for (row, words) in key_of(content).iter().enumerate() {
        let at = [frame.x.pixels[0], frame.key_top + LINE * (row as f64 + 0.5)];
        drawing.words(&Label::new(words, at, Anchor::Start))?;
    }
    Ok(())
}

/// A point.
fn mark(drawing: &mut Drawing<'_>, curve: &Curve, marker: usize, look: &PointLook, [x, y]: [f64; 2]) -> io::Result<()> {
    let r = if curve.line.is_some() { SMALL } else { LARGE };
    let of = color(curve.color);
    let (fill, edge, width) = match look {
        PointLook::Plain => (of, of, 0.5),
        PointLook::Open => ("#ffffff", of, 1.2),
        PointLook::Ringed(_) => (of, light_color("text"), 2.0),
    };
    let corners = |offsets: &[[f64; 2]]| -> String {
        let places = offsets.iter().map(|[dx, dy]| format!("{} {}", coordinate(x + r * dx), coordinate(y + r * dy)));
        format!("M{}Z", places.collect::<Vec<_>>().join("L"))
    };
    // A bar of a cross is as wide as two fifths of it.
    let cross = |turn: f64| {
        let (s, c) = turn.sin_cos();
        let outline = [
            [-0.35, -1.1],
            [0.35, -1.1],
            [0.35, -0.35],
            [1.1, -0.35],
            [1.1, 0.35],
            [0.35, 0.35],
            [0.35, 1.1],
            [-0.35, 1.1],
            [-0.35, 0.35],
            [-1.1, 0.35],
            [-1.1, -0.35],
            [-0.35, -0.35],
        ];
        corners(&outline.map(|[x, y]| [c * x - s * y, s * x + c * y]))
    };
    let path = match marker % 8 {
        0 => {
            let (left, right, y, r) = (coordinate(x - r), coordinate(x + r), coordinate(y), coordinate(r));
            format!("M{left} {y}A{r} {r} 0 1 1 {right} {y}A{r} {r} 0 1 1 {left} {y}Z")
        }
        1 => corners(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
        2 => corners(&[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]]),
        3 => cross(0.0),
        4 => cross(std::f64::consts::FRAC_PI_4),
        5 => corners(&[[0.0, -1.2], [1.1, 0.8], [-1.1, 0.8]]),
        6 => corners(&[[0.0, 1.2], [1.1, -0.8], [-1.1, -0.8]]),
        _ => corners(&[[-1.2, 0.0], [0.8, -1.1], [0.8, 1.1]]),
    };
    drawing.path(&path, fill, edge, width)
}

/// Bars, stacked.
pub(super) fn bars(drawing: &mut Drawing<'_>, frame: &Frame<'_>, series: &[BarSeries]) -> io::Result<()> {
    let down = frame.names[1];
    let (names, numbers) = if down { (&frame.y, &frame.x) } else { (&frame.x, &frame.y) };
    let thick = 0.72 * names.slot();
    let mut below: Vec<u64> = Vec::new();
    for series in series {
        below.resize(below.len().max(series.counts.len()), 0);
        for (at, (count, below)) in series.counts.iter().zip(&mut below).enumerate().filter(|(_, (n, _))| **n > 0) {
            let (from, to) = (numbers.place(*below as f64), numbers.place((*below + count) as f64));
            *below += count;
            let (Some(middle), Some(from), Some(to)) = (names.place(at as f64), from, to) else { continue };
            let (least, length) = (from.min(to), (to - from).abs());
            let bar = if down {
                [least, middle - thick / 2.0, length, thick]
            } else {
                [middle - thick / 2.0, least, thick, length]
            };
            drawing.rectangle(bar, color(series.color))?;
        }
    }
    Ok(())
}

/// Cells with their numbers.
pub(super) fn heat_map(drawing: &mut Drawing<'_>, frame: &Frame<'_>, map: &HeatMap) -> io::Result<()> {
    let [from, to] = map.colors_from_to;
    let (width, height) = (frame.x.slot(), frame.y.slot());
    for (row, shares) in map.percent.iter().enumerate() {
        for (column, share) in shares.iter().enumerate() {
            let (Some(share), Some([x, y])) = (share, frame.place(column as f64, row as f64)) else { continue };
            let cell = [x - width / 2.0 + 0.5, y - height / 2.0 + 0.5, width - 1.0, height - 1.0];
            drawing.rectangle(cell, &between((share - from) / (to - from)))?;
            drawing.words(&Label::new(&format!("{share:.1}"), [x, y], Anchor::Middle))?;
        }
    }
    Ok(())
}
