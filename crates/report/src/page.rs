//! The report as one page of HTML with all it needs inside: styles, scripts, data.
//!
//! The page is a minijinja template, which escapes whatever is put in; data for scripts goes through its JSON filter, which
//! leaves no `<`. A content security policy in the page forbids any request.

use super::Report;
use super::fault::ReportError;
use super::glossary::GLOSSARY;
use super::sections::{Part, Section};
use minijinja::value::Serde;
use minijinja::{Environment, Value, context};
use serde::Serialize;

const TEMPLATE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
const SCRIPT: &str = include_str!("page/script.js");
/// Charts: scatter, bars, heat maps.
const CARTESIAN: &str = include_str!("vendor/plotly/plotly-cartesian.min.js");
/// Views: meshes and lines in three dimensions.
const GL3D: &str = include_str!("vendor/plotly/plotly-gl3d.min.js");

/// The page.
///
/// # Errors
/// Those of the template engine.
pub fn page(report: &Report) -> Result<String, ReportError> {
    let mut environment = Environment::new();
    environment.add_template("page.html", TEMPLATE)?;
    let parts = || report.sections.iter().flat_map(|section| &section.parts);
    let charts = parts().any(|part| matches!(part, Part::Chart(_)));
    let views = parts().any(|part| matches!(part, Part::Findings(views) if !views.is_empty()));
    let page = environment.get_template("page.html")?;
    Ok(page.render(context! {
        title => report.title.clone(),
        version => env!("CARGO_PKG_VERSION"),
        verdict => told(&report.verdict),
        sections => report.sections.iter().map(section).collect::<Vec<_>>(),
        glossary => GLOSSARY.map(|(term, meaning)| context! { term, meaning }),
        style => STYLE,
        script => SCRIPT,
        cartesian => charts.then_some(CARTESIAN),
        gl3d => views.then_some(GL3D),
    })?)
}

/// Anything serde knows, as the template takes it.
fn told(value: impl Serialize) -> Value {
    Value::from(Serde(value))
}

fn section(section: &Section) -> Value {
    let parts: Vec<Value> = section.parts.iter().filter_map(part).collect();
    context! { id => section.id, title => section.title, lead => &section.lead, parts }
}

fn part(part: &Part) -> Option<Value> {
    Some(match part {
        Part::Text(text) => context! { what => "text", text },
        Part::Table(table, most) => context! { what => "table", table => told(table.page(*most)) },
        Part::Quiet(_) => return None,
        Part::Chart(chart) => context! { what => "chart", chart => told(chart) },
        Part::Matrices(matrices) => context! { what => "matrices", matrices => told(matrices) },
        Part::Findings(views) => context! { what => "findings", findings => told(views) },
    })
}
