//! Charts as plotly takes them. Colours are named (`$f32`, `$cause2`, …); the page puts in those of its light or dark theme.

use serde::Serialize;
use serde_json::{Value, json};

/// A chart.
#[derive(Clone, Debug, Serialize)]
pub struct Chart {
    /// Its name in the page.
    pub id: String,
    /// What it shows, for those who do not see it and as a caption.
    pub caption: String,
    /// Height in CSS pixels.
    pub height: u32,
    /// Whether two stand beside each other on a wide screen.
    pub half: bool,
    /// `{ data, layout }`.
    pub spec: Value,
}

/// The colours of a series of things.
pub fn color(number: usize) -> String {
    format!("$series{}", number % 8)
}

/// The colour of an engine: the same in every chart. `at` is its place among those that are not built in.
pub fn engine_color(engine: &str, at: usize) -> String {
    let known = ["stepper-f32", "stepper-f64", "certified", "exact"];
    color(known.iter().position(|name| *name == engine).unwrap_or(known.len() + at))
}

/// A long name in lines of some 24 characters, as plotly breaks them, and how many lines.
pub fn in_lines(name: &str) -> (String, usize) {
    let mut lines = vec![String::new()];
    for word in name.split(' ') {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.len() + word.len() < 24 => *line += &format!(" {word}"),
            _ => lines.push(word.to_owned()),
        }
    }
    (lines.join("<br>"), lines.len())
}

impl Chart {
    /// A chart.
    pub fn new(
        id: impl Into<String>,
        caption: impl Into<String>,
        height: usize,
        data: Vec<Value>,
        layout: Value,
    ) -> Chart {
        let height = u32::try_from(height).unwrap_or(u32::MAX);
        Chart {
            id: id.into(),
            caption: caption.into(),
            height,
            half: false,
            spec: json!({ "data": data, "layout": layout }),
        }
    }

    /// The chart, to stand beside another one on a wide screen.
    pub fn half(self) -> Chart {
        Chart { half: true, ..self }
    }
}

/// A share with its interval, as plotly's error bar takes it.
pub fn error_bars(shares: &[rockproof_campaign::proportion::Proportion]) -> Value {
    json!({
        "type": "data", "symmetric": false, "thickness": 1.5, "width": 3,
        "array": shares.iter().map(|s| (s.high - s.value) * 100.0).collect::<Vec<_>>(),
        "arrayminus": shares.iter().map(|s| (s.value - s.low) * 100.0).collect::<Vec<_>>(),
    })
}

/// A heat map of shares in percent with the numbers written in, coloured from the least share or from nothing; `None` is
/// left blank.
pub fn heat_map(x: &[String], y: &[String], shares: &[Vec<Option<f64>>], from_least: bool) -> Value {
    let percent: Vec<Vec<Option<f64>>> =
        shares.iter().map(|row| row.iter().map(|s| s.map(|s| s * 100.0)).collect()).collect();
    let text: Vec<Vec<String>> = percent
        .iter()
        .map(|row| row.iter().map(|p| p.map_or(String::new(), |p| format!("{p:.1}"))).collect())
        .collect();
    let least = percent.iter().flatten().flatten().copied().fold(100.0, f64::min);
    let most = percent.iter().flatten().flatten().copied().fold(0.0, f64::max);
    let [zmin, zmax] = if from_least && most > least { [least, most] } else { [0.0, 100.0] };
    json!({
        "type": "heatmap", "x": x, "y": y, "z": percent, "text": text, "texttemplate": "%{text}", "xgap": 1, "ygap": 1,
        "colorscale": "$scale", "zmin": zmin, "zmax": zmax, "showscale": false, "hoverongaps": false,
        "hovertemplate": "%{y}, %{x}: %{text} %<extra></extra>",
    })
}
