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

/// What is wrong with an external engine, in a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnosed {
    /// The campaign that showed it, as the names of its checks begin: `fixed`.
    pub campaign: String,
    /// The sentence.
    pub sentence: String,
}

impl Diagnosed {
    /// The sentence with its campaign.
    pub fn line(&self) -> String {
        format!("{} campaign: {}", self.campaign, self.sentence)
    }

    fn is_of(&self, check: &Check) -> bool {
        check.name.strip_prefix(&self.campaign).is_some_and(|rest| rest.starts_with(": "))
    }
}

/// JUnit XML: a suite for each group, a case for each check, with the time it took and the command that replays what fails. What is wrong with external engines,
/// a line each as [`Diagnosed`] has them, stands with the first failed check of the campaign that showed it.
///
/// # Errors
/// Those of the XML writer.
pub fn junit(checks: &[Check], diagnosed: &[Diagnosed]) -> Result<String, quick_junit::SerializeError> {
    let mut report = Report::new(NAME);
    let sum = |wanted: &dyn Fn(&&Check) -> bool| {
        Duration::try_from_secs_f64(checks.iter().filter(wanted).map(|check| check.seconds).sum()).unwrap_or_default()
    };
    let of_group = |group: &str| sum(&|check| check.group == group);
    report.set_time(sum(&|_| true));
    let mut untold: Vec<&Diagnosed> = diagnosed.iter().collect();
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
            if check.status == CheckStatus::Fail {
                let (told, rest) = untold.into_iter().partition(|one: &&Diagnosed| one.is_of(check));
                untold = rest;
                if !told.is_empty() {
                    let lines: Vec<String> = told.iter().map(|one| on_a_line(&one.line())).collect();
                    case.set_system_out(lines.join("\n"));
                }
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

/// The summary in Markdown: one row for each check but the corpus' passes, and what is wrong with external engines.
pub fn markdown(checks: &[Check], diagnosed: &[Diagnosed]) -> String {
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
    if !diagnosed.is_empty() {
        text += "\nWhat is wrong, by the answers of the campaign:\n\n";
        text.extend(diagnosed.iter().map(|one| format!("- {}\n", cell(&one.line()))));
    }
    text + &format!("\n{}; {corpus} {} of the corpus passed.\n", summary(checks), noun(corpus, "case", "cases"))
}
