//! From values on an axis to places in a picture, and which values are named.

use super::{AxisScale, Chart, ChartAxis, ChartContent, LogScale};
use crate::safe_levels::power;

impl LogScale {
    /// Where a value is drawn: as what it is, or as a zero.
    pub(super) fn drawn_at(&self, value: f64) -> f64 {
        match self.zero {
            Some(zero) if value.is_finite() => value.max(zero),
            _ => value,
        }
    }
}

/// An axis in a picture.
pub(super) struct PlacedAxis<'c> {
    scale: &'c AxisScale,
    /// The values at both ends: numbers, or powers of ten.
    ends: [f64; 2],
    /// The places of both ends, in pixels.
    pub(super) pixels: [f64; 2],
}

/// All finite numbers that a chart shows along an axis, with the ends of intervals: 0 to the right, 1 upwards.
fn numbers(chart: &Chart, axis: usize) -> Vec<f64> {
    let interval_axis = usize::from(chart.y.as_names().is_none());
    match &chart.content {
        ChartContent::Curves(curves, limit) => {
            let points = curves.iter().flat_map(|curve| &curve.points);
            let of = points.flat_map(|point| {
                let ends = point.interval.filter(|_| axis == interval_axis);
                [Some([point.x, point.y][axis]), ends.map(|ends| ends[0]), ends.map(|ends| ends[1])]
            });
            of.flatten().chain(limit.filter(|_| axis == 1)).filter(|value| value.is_finite()).collect()
        }
        ChartContent::Bars(series) => {
            let names = series.iter().map(|series| series.counts.len()).max().unwrap_or(0);
            let sum = |at| series.iter().filter_map(|series| series.counts.get(at)).sum::<u64>() as f64;
            (0..names).map(sum).collect()
        }
        ChartContent::Map(_) => Vec::new(),
    }
}

impl<'c> PlacedAxis<'c> {
    /// The axis of a chart, 0 to the right, 1 upwards, not yet placed.
    pub(super) fn of(chart: &'c Chart, axis: usize) -> PlacedAxis<'c> {
        let given: &ChartAxis = [&chart.x, &chart.y][axis];
        let ends = match &given.scale {
            // Names downwards: the first one is at the top.
            AxisScale::Names(names) if axis == 1 => [names.len() as f64 - 0.5, -0.5],
            AxisScale::Names(names) => [-0.5, names.len() as f64 - 0.5],
            AxisScale::Linear(Some(range)) => *range,
            AxisScale::Linear(None) => {
                let (low, high) =
                    numbers(chart, axis).into_iter().fold((0.0, 0.0), |(l, h), v| (f64::min(l, v), f64::max(h, v)));
                let room = 0.05 * (high - low);
                if high > low { [if low < 0.0 { low - room } else { low }, high + room] } else { [0.0, 1.0] }
            }
            AxisScale::Log(LogScale { decades: Some(decades), .. }) => *decades,
            AxisScale::Log(log) => {
                let all =
                    numbers(chart, axis).into_iter().map(|value| log.drawn_at(value)).filter(|value| *value > 0.0);
                let (low, high) = all
                    .map(f64::log10)
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
                if low <= high { [low - 0.2, high + 0.2] } else { [0.0, 1.0] }
            }
        };
        PlacedAxis { scale: &given.scale, ends, pixels: [0.0, 1.0] }
    }

    /// The place of a value, if it has one.
    pub(super) fn place(&self, value: f64) -> Option<f64> {
        let value = match self.scale {
            AxisScale::Log(log) => log.drawn_at(value).log10(),
            AxisScale::Names(_) | AxisScale::Linear(_) => value,
        };
        let [from, to] = self.pixels;
        let share = (value - self.ends[0]) / (self.ends[1] - self.ends[0]);
        share.is_finite().then_some(from + share * (to - from))
    }

    /// The place of a value, moved to the nearer end of the axis if it lies beyond.
    pub(super) fn place_within(&self, value: f64) -> f64 {
        let [low, high] = [self.pixels[0].min(self.pixels[1]), self.pixels[0].max(self.pixels[1])];
        match self.place(value) {
            Some(at) => at.clamp(low, high),
            None if value > 0.0 => self.pixels[1],
            None => self.pixels[0],
        }
    }

    /// The width of a name's share of the axis.
    pub(super) fn slot(&self) -> f64 {
        ((self.pixels[1] - self.pixels[0]) / (self.ends[1] - self.ends[0])).abs()
    }

    /// How many decades apart the powers of ten are that are named, so that their names do not touch.
    pub(super) fn decades_apart(&self) -> i32 {
        ((self.ends[1].floor() - self.ends[0].ceil()) as i32 / 8 + 1).max(1)
    }

    /// The values that are named, with their names.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        match self.scale {
            AxisScale::Names(names) => names.iter().enumerate().map(|(at, name)| (at as f64, name.clone())).collect(),
            AxisScale::Log(log) if !log.ticks.is_empty() => log.ticks.clone(),
            AxisScale::Log(_) => {
                let (low, high) = (self.ends[0].ceil() as i32, self.ends[1].floor() as i32);
                (low..=high)
                    .step_by(self.decades_apart() as usize)
                    .map(|k| (10f64.powi(k), power(&format!("1e{k}"))))
                    .collect()
            }
            AxisScale::Linear(_) => linear_ticks(self.ends),
        }
    }
}

/// Round values from one end to the other, four to nine of them.
fn linear_ticks([low, high]: [f64; 2]) -> Vec<(f64, String)> {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) {
        return vec![(low, number(low, 0))];
    }
    let decade = (span / 5.0).log10().floor() as i32;
    let fits = |step: &f64| span / step <= 8.0;
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * 10f64.powi(decade)).into_iter().find(fits).unwrap_or(span);
    let digits = usize::try_from(-step.log10().floor() as i32).unwrap_or(0);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|at| (at as f64 * step, number(at as f64 * step, digits))).collect()
}

/// A number with so many digits behind the point, or with a power of ten where it would be long.
fn number(value: f64, digits: usize) -> String {
    if digits <= 4 && value.abs() < 1e6 {
        return format!("{value:.digits$}");
    }
    let text = format!("{value:.1e}");
    match text.split_once('e') {
        Some((_, _)) if value == 0.0 => "0".to_owned(),
        Some((mantissa, exponent)) => {
            let mantissa = mantissa.strip_suffix(".0").unwrap_or(mantissa);
            // `power` writes 10 for 1e1, which never comes here.
            format!("{mantissa}×{}", power(&format!("1e{exponent}")))
        }
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::linear_ticks;

    fn names(ends: [f64; 2]) -> Vec<String> {
        linear_ticks(ends).into_iter().map(|(_, name)| name).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(names([0.0, 101.0]), ["0", "20", "40", "60", "80", "100"]);
        assert_eq!(names([0.0, 1.05]), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(names([98.0, 100.0]), ["98.0", "98.5", "99.0", "99.5", "100.0"]);
        assert_eq!(names([-3.1, 2.1]), ["-3", "-2", "-1", "0", "1", "2"]);
        assert_eq!(names([0.0, 3.15e-9]), ["0", "5×10⁻¹⁰", "1×10⁻⁹", "1.5×10⁻⁹", "2×10⁻⁹", "2.5×10⁻⁹", "3×10⁻⁹"]);
        assert_eq!(names([0.0, 0.0]), ["0"]);
    }
}
