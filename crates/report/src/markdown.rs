//! The report as a short text for a pull request.

use super::Report;
use super::sections::SectionPart;
use super::verdict::Severity;

/// Tables of a pull request's text, and how many rows of each it shows.
const SHOWN: [(&str, usize); 17] = [
    ("changed", 24),
    ("shares", 24),
    ("settings", 24),
    ("agreement", 24),
    ("causes", 8),
    ("diagnosis", 12),
    ("worst", 6),
    ("sweep", 24),
    ("steps", 24),
    ("steps_passages", 24),
    ("lockstep", 20),
    ("lockstep_causes", 20),
    ("lockstep_steps", 12),
    ("audit", 20),
    ("audit_causes", 20),
    ("stress_limits", 24),
    ("runs", 10),
];

/// The report in Markdown: the verdict, and the first rows of the tables that matter.
pub fn markdown(report: &Report) -> String {
    let mut text = format!("## Rockproof: {}\n\n", clean(&report.title));
    for line in &report.verdict {
        let mark = match line.severity {
            Severity::Good => "✅",
            Severity::Fair => "ℹ️",
            Severity::Bad => "❌",
        };
        text += &format!("- {mark} {}\n", clean(&line.text));
    }
    for section in &report.sections {
        for part in &section.parts {
            let (SectionPart::Table(table, _) | SectionPart::Quiet(table)) = part else { continue };
            let Some((_, most)) = SHOWN.iter().find(|(name, _)| *name == table.name) else { continue };
            if table.rows.is_empty() {
                continue;
            }
            text += &format!(
                "\n<details><summary>{}</summary>\n\n{}\n\n{}\n</details>\n",
                section.title,
                clean(&table.caption),
                table.to_markdown(*most)
            );
        }
    }
    text
}

/// Names of directories and engines are the user's.
fn clean(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace(['\n', '\r'], " ")
}
