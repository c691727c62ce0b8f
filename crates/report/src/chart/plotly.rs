//! A chart as plotly takes it. Colours are named (`$series0`, `$cause2`, …); the page puts in those of its light or dark theme.

use super::scale::PlacedAxis;
use super::{AxisScale, BarSeries, Chart, ChartAxis, ChartContent, ChartPoint, Curve, HeatMap, LineStyle, LogScale};
use super::{PointLook, in_lines};
use serde_json::{Value, json};

/// `{ data, layout }`.
pub fn spec(chart: &Chart) -> Value {
    let (x_names, y_names) = (chart.x.as_names(), chart.y.as_names());
    let data: Vec<Value> = match &chart.content {
        ChartContent::Curves(curves, _) => curves.iter().map(|curve| scatter(chart, curve)).collect(),
        ChartContent::Bars(series) => series.iter().map(|series| bar(chart, series)).collect(),
        ChartContent::Map(map) => vec![heat_map(x_names.unwrap_or_default(), y_names.unwrap_or_default(), map)],
    };
    let mut x = axis(chart, 0, shown_across);
    let mut y = axis(chart, 1, shown_down);
    if y_names.is_some() {
        y["autorange"] = json!("reversed");
    }
    let mut layout = json!({ "legend": { "orientation": "h", "y": 1.02, "yanchor": "bottom" } });
    match &chart.content {
        ChartContent::Bars(_) => layout["barmode"] = json!("stack"),
        ChartContent::Curves(_, Some(limit)) => {
            layout["shapes"] = json!([{
                "type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": limit, "y1": limit,
                "line": { "color": "$good", "width": 1.5, "dash": "dash" },
            }]);
        }
        ChartContent::Map(map) if map.names_above => {
            x["side"] = json!("top");
            x["tickangle"] = json!(-40);
            layout["wide"] = json!(70 * x_names.map_or(0, <[String]>::len) + 140);
        }
        ChartContent::Curves(_, None) | ChartContent::Map(_) => {}
    }
    layout["xaxis"] = x;
    layout["yaxis"] = y;
    json!({ "data": data, "layout": layout })
}

/// A name on the axis upwards.
fn shown_down(name: &str) -> String {
    in_lines(name).join("<br>")
}

/// A name on the axis to the right.
fn shown_across(name: &str) -> String {
    name.replace(", ", "<br>")
}

/// The axis of a chart, 0 to the right, 1 upwards.
fn axis(chart: &Chart, number: usize, shown: fn(&str) -> String) -> Value {
    let axis = [&chart.x, &chart.y][number];
    let mut made = match &axis.scale {
        AxisScale::Names(names) => {
            let names: Vec<String> = names.iter().map(|name| shown(name)).collect();
            json!({ "type": "category", "categoryorder": "array", "categoryarray": names })
        }
        AxisScale::Linear(Some(range)) => json!({ "range": range, "exponentformat": "power" }),
        AxisScale::Linear(None) => json!({ "rangemode": "tozero", "exponentformat": "power" }),
        AxisScale::Log(log) if log.ticks.is_empty() => {
            json!({ "type": "log", "exponentformat": "power", "dtick": PlacedAxis::of(chart, number).decades_apart() })
        }
        AxisScale::Log(log) => {
            let (values, words): (Vec<f64>, Vec<&str>) = log.ticks.iter().map(|(at, name)| (*at, &**name)).unzip();
            json!({ "type": "log", "tickvals": values, "ticktext": words })
        }
    };
    if let AxisScale::Log(LogScale { decades: Some(decades), .. }) = &axis.scale {
        made["range"] = json!(decades);
    }
    if !axis.title.is_empty() {
        made["title"] = json!({ "text": axis.title });
    }
    made
}

/// The values of points on an axis: names for those of an axis of names, zeros where they are drawn.
fn values(axis: &ChartAxis, shown: fn(&str) -> String, of: impl Iterator<Item = f64>) -> Vec<Value> {
    match &axis.scale {
        AxisScale::Names(names) => of.map(|at| json!(names.get(at as usize).map(|name| shown(name)))).collect(),
        AxisScale::Linear(_) => of.map(|value| json!(value)).collect(),
        AxisScale::Log(log) => of.map(|value| json!(log.drawn_at(value))).collect(),
    }
}

fn scatter(chart: &Chart, curve: &Curve) -> Value {
    let points = &curve.points;
    let along_x = chart.y.as_names().is_some();
    let mode = match (&curve.line, curve.marker) {
        (None, _) => "markers",
        (Some(_), None) => "lines",
        (Some(_), Some(_)) => "lines+markers",
    };
    let mut trace = json!({
        "type": "scatter", "mode": mode,
        "x": values(&chart.x, shown_across, points.iter().map(|point| point.x)),
        "y": values(&chart.y, shown_down, points.iter().map(|point| point.y)),
    });
    if curve.name.is_empty() {
        trace["showlegend"] = json!(false);
    } else {
        trace["name"] = json!(curve.name);
    }
    let color = format!("${}", curve.color.name());
    if let Some(line) = curve.line {
        let (shape, dash) = match line {
            LineStyle::Solid => ("linear", "solid"),
            LineStyle::Dotted => ("linear", "dot"),
            LineStyle::Steps => ("hv", "solid"),
            LineStyle::DashedSteps => ("hv", "dash"),
        };
        trace["line"] = json!({ "color": color, "dash": dash, "width": 1.75, "shape": shape });
    }
    if let Some(marker) = curve.marker {
        trace["marker"] = markers(points, marker, &color, curve.line.is_some());
    }
    if points.iter().any(|point| point.interval.is_some()) {
        trace[if along_x { "error_x" } else { "error_y" }] = intervals(chart, points, along_x);
    }
    if points.iter().any(|point| !point.note.is_empty()) {
        trace["customdata"] = points.iter().map(|point| json!(point.note)).collect();
        trace["hovertemplate"] = json!("%{customdata}<extra>%{fullData.name}</extra>");
    }
    trace
}

/// How points are drawn: empty and ringed ones differ from the others.
fn markers(points: &[ChartPoint], marker: usize, color: &str, joined: bool) -> Value {
    let mut made = json!({ "size": if joined { 7 } else { 10 }, "color": color });
    if points.iter().any(|point| point.look == PointLook::Open) {
        let open = |point: &ChartPoint| json!(marker % 8 + if point.look == PointLook::Open { 100 } else { 0 });
        made["symbol"] = points.iter().map(open).collect();
    } else {
        made["symbol"] = json!(marker % 8);
    }
    let ringed = |point: &ChartPoint| matches!(point.look, PointLook::Ringed(_));
    if points.iter().any(ringed) {
        let widths: Vec<f64> = points.iter().map(|point| if ringed(point) { 2.5 } else { 0.0 }).collect();
        made["line"] = json!({ "color": "$text", "width": widths });
    }
    made
}

fn intervals(chart: &Chart, points: &[ChartPoint], along_x: bool) -> Value {
    let axis = if along_x { &chart.x } else { &chart.y };
    let place = |value: f64| match &axis.scale {
        AxisScale::Log(log) => log.drawn_at(value),
        AxisScale::Linear(_) | AxisScale::Names(_) => value,
    };
    let side = |end: usize| -> Vec<f64> {
        let reach = |point: &ChartPoint| {
            let at = place(if along_x { point.x } else { point.y });
            point.interval.map_or(0.0, |ends| (place(ends[end]) - at).abs())
        };
        points.iter().map(reach).collect()
    };
    json!({ "type": "data", "symmetric": false, "thickness": 1.25, "width": 3, "array": side(1), "arrayminus": side(0) })
}

fn bar(chart: &Chart, series: &BarSeries) -> Value {
    let across = chart.x.as_names();
    let names = |names: &[String], shown: fn(&str) -> String| -> Value {
        names.iter().map(|name| json!(shown(name))).collect()
    };
    let (x, y, orientation, hover) = match (across, chart.y.as_names()) {
        (Some(across), _) => (names(across, shown_across), json!(series.counts), "v", "from %{x}: %{y:,}"),
        (None, down) => (json!(series.counts), names(down.unwrap_or_default(), shown_down), "h", "%{y}: %{x:,}"),
    };
    json!({
        "type": "bar", "orientation": orientation, "name": series.name, "marker": { "color": format!("${}", series.color.name()) },
        "x": x, "y": y, "hovertemplate": format!("{hover}<extra>%{{fullData.name}}</extra>"),
    })
}

fn heat_map(x: &[String], y: &[String], map: &HeatMap) -> Value {
    let text: Vec<Vec<String>> = map
        .percent
        .iter()
        .map(|row| row.iter().map(|share| share.map_or(String::new(), |p| format!("{p:.1}"))).collect())
        .collect();
    let [zmin, zmax] = map.colors_from_to;
    json!({
        "type": "heatmap", "x": x.iter().map(|name| shown_across(name)).collect::<Vec<_>>(),
        "y": y.iter().map(|name| shown_down(name)).collect::<Vec<_>>(), "z": map.percent, "text": text,
        "texttemplate": "%{text}", "xgap": 1, "ygap": 1, "colorscale": "$scale", "zmin": zmin, "zmax": zmax,
        "showscale": false, "hoverongaps": false, "hovertemplate": "%{y}, %{x}: %{text} %<extra></extra>",
    })
}

#[cfg(test)]
mod tests {
    use super::spec;
    use crate::chart::{Chart, ChartAxis, ChartColor, ChartContent, ChartPoint, Curve, LogScale};

    #[test]
    fn names_of_many_decades_do_not_touch() {
        let every = |decades: i32| {
            let points = [0, decades].map(|k| ChartPoint::new(1.0, 10f64.powi(k))).to_vec();
            let color = ChartColor::among("mine", &["mine".to_owned(), "stepper-f64".to_owned()]);
            let curve = Curve { name: String::new(), color, line: None, marker: Some(0), points };
            let axes = [ChartAxis::from_zero("x"), ChartAxis::log("y", LogScale::default())];
            let chart = Chart::new("chart-c", "c", 340, axes, ChartContent::Curves(vec![curve], None));
            spec(&chart)["layout"]["yaxis"]["dtick"].as_i64()
        };
        assert_eq!([4, 7, 12, 20].map(every), [1, 1, 2, 3].map(Some));
    }

    #[test]
    fn an_engine_has_one_colour() {
        let engines = ["mine", "stepper-f32", "stepper-f64", "theirs"].map(str::to_owned);
        let colors = engines.each_ref().map(|engine| ChartColor::among(engine, &engines));
        assert_eq!(colors, [4, 0, 1, 5].map(ChartColor::Series));
    }
}
