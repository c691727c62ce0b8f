//! The checks of a gate for other programs: JUnit XML, GitHub's annotations and step summary.

use super::{Check, CheckStatus, summary};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};
use rockproof_model::text::{excerpt, is_harmful, noun};
use std::time::Duration;

/// What a report is called.
const NAME: &str = "rockproof gate";

/// Whether a text begins as what [`junit`] writes.
pub fn is_ours(text: &str) -> bool {
    let after_declaration = text.strip_prefix("<?xml ").and_then(|rest| rest.split_once("?>"));
    let root = after_declaration.and_then(|(_, rest)| rest.trim_start().strip_prefix("<testsuites "));
    root.is_some_and(|root| root.starts_with(&format!("name=\"{NAME}\"")))
}

/// A text whole, with control characters escaped: a runner that prints the file takes no line of it for a command.
fn on_a_line(text: &str) -> String {
    excerpt(text, usize::MAX)
}

/// JUnit XML: a suite for each group, a case for each check, with the time it took and the command that replays what fails.
///
/// # Errors
/// Those of the XML writer.
pub fn junit(checks: &[Check]) -> Result<String, quick_junit::SerializeError> {
    let mut report = Report::new(NAME);
    let sum = |wanted: &dyn Fn(&&Check) -> bool| {
        Duration::try_from_secs_f64(checks.iter().filter(wanted).map(|check| check.seconds).sum()).unwrap_or_default()
    };
    let of_group = |group: &str| sum(&|check| check.group == group);
    report.set_time(sum(&|_| true));
    for group in ["limit", "engine", "baseline", "corpus", "gate"] {
        if ["engine", "gate"].contains(&group) && !checks.iter().any(|check| check.group == group) {
            continue;
        }
        let mut suite = TestSuite::new(format!("rockproof.{group}"));
        for check in checks.iter().filter(|check| check.group == group) {
            let mut status = match check.status {
                CheckStatus::Pass => TestCaseStatus::success(),
                CheckStatus::Fail => TestCaseStatus::non_success(NonSuccessKind::Failure),
                CheckStatus::Skip => TestCaseStatus::skipped(),
            };
            if check.status != CheckStatus::Pass {
                status.set_message(on_a_line(&check.message));
            }
            if check.status == CheckStatus::Fail {
                status.set_type("gate");
                if let Some(replay) = &check.replay {
                    status.set_description(on_a_line(replay));
                }
            }
            let mut case = TestCase::new(on_a_line(&check.name), status);
            case.set_time(Duration::try_from_secs_f64(check.seconds).unwrap_or_default());
            case.set_classname(format!("rockproof.{group}"));
            // What is gone of a baseline, or what an engine left unsaid, is worth a word though nothing fails.
            if check.status == CheckStatus::Pass && ["limit", "engine", "baseline"].contains(&group) {
                case.set_system_out(on_a_line(&check.message));
            }
            suite.add_test_case(case);
        }
        suite.set_time(of_group(group));
        report.add_test_suite(suite);
    }
    report.to_string()
}

/// GitHub's annotations, a line for each check that fails. Line breaks are escaped for the runner, other control characters for whoever
/// reads the log.
pub fn annotations(checks: &[Check]) -> String {
    let escaped = |c: char| match c {
        '%' => "%25".to_owned(),
        '\r' => "%0D".to_owned(),
        '\n' => "%0A".to_owned(),
        c if is_harmful(c) && c != '\t' => c.escape_debug().to_string(),
        c => c.to_string(),
    };
    let data = |text: &str| text.chars().map(escaped).collect::<String>();
    let property = |text: &str| data(text).replace(':', "%3A").replace(',', "%2C");
    let failed = checks.iter().filter(|check| check.status == CheckStatus::Fail);
    let line = |check: &Check| {
        let (file, line) = &check.place;
        let (file, title) = (property(file), property(&format!("rockproof {}", check.group)));
        format!(
            "::error file={file},line={line},title={title}::{}\n",
            data(&format!("{}: {}", check.name, check.message))
        )
    };
    failed.map(line).collect()
}

/// So many characters of a check's name or text are in the summary.
const LONGEST: usize = 1000;

/// The summary in Markdown: one row for each check but the corpus' passes.
pub fn markdown(checks: &[Check]) -> String {
    let special = |c: char| if "\\`*_{}[]<>&#|~".contains(c) { format!("\\{c}") } else { c.to_string() };
    let line = |text: &str| excerpt(&text.replace(['\n', '\r'], " "), LONGEST);
    let cell = |text: &str| line(text).chars().map(special).collect::<String>();
    let failed = checks.iter().filter(|check| check.status == CheckStatus::Fail).count();
    let mut text = format!("## Rockproof gate: {}\n\n", if failed == 0 { "passed" } else { "failed" });
    text += "| verdict | check | found |\n| --- | --- | --- |\n";
    for check in checks.iter().filter(|c| c.group != "corpus" || c.status != CheckStatus::Pass) {
        text += &format!("| {} | {} | {} |\n", check.status.name(), cell(&check.name), cell(&check.message));
    }
    let corpus = checks.iter().filter(|c| c.group == "corpus" && c.status == CheckStatus::Pass).count();
    text + &format!("\n{}; {corpus} {} of the corpus passed.\n", summary(checks), noun(corpus, "case", "cases"))
}
