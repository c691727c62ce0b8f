//! Charts as SVG, in one style: points and lines over two axes, each linear or logarithmic.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// An axis.
#[derive(Clone, Debug)]
pub struct PlotAxis {
    /// What it shows, with its unit.
    pub label: String,
    /// Whether it is logarithmic. Values of 0 and below then lie at its lower end.
    pub log: bool,
}

impl PlotAxis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>) -> PlotAxis {
        PlotAxis { label: label.into(), log: false }
    }

    /// A logarithmic axis.
    pub fn log(label: impl Into<String>) -> PlotAxis {
        PlotAxis { label: label.into(), log: true }
    }
}

/// How the points of a series are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marks {
    /// Dots.
    Dots,
    /// Dots, joined by a line.
    Joined,
    /// Dark rings around points of other series, which keep their colours.
    Rings,
}

/// Where the legend is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Legend {
    /// In the upper right corner of the chart.
    Inside,
    /// To the right of it, where it hides no point.
    Beside,
}

/// Points of one name and colour.
#[derive(Clone, Debug)]
pub struct Series {
    /// The name in the legend.
    pub name: String,
    /// The points.
    pub points: Vec<[f64; 2]>,
    /// Lower and upper ends of intervals around the points; as many, or none.
    pub intervals: Vec<[f64; 2]>,
    /// What is told of each point where one points at it; as many, or none.
    pub titles: Vec<String>,
    /// How they are drawn.
    pub marks: Marks,
}

/// A chart.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Its title.
    pub title: String,
    /// The axis to the right.
    pub x: PlotAxis,
    /// The axis upwards.
    pub y: PlotAxis,
    /// What it shows.
    pub series: Vec<Series>,
    /// Where the legend is.
    pub legend: Legend,
}

/// Why a chart cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot draw \"{title}\": {why}")]
pub struct PlotError {
    title: String,
    why: String,
}

const SIZE: (u32, u32) = (720, 440);

/// The width of a legend beside the chart.
const BESIDE: u32 = 190;

/// Rings.
const DARK: RGBColor = RGBColor(30, 30, 30);

/// Colours that people with other colour vision tell apart (M. Okabe and K. Ito, 2008).
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
];

impl Plot {
    /// The chart as an SVG text.
    ///
    /// # Errors
    /// When there is no point to draw, or the drawing library refuses.
    pub fn svg(&self) -> Result<String, PlotError> {
        let fail = |why: String| PlotError { title: self.title.clone(), why };
        let (x_scale, y_scale) = (Scale::of(self, 0), Scale::of(self, 1));
        let (Some(x), Some(y)) = (x_scale, y_scale) else { return Err(fail("there is no point".to_owned())) };
        let mut text = String::new();
        self.draw(&mut text, &x, &y).map_err(|error| fail(error.to_string()))?;
        Ok(self.titled(&text))
    }

    /// The SVG text with the titles of points, which the drawing library does not know: circles are the points, series by series, behind those
    /// of each the one of a legend beside the chart.
    fn titled(&self, svg: &str) -> String {
        let mut titles = self.series.iter().flat_map(|series| {
            let points = (0..series.points.len()).map(|point| series.titles.get(point));
            points.chain((self.legend == Legend::Beside).then_some(None))
        });
        let mut parts = svg.split("<circle ");
        let mut out = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            out += "<circle ";
            match (titles.next().flatten(), part.split_once("/>")) {
                (Some(title), Some((attributes, rest))) => {
                    let title = title.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
                    out += &format!("{attributes}><title>{title}</title></circle>{rest}");
                }
                _ => out += part,
            }
        }
        out
    }

    fn draw(&self, text: &mut String, x: &Scale, y: &Scale) -> Result<(), Box<dyn std::error::Error>> {
        let beside = self.legend == Legend::Beside;
        let size = (SIZE.0 + if beside { BESIDE } else { 0 }, SIZE.1);
        let area = SVGBackend::with_string(text, size).into_drawing_area();
        area.fill(&WHITE)?;
        let (left, right) = area.split_horizontally(SIZE.0);
        let words =
            |size: i32| ("sans-serif", size).into_font().into_text_style(&area).pos(Pos::new(HPos::Left, VPos::Center));
        let mut chart = ChartBuilder::on(&left)
            .caption(&self.title, ("sans-serif", 18))
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(72)
            .build_cartesian_2d(x.range.clone(), y.range.clone())?;
        chart
            .configure_mesh()
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .x_labels(x.labels())
            .y_labels(y.labels())
            .x_label_formatter(&|value| x.shown(*value))
            .y_label_formatter(&|value| y.shown(*value))
            .label_style(("sans-serif", 12))
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225))
            .draw()?;
        for ((series, colour), line) in self.series.iter().zip(COLOURS.iter().cycle()).zip(0i32..) {
            let place = |p: &[f64; 2]| (x.place(p[0]), y.place(p[1]));
            let points: Vec<(f64, f64)> = series.points.iter().map(place).collect();
            for (point, [low, high]) in points.iter().zip(&series.intervals) {
                let ends = vec![(point.0, y.place(*low)), (point.0, y.place(*high))];
                chart.draw_series(LineSeries::new(ends, colour.stroke_width(1)))?;
            }
            if series.marks == Marks::Joined {
                chart.draw_series(LineSeries::new(points.clone(), colour.stroke_width(2)))?;
            }
            let (radius, style) = match series.marks {
                Marks::Rings => (6, DARK.stroke_width(1)),
                Marks::Dots | Marks::Joined => (3, colour.filled()),
            };
            chart
                .draw_series(points.into_iter().map(|point| Circle::new(point, radius, style)))?
                .label(&series.name)
                .legend(move |(x, y)| Circle::new((x + 10, y), radius.max(4), style));
            if beside {
                let y = 60 + 22 * line;
                right.draw(&Circle::new((12, y), radius.max(4), style))?;
                right.draw(&Text::new(series.name.clone(), (26, y), words(12)))?;
            }
        }
        if beside {
            area.present()?;
            return Ok(());
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(200, 200, 200))
            .label_font(words(12))
            .draw()?;
        area.present()?;
        Ok(())
    }
}

/// How values of an axis become places.
struct Scale {
    log: bool,
    /// The least value above 0, where zeros lie one decade below.
    floor: f64,
    range: Range<f64>,
}

impl Scale {
    fn of(chart: &Plot, axis: usize) -> Option<Scale> {
        let log = if axis == 0 { chart.x.log } else { chart.y.log };
        let values = || {
            let ends = |s: &Series| if axis == 1 { s.intervals.concat() } else { Vec::new() };
            let all = chart
                .series
                .iter()
                .flat_map(move |s| s.points.iter().map(|p| p[axis]).chain(ends(s)).collect::<Vec<_>>());
            all.filter(|value| value.is_finite())
        };
        let floor = values().filter(|value| *value > 0.0).fold(f64::INFINITY, f64::min);
        let floor = if floor.is_finite() { floor / 10.0 } else { 1e-1 };
        let mut scale = Scale { log, floor, range: 0.0..1.0 };
        let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            let place = scale.place(value);
            (low.min(place), high.max(place))
        });
        if low > high {
            return None;
        }
        scale.range = match log {
            true => low.floor()..if high.ceil() > low.floor() { high.ceil() } else { low.floor() + 1.0 },
            false => {
                let room = if high > low { (high - low) * 0.05 } else { 1.0 };
                low - room..high + room
            }
        };
        Some(scale)
    }

    fn place(&self, value: f64) -> f64 {
        if self.log { value.max(self.floor).log10() } else { value }
    }

    fn labels(&self) -> usize {
        if self.log { ((self.range.end - self.range.start) as usize + 1).min(12) } else { 8 }
    }

    fn shown(&self, place: f64) -> String {
        match self.log {
            true if place.fract().abs() < 1e-9 => format!("1e{place:.0}"),
            true => String::new(),
            false => {
                let text = format!("{place:.3}");
                text.trim_end_matches('0').trim_end_matches('.').to_owned()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<[f64; 2]>) -> Plot {
        let intervals = points.iter().map(|p| [p[1] / 2.0, p[1] * 2.0]).collect();
        let titles = points.iter().map(|p| format!("{} < {}", p[0], p[1])).collect();
        let series = vec![Series { name: "one & all".to_owned(), points, intervals, titles, marks: Marks::Joined }];
        let (x, y, legend) = (PlotAxis::log("x (m)"), PlotAxis::linear("y"), Legend::Inside);
        Plot { title: "A title".to_owned(), x, y, series, legend }
    }

    #[test]
    fn a_chart_is_xml_with_its_words_and_points() {
        let text = chart(vec![[0.0, 1.0], [1e-3, 2.0], [10.0, 0.0]]).svg().expect("a chart");
        let document = roxmltree::Document::parse(&text).expect("XML");
        let circles = document.descendants().filter(|n| n.has_tag_name("circle")).count();
        assert_eq!(circles, 4, "three points and the legend's");
        let titles = document.descendants().filter(|n| n.has_tag_name("title")).map(|n| n.text().unwrap_or_default());
        assert_eq!(titles.collect::<Vec<_>>(), ["0 < 1", "0.001 < 2", "10 < 0"]);
        for word in ["A title", "x (m)", "one & all"] {
            assert!(document.descendants().any(|n| n.text().is_some_and(|t| t.trim() == word)), "{word}");
        }
        assert_eq!(text, chart(vec![[0.0, 1.0], [1e-3, 2.0], [10.0, 0.0]]).svg().expect("the same chart"));
    }

    #[test]
    fn a_legend_beside_the_chart_and_rings_hide_no_point() {
        let mut beside = chart(vec![[0.5, 1.0], [2.0, 2.0]]);
        let ring = Series { name: "ringed".to_owned(), marks: Marks::Rings, ..beside.series[0].clone() };
        beside.series.push(ring);
        beside.legend = Legend::Beside;
        let text = beside.svg().expect("a chart");
        let document = roxmltree::Document::parse(&text).expect("XML");
        let circles: Vec<_> = document.descendants().filter(|n| n.has_tag_name("circle")).collect();
        let at = |n: &roxmltree::Node<'_, '_>| n.attribute("cx").and_then(|x| x.parse::<u32>().ok()).expect("a place");
        assert_eq!(circles.iter().filter(|n| at(n) > SIZE.0).count(), 2, "the legend's");
        let is_titled = |n: &roxmltree::Node<'_, '_>| n.first_element_child().is_some_and(|n| n.has_tag_name("title"));
        assert!(circles.iter().all(|n| is_titled(n) == (at(n) < SIZE.0)), "points have titles, the legend none");
        assert_eq!(
            circles.iter().filter(|n| n.attribute("fill") == Some("none") && at(n) < SIZE.0).count(),
            2,
            "rings"
        );
    }

    #[test]
    fn nothing_to_draw_is_an_error() {
        assert!(chart(Vec::new()).svg().is_err());
    }
}
