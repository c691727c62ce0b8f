//! Charts: what they show, apart from how they are drawn. [`plotly`] makes of one what the page draws, [`svg`] a picture, [`values`]
//! the numbers as CSV.

pub mod plotly;
mod scale;
pub mod svg;
mod text_size;
pub mod values;

use rockproof_campaign::proportion::Proportion;
use rockproof_differential::finding::Cause;

/// A chart.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Its name in the page, `chart-` before the stem of its files.
    pub id: String,
    /// What it shows, for those who do not see it and as a caption.
    pub caption: String,
    /// Height in CSS pixels.
    pub height: u32,
    /// Whether two stand beside each other on a wide screen.
    pub half: bool,
    /// To the right.
    pub x: ChartAxis,
    /// Upwards; names from the top downwards.
    pub y: ChartAxis,
    /// What lies between them.
    pub content: ChartContent,
}

/// An axis.
#[derive(Clone, Debug)]
pub struct ChartAxis {
    /// What it shows, with its unit.
    pub title: String,
    /// How places on it follow from values.
    pub scale: AxisScale,
}

/// How places on an axis follow from values.
#[derive(Clone, Debug)]
pub enum AxisScale {
    /// Names side by side; the value is the number of the name.
    Names(Vec<String>),
    /// Linear, over a range that is given or holds all values and zero.
    Linear(Option<[f64; 2]>),
    /// Logarithmic.
    Log(LogScale),
}

/// A logarithmic axis.
#[derive(Clone, Debug, Default)]
pub struct LogScale {
    /// Its ends, as powers of ten; without them those that hold all values.
    pub decades: Option<[f64; 2]>,
    /// The value at which what is 0 is drawn, since nothing is at 0.
    pub zero: Option<f64>,
    /// The values that are named, with their names; without them powers of ten.
    pub ticks: Vec<(f64, String)>,
}

/// What a chart shows.
#[derive(Clone, Debug)]
pub enum ChartContent {
    /// Points, joined or not, and a value that they are held against.
    Curves(Vec<Curve>, Option<f64>),
    /// Bars stacked over the names of one axis.
    Bars(Vec<BarSeries>),
    /// Shares over the names of both axes.
    Map(HeatMap),
}

/// Points of one name and colour.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Its name in the legend; none if it is the only one.
    pub name: String,
    /// Its colour.
    pub color: ChartColor,
    /// The line that joins the points, if they are joined.
    pub line: Option<LineStyle>,
    /// The shape of the points, 0 to 7, if they are drawn.
    pub marker: Option<usize>,
    /// The points, in the order in which they are joined.
    pub points: Vec<ChartPoint>,
}

/// How points are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineStyle {
    /// By straight lines.
    Solid,
    /// By dotted lines.
    Dotted,
    /// By steps, first to the right.
    Steps,
    /// By dashed steps.
    DashedSteps,
}

/// A point.
#[derive(Clone, Debug, Default)]
pub struct ChartPoint {
    /// Its value to the right.
    pub x: f64,
    /// Its value upwards; NaN where there is none, which breaks a line.
    pub y: f64,
    /// The ends of its interval, on the axis of numbers or on the one upwards.
    pub interval: Option<[f64; 2]>,
    /// How it differs from the other points.
    pub look: PointLook,
    /// What is said of it under the pointer; empty for its numbers.
    pub note: String,
}

/// How a point differs from others of its curve.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum PointLook {
    /// Not.
    #[default]
    Plain,
    /// It is empty.
    Open,
    /// It has a ring and a label.
    Ringed(String),
}

/// A part of each bar.
#[derive(Clone, Debug)]
pub struct BarSeries {
    /// Its name in the legend.
    pub name: String,
    /// Its colour.
    pub color: ChartColor,
    /// How many, for each name of the axis.
    pub counts: Vec<u64>,
}

/// Shares in percent over two axes of names.
#[derive(Clone, Debug)]
pub struct HeatMap {
    /// Row by row from the top; nothing where there is none.
    pub percent: Vec<Vec<Option<f64>>>,
    /// The values of the first and the last colour.
    pub colors_from_to: [f64; 2],
    /// Whether the names of the columns stand above it.
    pub names_above: bool,
}

/// A colour of the page's theme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChartColor {
    /// One of the eight of a series of things.
    Series(usize),
    /// That of a cause.
    Cause(Cause),
    /// Of what matters less.
    Muted,
}

impl ChartColor {
    /// What has a colour of its own in every chart.
    const BUILT_IN: [&'static str; 4] = ["stepper-f32", "stepper-f64", "certified", "exact"];

    /// The colour of an engine: the same in every chart. `at` is its place among those that are not built in.
    pub fn of_engine(engine: &str, at: usize) -> ChartColor {
        let known = Self::BUILT_IN;
        ChartColor::Series(known.iter().position(|name| *name == engine).unwrap_or(known.len() + at))
    }

    /// The colour of an engine of a run with these engines.
    pub fn among(engine: &str, engines: &[String]) -> ChartColor {
        let others = || engines.iter().filter(|known| !Self::BUILT_IN.contains(&known.as_str()));
        ChartColor::of_engine(engine, others().position(|known| known == engine).unwrap_or(0))
    }

    /// Its name in the page's style sheet.
    fn name(self) -> String {
        match self {
            ChartColor::Series(number) => format!("series{}", number % 8),
            ChartColor::Cause(cause) => {
                format!("cause{}", Cause::ALL.iter().position(|known| *known == cause).unwrap_or(0))
            }
            ChartColor::Muted => "muted".to_owned(),
        }
    }
}

impl ChartAxis {
    /// An axis of names.
    pub fn names(title: impl Into<String>, names: Vec<String>) -> ChartAxis {
        ChartAxis { title: title.into(), scale: AxisScale::Names(names) }
    }

    /// A linear axis from zero.
    pub fn from_zero(title: impl Into<String>) -> ChartAxis {
        ChartAxis { title: title.into(), scale: AxisScale::Linear(None) }
    }

    /// A linear axis from one value to another.
    pub fn linear(title: impl Into<String>, range: [f64; 2]) -> ChartAxis {
        ChartAxis { title: title.into(), scale: AxisScale::Linear(Some(range)) }
    }

    /// A logarithmic axis.
    pub fn log(title: impl Into<String>, scale: LogScale) -> ChartAxis {
        ChartAxis { title: title.into(), scale: AxisScale::Log(scale) }
    }

    /// Its names, if it has some.
    pub(crate) fn as_names(&self) -> Option<&[String]> {
        match &self.scale {
            AxisScale::Names(names) => Some(names),
            AxisScale::Linear(_) | AxisScale::Log(_) => None,
        }
    }
}

impl ChartPoint {
    /// A point.
    pub fn new(x: f64, y: f64) -> ChartPoint {
        ChartPoint { x, y, ..ChartPoint::default() }
    }

    /// The point with the interval of a share, in percent.
    #[must_use]
    pub fn with_share(self, share: &Proportion) -> ChartPoint {
        ChartPoint { interval: Some([share.low * 100.0, share.high * 100.0]), ..self }
    }
}

impl Chart {
    /// A chart over the whole width. Its ends, where that matters, depend on `x` and `y`.
    pub fn new(
        id: impl Into<String>,
        caption: impl Into<String>,
        height: usize,
        axes: [ChartAxis; 2],
        content: ChartContent,
    ) -> Chart {
        let height = u32::try_from(height).unwrap_or(u32::MAX);
        let [x, y] = axes;
        Chart { id: id.into(), caption: caption.into(), height, half: false, x, y, content }
    }

    /// The chart, to stand beside another one on a wide screen.
    #[must_use]
    pub fn half(self) -> Chart {
        Chart { half: true, ..self }
    }

    /// The stem of its files.
    pub fn stem(&self) -> &str {
        self.id.strip_prefix("chart-").unwrap_or(&self.id)
    }
}

/// A long name in lines of some 24 characters.
pub(crate) fn in_lines(name: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in name.split(' ') {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.len() + word.len() < 24 => *line += &format!(" {word}"),
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The height of a chart with bars or rows of these names, in CSS pixels.
pub(crate) fn height_of_rows(names: &[String], least: usize) -> usize {
    (12 + 14 * names.iter().map(|name| in_lines(name).len()).max().unwrap_or(1)) * names.len().max(least)
}
