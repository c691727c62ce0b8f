//! Tables as they go into the page, into CSV files and into Markdown: one source for all three, and for [`super::latex`].

use rockproof_model::text::{EXCERPT_LENGTH, csv_cell, excerpt, noun};
use serde::Serialize;

/// What a cell holds.
#[derive(Clone, Debug, PartialEq)]
pub enum TableCell {
    /// Nothing.
    Empty,
    /// Words.
    Text(String),
    /// Whom a finding is about: an engine, or a precision, which is shown as [`concerned`] says.
    Scope(String),
    /// A count.
    Count(u64),
    /// A share from 0 to 1, shown in percent.
    Share(f64),
    /// Any other number.
    Number(f64),
    /// A number that is set in a file, and that a reader may copy.
    Setting(f64),
}

impl From<&str> for TableCell {
    fn from(text: &str) -> TableCell {
        TableCell::Text(text.to_owned())
    }
}

impl From<String> for TableCell {
    fn from(text: String) -> TableCell {
        TableCell::Text(text)
    }
}

impl From<u64> for TableCell {
    fn from(count: u64) -> TableCell {
        TableCell::Count(count)
    }
}

impl TableCell {
    /// A number, or nothing.
    pub fn number(value: Option<f64>) -> TableCell {
        value.map_or(TableCell::Empty, TableCell::Number)
    }

    /// As in a CSV file: numbers the shortest that give the value back, shares to six digits, no text a formula.
    pub fn raw(&self) -> String {
        match self {
            TableCell::Empty => String::new(),
            TableCell::Text(text) | TableCell::Scope(text) => csv_cell(text),
            TableCell::Count(count) => count.to_string(),
            TableCell::Share(share) => format!("{share:.6}"),
            TableCell::Number(number) | TableCell::Setting(number) => format!("{number:?}"),
        }
    }

    /// As a reader likes it: thousands apart, shares in percent, numbers to three digits, settings to six.
    pub fn shown(&self) -> String {
        match self {
            TableCell::Empty => "–".to_owned(),
            TableCell::Text(text) => excerpt(text, EXCERPT_LENGTH),
            TableCell::Scope(scope) => excerpt(&concerned(scope), EXCERPT_LENGTH),
            TableCell::Count(count) => grouped(*count),
            TableCell::Share(share) => percent(*share),
            TableCell::Number(number) => short(*number),
            TableCell::Setting(number) => six_digits(*number),
        }
    }

    fn is_number(&self) -> bool {
        !matches!(self, TableCell::Text(_) | TableCell::Scope(_))
    }
}

/// How many there are, with the word for one or for several.
pub fn counted(count: u64, one: &str, several: &str) -> String {
    format!("{} {}", grouped(count), noun(count, one, several))
}

/// A count with its thousands apart: `1 234 567`.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// A share in percent. Never rounded to all or nothing: what is not all is shown as less.
pub fn percent(share: f64) -> String {
    match share * 100.0 {
        p if p == 0.0 || p == 100.0 => format!("{p} %"),
        p if p > 99.99 => "> 99.99 %".to_owned(),
        p if p < 0.01 => "< 0.01 %".to_owned(),
        p => format!("{p:.2} %"),
    }
}

/// A number in at most six digits.
pub fn six_digits(value: f64) -> String {
    format!("{:?}", format!("{value:.5e}").parse().unwrap_or(value))
}

/// Whom a finding is about: an engine, or what every engine is given that works in a precision, which has no engine's name.
pub fn concerned(scope: &str) -> String {
    match scope {
        "f32" | "f64" => format!("input in {scope}"),
        engine => engine.to_owned(),
    }
}

/// A number to three digits.
pub fn short(number: f64) -> String {
    match number.abs() {
        0.0 => "0".to_owned(),
        size if (0.01..10.0).contains(&size) => format!("{number:.3}"),
        size if (10.0..10_000.0).contains(&size) => format!("{number:.1}"),
        _ => format!("{number:.2e}"),
    }
}

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The stem of its CSV file.
    pub name: &'static str,
    /// What it shows, in one line.
    pub caption: String,
    /// The names of the columns.
    pub columns: Vec<&'static str>,
    /// The rows, each as long as `columns`.
    pub rows: Vec<Vec<TableCell>>,
    /// Whether readers are told the run of each row though it is the same for all: others have no row here.
    pub keeps_run: bool,
}

/// A table as the page's template takes it.
#[derive(Debug, Serialize)]
pub(super) struct RenderedTable {
    name: &'static str,
    caption: String,
    head: Vec<ColumnHead>,
    rows: Vec<Vec<String>>,
    left_out: usize,
}

#[derive(Debug, Serialize)]
struct ColumnHead {
    name: String,
    number: bool,
}

impl Table {
    /// An empty table.
    pub fn new(name: &'static str, caption: impl Into<String>, columns: &[&'static str]) -> Table {
        Table { name, caption: caption.into(), columns: columns.to_vec(), rows: Vec::new(), keeps_run: false }
    }

    /// Adds a row.
    pub fn push(&mut self, row: Vec<TableCell>) {
        self.rows.push(row);
    }

    pub(crate) fn is_number(&self, column: usize) -> bool {
        !self.rows.is_empty() && self.rows.iter().all(|row| row.get(column).is_some_and(TableCell::is_number))
    }

    /// The runs that its rows are of, where its first column names them.
    pub(crate) fn runs(&self) -> impl Iterator<Item = &TableCell> {
        let names_runs = self.columns.first() == Some(&"run");
        self.rows.iter().filter(move |_| names_runs).filter_map(|row| row.first())
    }

    /// The columns a reader needs: without the run where there is only one.
    pub(crate) fn needed(&self) -> std::ops::Range<usize> {
        let one = self.columns.first() == Some(&"run") && self.name != "runs" && !self.keeps_run;
        let same = self.rows.iter().all(|row| row.first() == self.rows[0].first());
        usize::from(one && same)..self.columns.len()
    }

    /// The table for the page, at most `most` rows of it.
    pub(super) fn page(&self, most: usize) -> RenderedTable {
        let needed = self.needed();
        let head = self.columns.iter().enumerate().skip(needed.start);
        RenderedTable {
            name: self.name,
            caption: self.caption.clone(),
            head: head
                .map(|(i, name)| ColumnHead { name: name.replace('_', " "), number: self.is_number(i) })
                .collect(),
            rows: self
                .rows
                .iter()
                .take(most)
                .map(|row| row[needed.clone()].iter().map(TableCell::shown).collect())
                .collect(),
            left_out: self.rows.len().saturating_sub(most),
        }
    }

    /// The table as CSV.
    ///
    /// # Errors
    /// Those of the CSV writer.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(&self.columns)?;
        for row in &self.rows {
            writer.write_record(row.iter().map(TableCell::raw))?;
        }
        writer.into_inner().map_err(|e| e.into_error().into())
    }

    /// The table as Markdown, at most `most` rows of it.
    pub fn to_markdown(&self, most: usize) -> String {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let clean = |text: &str| text.replace('|', "\\|").replace(['\n', '\r'], " ").replace('<', "&lt;");
        let needed = self.needed();
        let mut text = line(self.columns[needed.clone()].iter().map(|name| name.replace('_', " ")).collect());
        let rule = |i| if self.is_number(i) { "--:".to_owned() } else { "---".to_owned() };
        text += &line(needed.clone().map(rule).collect());
        for row in self.rows.iter().take(most) {
            text += &line(row[needed.clone()].iter().map(|cell| clean(&cell.shown())).collect());
        }
        if self.rows.len() > most {
            text += &format!("\n{} more rows in {}.csv\n", self.rows.len() - most, self.name);
        }
        text
    }
}

/// The name of a run before what it is about, where there are several.
pub(crate) fn label(runs: usize, run: &str, what: &str) -> String {
    if runs > 1 { format!("{run}: {what}") } else { what.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::{Table, TableCell, grouped, percent};

    #[test]
    fn groups_by_three() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1\u{202f}000", "1\u{202f}234\u{202f}567"]);
    }

    #[test]
    fn settings_are_shown_as_they_are_copied() {
        let shown = [0.0125, 0.1, 1.0 / 3.0, 2.0e-12].map(|value| TableCell::Setting(value).shown());
        assert_eq!(shown, ["0.0125", "0.1", "0.333333", "2e-12"]);
        assert_eq!(TableCell::Setting(1.0 / 3.0).raw(), "0.3333333333333333");
    }

    #[test]
    fn nearly_all_is_not_all() {
        assert_eq!([0.0, 1e-9, 0.5, 0.999_999, 1.0].map(percent), ["0 %", "< 0.01 %", "50.00 %", "> 99.99 %", "100 %"]);
    }

    #[test]
    fn a_precision_is_shown_as_no_engine() {
        let mut table = Table::new("causes", "a table", &["engine"]);
        table.push(vec![TableCell::Scope("f32".to_owned())]);
        table.push(vec![TableCell::Scope("stepper-f32".to_owned())]);
        assert_eq!(table.to_csv().expect("csv"), b"engine\nf32\nstepper-f32\n");
        let text = table.to_markdown(2);
        assert!(text.contains("| input in f32 |\n| stepper-f32 |"), "{text}");
        // Of runs of a scene it is the stepper's precision.
        table.push(vec!["f32".into()]);
        assert!(table.to_markdown(3).ends_with("| f32 |\n"));
    }

    #[test]
    fn the_same_table_in_each_form() {
        let mut table = Table::new("t", "a table", &["who", "so_many"]);
        table.push(vec!["a|b <c>".into(), TableCell::Count(12_345)]);
        table.push(vec!["=d\n".into(), TableCell::Empty]);
        assert_eq!(table.to_csv().expect("csv"), b"who,so_many\na|b <c>,12345\n'=d\\n,\n");
        assert_eq!(table.rows[1][0].shown(), "=d\\n");
        let text = table.to_markdown(1);
        assert!(text.contains("| a\\|b &lt;c> | 12\u{202f}345 |") && text.contains("1 more rows in t.csv"), "{text}");
    }
}
