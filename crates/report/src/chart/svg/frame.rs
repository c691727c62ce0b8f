//! The legend, the axes and their names, and what is left for the content.

use super::drawing::{Anchor, Drawing, Label, Stroke, light_color};
use super::{FONT, LINE, WIDTH, content};
use crate::chart::scale::PlacedAxis;
use crate::chart::text_size::width as text_width;
use crate::chart::{Chart, ChartContent, in_lines};
use std::io;

/// Names that do not fit beside one another are turned by so many degrees.
const TURNED: f64 = -60.0;
/// From the border of the picture.
const PAD: f64 = 8.0;
/// From line to line of a legend.
const LEGEND_LINE: f64 = 17.0;
/// Before the name in a legend.
const LEGEND_MARK: f64 = 26.0;
/// The widest column of a heat map.
const WIDEST_COLUMN: f64 = 84.0;
/// The narrowest one: a number fits.
const NARROWEST_COLUMN: f64 = 38.0;

/// A name that an axis has, in lines.
struct TickLabel {
    value: f64,
    lines: Vec<String>,
    width: f64,
}

/// Where everything is.
pub(super) struct Frame<'c> {
    /// The whole picture (px).
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) x: PlacedAxis<'c>,
    pub(super) y: PlacedAxis<'c>,
    /// Whether the axis to the right has names, and the one upwards.
    pub(super) names: [bool; 2],
    x_labels: Vec<TickLabel>,
    y_labels: Vec<TickLabel>,
    x_turned: bool,
    x_above: bool,
    /// The place of each entry of the legend.
    legend: Vec<[f64; 2]>,
    /// The top of the list of numbered points.
    pub(super) key_top: f64,
}

impl<'c> Frame<'c> {
    pub(super) fn of(chart: &'c Chart) -> Frame<'c> {
        let (mut x, mut y) = (PlacedAxis::of(chart, 0), PlacedAxis::of(chart, 1));
        let labels = |axis: &PlacedAxis<'_>, lines: fn(&str) -> Vec<String>| -> Vec<TickLabel> {
            let label = |(value, name): (f64, String)| {
                let lines = lines(&name);
                let width = lines.iter().map(|line| text_width(line, FONT)).fold(0.0, f64::max);
                TickLabel { value, lines, width }
            };
            axis.ticks().into_iter().map(label).collect()
        };
        let mut x_labels = labels(&x, |name| vec![name.to_owned()]);
        let y_labels = labels(&y, in_lines);
        let widest = |labels: &[TickLabel]| labels.iter().map(|label| label.width).fold(0.0, f64::max);
        let x_above = matches!(&chart.content, ChartContent::Map(map) if map.names_above);
        let title = |title: &str| if title.is_empty() { 0.0 } else { LINE + 6.0 };
        let left = PAD + title(&chart.y.title) + widest(&y_labels) + 10.0;
        let (across, down) = turned_size(widest(&x_labels));
        let mut width = WIDTH;
        let mut right = WIDTH - PAD - if x_above { across } else { 10.0 };
        if let ChartContent::Map(_) = chart.content {
            let columns = x_labels.len().max(1) as f64;
            let column = ((right - left) / columns).clamp(NARROWEST_COLUMN, WIDEST_COLUMN);
            width += left + column * columns - right;
            right = left + column * columns;
        }
        x.pixels = [left, right];
        let x_turned = x_above || chart.x.as_names().is_some() && widest(&x_labels) > x.slot() - 4.0;
        if x_turned {
            // Where turned names would still overlap, every second one is left out, or more.
            let every = (turned_distance() / x.slot()).ceil().max(1.0) as usize;
            x_labels = x_labels.into_iter().step_by(every).collect();
        }
        let names_down = if x_turned { down } else { LINE };
        let (legend, rows) = legend_places(&content::legend_names(chart), left.min(90.0), width - PAD);
        let top = PAD + rows as f64 * LEGEND_LINE + if rows > 0 { 6.0 } else { 0.0 } + if x_above { down } else { 0.0 };
        let least = match chart.y.as_names() {
            Some(names) => names.len() as f64 * 18.0,
            None => 160.0,
        };
        let bottom = top + (f64::from(chart.height) - 110.0).clamp(least, 4000.0);
        y.pixels = [bottom, top];
        let key_top = bottom + 8.0 + if x_above { 0.0 } else { names_down } + title(&chart.x.title);
        let key = content::key_of(&chart.content);
        let height = key_top + key.len() as f64 * LINE + PAD;
        let names = [chart.x.as_names().is_some(), chart.y.as_names().is_some()];
        Frame { width, height, x, y, names, x_labels, y_labels, x_turned, x_above, legend, key_top }
    }

    /// The place of a point, if it has one.
    pub(super) fn place(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        Some([self.x.place(x)?, self.y.place(y)?])
    }

    /// Grid, names of the axes, titles, legend.
    pub(super) fn draw(&self, drawing: &mut Drawing<'_>, chart: &Chart) -> io::Result<()> {
        let [left, right] = self.x.pixels;
        let [bottom, top] = self.y.pixels;
        let grid = Stroke { color: light_color("line"), width: 0.75, dashes: "" };
        let map = matches!(chart.content, ChartContent::Map(_));
        for label in &self.x_labels {
            let Some(at) = self.x.place(label.value) else { continue };
            if !self.names[0] {
                drawing.line(&[[at, top], [at, bottom]], &grid)?;
            }
            let text = label.lines.join(" ");
            let words = match (self.x_turned, self.x_above) {
                (true, true) => Label { turned: TURNED, ..Label::new(&text, [at, top - 8.0], Anchor::Start) },
                (true, false) => Label { turned: TURNED, ..Label::new(&text, [at, bottom + 8.0], Anchor::End) },
                (false, _) => Label::new(&text, [at, bottom + 12.0], Anchor::Middle),
            };
            drawing.words(&words)?;
        }
        for label in &self.y_labels {
            let Some(at) = self.y.place(label.value) else { continue };
            if !map {
                drawing.line(&[[left, at], [right, at]], &grid)?;
            }
            let first = at - LINE * (label.lines.len() as f64 - 1.0) / 2.0;
            for (number, line) in label.lines.iter().enumerate() {
                drawing.words(&Label::new(line, [left - 6.0, first + LINE * number as f64], Anchor::End))?;
            }
        }
        if !map {
            let border = Stroke { color: light_color("muted"), width: 1.0, dashes: "" };
            drawing.line(&[[left, top], [left, bottom], [right, bottom]], &border)?;
        }
        if !chart.x.title.is_empty() {
            let at = [(left + right) / 2.0, self.key_top - LINE / 2.0 - 2.0];
            drawing.words(&Label::new(&chart.x.title, at, Anchor::Middle))?;
        }
        if !chart.y.title.is_empty() {
            let at = [PAD + LINE / 2.0, (top + bottom) / 2.0];
            drawing.words(&Label { turned: -90.0, ..Label::new(&chart.y.title, at, Anchor::Middle) })?;
        }
        let names = content::legend_names(chart);
        for (number, (name, [x, y])) in names.iter().zip(&self.legend).enumerate() {
            content::legend_mark(drawing, chart, number, [*x, *y])?;
            drawing.words(&Label::new(name, [x + LEGEND_MARK, *y], Anchor::Start))?;
        }
        Ok(())
    }
}

/// How far a turned name reaches aside and down, the tenth of a line that sticks out included.
fn turned_size(width: f64) -> (f64, f64) {
    let (sine, cosine) = TURNED.to_radians().abs().sin_cos();
    (width * cosine + FONT * sine, width * sine + FONT * cosine + 6.0)
}

/// How far turned names beside one another must be apart along the axis.
fn turned_distance() -> f64 {
    LINE / TURNED.to_radians().abs().sin()
}

/// Where the entries of a legend begin, and how many lines they take.
fn legend_places(names: &[&str], left: f64, right: f64) -> (Vec<[f64; 2]>, usize) {
    let (mut x, mut row) = (left, 0);
    let mut places = Vec::new();
    for name in names {
        let width = LEGEND_MARK + text_width(name, FONT) + 16.0;
        if x > left && x + width > right {
            (x, row) = (left, row + 1);
        }
        places.push([x, PAD + LEGEND_LINE * (row as f64 + 0.5)]);
        x += width;
    }
    let rows = if names.is_empty() { 0 } else { row + 1 };
    (places, rows)
}
