//! The report as one page of HTML with all it needs inside: styles, scripts, data.
//!
//! The page is a minijinja template, which escapes whatever is put in; data for scripts goes through its JSON filter, which
//! leaves no `<`. A content security policy in the page forbids any request.

use super::Report;
use super::chart::svg::svg;
use super::chart::values::csv;
use super::chart::{Chart, plotly};
use super::error::ReportError;
use super::glossary::GLOSSARY;
use super::sections::{Section, SectionPart};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
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
    let charts = parts().any(|part| matches!(part, SectionPart::Chart(_)));
    let views = parts().any(|part| matches!(part, SectionPart::Findings(views) if !views.is_empty()));
    let page = environment.get_template("page.html")?;
    Ok(page.render(context! {
        title => report.title.clone(),
        version => env!("CARGO_PKG_VERSION"),
        verdict => html_value(&report.verdict),
        sections => report.sections.iter().map(section).collect::<Result<Vec<_>, _>>()?,
        glossary => GLOSSARY.map(|(term, meaning)| context! { term, meaning }),
        style => STYLE,
        script => SCRIPT,
        cartesian => charts.then_some(CARTESIAN),
        gl3d => views.then_some(GL3D),
    })?)
}

/// Anything serde knows, as the template takes it.
fn html_value(value: impl Serialize) -> Value {
    Value::from(Serde(value))
}

fn section(section: &Section) -> Result<Value, ReportError> {
    let parts: Vec<Value> = section.parts.iter().filter_map(|one| part(one).transpose()).collect::<Result<_, _>>()?;
    Ok(context! { id => section.id, title => section.title, lead => &section.lead, parts })
}

fn part(part: &SectionPart) -> Result<Option<Value>, ReportError> {
    Ok(Some(match part {
        SectionPart::Text(text) | SectionPart::Unreadable(text) => context! { what => "text", text },
        SectionPart::Table(table, most) => context! { what => "table", table => html_value(table.page(*most)) },
        SectionPart::Quiet(_) => return Ok(None),
        SectionPart::Chart(chart) => context! { what => "chart", chart => self::chart(chart)? },
        SectionPart::Matrices(matrices) => context! { what => "matrices", matrices => html_value(matrices) },
        SectionPart::Findings(views) => context! { what => "findings", findings => html_value(views) },
    }))
}

/// A chart: what plotly draws, and what is printed or saved instead.
fn chart(chart: &Chart) -> Result<Value, ReportError> {
    Ok(context! {
        id => &chart.id,
        stem => chart.stem(),
        caption => &chart.caption,
        height => chart.height,
        half => chart.half,
        spec => html_value(plotly::spec(chart)),
        svg => STANDARD.encode(svg(chart).map_err(ReportError::Drawing)?),
        csv => STANDARD.encode(csv(chart)?),
    })
}
