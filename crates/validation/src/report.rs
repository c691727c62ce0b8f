//! The table of `docs/validation.md`.

use crate::case::{CaseMeasurement, ValidationCase};
use crate::convergence::{Curve, StartUp, Study};
use crate::incline::FirstSwing;
use crate::stepped_scene::CaseFailure;
use rayon::prelude::*;
use std::fmt::Write;

/// A case and what it showed in either precision.
pub struct CaseResult {
    /// The case.
    pub case: ValidationCase,
    /// In f64.
    pub f64: Result<CaseMeasurement, CaseFailure>,
    /// In f32.
    pub f32: Result<CaseMeasurement, CaseFailure>,
}

impl CaseResult {
    /// Whether the case keeps its bound in f64.
    pub fn holds(&self) -> bool {
        self.f64.as_ref().is_ok_and(|measured| self.case.holds(measured))
    }
}

/// Runs every case in both precisions.
pub fn measure(cases: Vec<ValidationCase>) -> Vec<CaseResult> {
    cases.into_par_iter().map(|case| CaseResult { f64: case.f64(), f32: case.f32(), case }).collect()
}

/// The table in Markdown.
pub fn markdown(lines: &[CaseResult]) -> String {
    let mut out = String::from(
        "| case | closed form | error | must be | f64 | f32 | |\n| --- | --- | --- | ---: | ---: | ---: | --- |\n",
    );
    for line in lines {
        let case = &line.case;
        let bound = case.bound.map_or("–".to_owned(), |bound| format!("≤ {}", short(bound)));
        let seen = line.f64.as_ref().map_or_else(ToString::to_string, |measured| measured.seen.clone());
        let mark = if line.holds() { "" } else { "**missed** " };
        let [f64, f32] = [&line.f64, &line.f32].map(shown);
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "| {} | {} | {} | {bound} | {mark}{f64} | {f32} | {seen} |",
            case.name, case.known, case.error
        );
    }
    out
}

/// The studies of convergence in Markdown.
pub fn orders(studies: &[(Study, Curve)]) -> String {
    let mut out = String::from(
        "| quantity | closed form | order in f64 | error at Δt | and at Δt | |\n| --- | --- | ---: | ---: | ---: | --- |\n",
    );
    for (study, curve) in studies {
        let order = study.order.map_or("none".to_owned(), |_| format!("{:.2}", curve.order));
        let at = |point: Option<&(f64, f64, f64)>| {
            point.map_or(String::new(), |&(step, error, _)| format!("{} at {} s", short(error), short(step)))
        };
        let (first, last) = (at(curve.points.first()), at(curve.points.last()));
        let plot = format!("[{}](images/validation/{}.svg)", study.title, study.name);
        // Writing to a String cannot fail.
        let _ = writeln!(out, "| {plot} | {} | {order} | {first} | {last} | {} |", study.known, study.why);
    }
    out
}

/// What start-up costs, and the first swing, in Markdown.
pub fn start_up(all: &[StartUp], swings: &[FirstSwing]) -> String {
    let mut out = String::from(
        "| Δt | not settled | open | 5 settling steps | open | settled to a millionth | open |\n| ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
    );
    for one in all {
        let _ = write!(out, "| {} ms |", 1e3 * one.time_step);
        for (error, open) in one.errors {
            let sign = if error < 0.0 { "−" } else { "+" };
            let _ = write!(out, " {sign}{} | {:.0} % |", short(error.abs()), 100.0 * open);
        }
        out.push('\n');
    }
    out.push_str(
        "\n| settled to a millionth, Δt 0.2 ms: joints stiffer by | friction missing after 20 ms | error of the distance in 0.5 s |\n\
         | ---: | ---: | ---: |\n",
    );
    for swing in swings {
        let _ = writeln!(out, "| {} | {:.3} N s | {:+.1e} |", swing.stiffer, swing.missing, swing.error);
    }
    out
}

fn shown(measured: &Result<CaseMeasurement, CaseFailure>) -> String {
    measured.as_ref().map_or_else(|failure| format!("none: {failure}"), |measured| short(measured.error))
}

/// Two digits.
pub fn short(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        value if (0.01..1000.0).contains(&value) => {
            let near: f64 = format!("{value:.1e}").parse().unwrap_or(value);
            near.to_string()
        }
        value => {
            let text = format!("{value:.1e}");
            text.replace(".0e", "e")
        }
    }
}

/// Puts a text between two marks of a page.
///
/// # Errors
/// When the page has not both marks in order.
pub fn replace(page: &str, name: &str, text: &str) -> Result<String, CaseFailure> {
    let marks = [format!("<!-- {name}: begin -->\n"), format!("<!-- {name}: end -->\n")];
    let missing = || CaseFailure::Unexpected(format!("the page lacks the marks of `{name}`"));
    let begin = page.find(&marks[0]).ok_or_else(missing)? + marks[0].len();
    let end = begin + page[begin..].find(&marks[1]).ok_or_else(missing)?;
    Ok(format!("{}{text}{}", &page[..begin], &page[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_between_marks_only() {
        let page = "a\n<!-- t: begin -->\nold\n<!-- t: end -->\nb\n";
        let renewed = replace(page, "t", "new\n").unwrap();
        assert_eq!(renewed, "a\n<!-- t: begin -->\nnew\n<!-- t: end -->\nb\n");
        assert!(replace(page, "u", "").is_err());
    }

    #[test]
    fn shows_two_digits() {
        assert_eq!(
            [0.0, 1e-12, 1.24e-15, 0.1234, 1.0, 12.0, f64::NAN].map(short),
            ["0", "1e-12", "1.2e-15", "0.12", "1", "12", "NaN"]
        );
    }
}
