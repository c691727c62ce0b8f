//! Tables for people, all in one style.

use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Table, TableComponent, Width, presets};
use std::io;

use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
pub(crate) use rockproof_report::table::{counted, grouped};

/// A table with a header; the columns named in `numbers` are aligned to the right. Cells are of one line and show what they hold, cut where it
/// is long. On a terminal it is no wider than that; elsewhere it is as wide as its cells ask for.
pub(crate) fn table(header: &[&str], numbers: &[usize], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut table = Cells::new(header, numbers);
    table.rows.extend(rows.into_iter().map(|row| row.iter().map(|cell| excerpt(cell, EXCERPT_LENGTH)).collect()));
    let terminal = terminal_size::terminal_size_of(io::stdout());
    match terminal {
        Some((terminal_size::Width(width), _)) => table.within(usize::from(width)),
        None => table.drawn(&table.all(), None).to_string(),
    }
}

/// Sentences whose lines on a terminal are no wider than that, broken between words; elsewhere as they are.
pub(crate) fn prose(text: &str) -> String {
    match terminal_size::terminal_size_of(io::stdout()) {
        Some((terminal_size::Width(width), _)) => wrapped(text, usize::from(width)),
        None => text.to_owned(),
    }
}

/// A text in lines of at most so many characters, but for longer words; what a line goes on with stands under its first word.
fn wrapped(text: &str, width: usize) -> String {
    let mut out = String::new();
    for line in text.lines() {
        let indent = " ".repeat(line.chars().take_while(|c| *c == ' ').count());
        let mut length = 0;
        for (number, word) in line.trim_start().split(' ').enumerate() {
            let more = word.chars().count() + usize::from(number > 0);
            if number > 0 && length + more > width {
                out += &format!("\n{indent}{word}");
                length = indent.len() + word.chars().count();
            } else {
                out += &if number > 0 { format!(" {word}") } else { format!("{indent}{word}") };
                length += more + if number > 0 { 0 } else { indent.len() };
            }
        }
        out.push('\n');
    }
    out
}

/// The cells of a table.
struct Cells<'a> {
    header: Vec<String>,
    numbers: &'a [usize],
    rows: Vec<Vec<String>>,
}

/// Columns, and how wide each is without the space around it.
type Widths = Vec<(usize, usize)>;

/// Beside what a column holds: a space on each side, and one between two columns.
const SPACE: usize = 3;

impl<'a> Cells<'a> {
    fn new(header: &[&str], numbers: &'a [usize]) -> Cells<'a> {
        Cells { header: header.iter().map(|cell| excerpt(cell, EXCERPT_LENGTH)).collect(), numbers, rows: Vec::new() }
    }

    fn all(&self) -> Vec<usize> {
        (0..self.header.len()).collect()
    }

    /// The largest of a measure over the cells of a column.
    fn largest(&self, column: usize, measure: impl Fn(&str) -> usize) -> usize {
        let cells = self.rows.iter().filter_map(|row| row.get(column)).chain([&self.header[column]]);
        cells.map(|cell| measure(cell)).max().unwrap_or(0).max(1)
    }

    /// The table in lines of at most `width` characters. Cells wrap between words as far as that does; where it does not, columns continue in
    /// tables below, each with the first column again. Where a word of these is wider still, it wraps as well.
    fn within(&self, width: usize) -> String {
        let whole: Vec<usize> =
            self.all().iter().map(|&column| self.largest(column, |cell| cell.chars().count())).collect();
        if total(&whole) <= width {
            return self.drawn(&self.all(), None).to_string();
        }
        let words = |cell: &str| cell.split(' ').map(|word| word.chars().count()).max().unwrap_or(0);
        let least: Vec<usize> = self.all().iter().map(|&column| self.largest(column, words)).collect();
        let tables: Vec<String> = groups(&least, width)
            .into_iter()
            .map(|columns| {
                let widths = shared_out(&columns, &least, &whole, width);
                self.drawn(&columns, Some(&widths)).to_string()
            })
            .collect();
        tables.join("\n")
    }

    /// The table of some columns, of the widths given or as wide as their cells.
    fn drawn(&self, columns: &[usize], widths: Option<&Widths>) -> Table {
        let mut table = Table::new();
        table.load_preset(presets::UTF8_HORIZONTAL_ONLY).set_content_arrangement(ContentArrangement::Disabled);
        // A line under the header, none between rows.
        table.remove_style(TableComponent::HorizontalLines);
        table.remove_style(TableComponent::MiddleIntersections);
        table.set_header(columns.iter().map(|&column| &self.header[column]));
        for (at, number) in columns.iter().enumerate() {
            let Some(column) = table.column_mut(at) else { continue };
            if self.numbers.contains(number) {
                column.set_cell_alignment(CellAlignment::Right);
            }
            if let Some((_, width)) = widths.and_then(|widths| widths.iter().find(|(column, _)| column == number)) {
                let padded = u16::try_from(width + SPACE - 1).unwrap_or(u16::MAX);
                column.set_constraint(ColumnConstraint::Absolute(Width::Fixed(padded)));
            }
        }
        for row in &self.rows {
            table.add_row(columns.iter().filter_map(|&column| row.get(column)));
        }
        table
    }
}

/// The width of a table whose columns are so wide.
fn total(widths: &[usize]) -> usize {
    widths.iter().map(|width| width + SPACE).sum::<usize>().saturating_sub(1)
}

/// Columns that stand beside one another; the first of all columns is in every group.
fn groups(least: &[usize], width: usize) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = vec![vec![0]];
    for column in 1..least.len() {
        let Some(group) = groups.last_mut() else { break };
        let with: Vec<usize> = group.iter().chain([&column]).map(|&column| least[column]).collect();
        // A group of the first column alone would say nothing.
        if group.len() == 1 || total(&with) <= width {
            group.push(column);
        } else {
            groups.push(vec![0, column]);
        }
    }
    groups
}

/// How wide each column is: as its longest word at least, and beyond that, column by column, as its cells ask for while there is room. Where not
/// even the words have room, the widest columns give way.
fn shared_out(columns: &[usize], least: &[usize], whole: &[usize], width: usize) -> Widths {
    let mut widths: Vec<usize> = columns.iter().map(|&column| least[column]).collect();
    while total(&widths) > width {
        match widths.iter_mut().max().filter(|widest| **widest > 1) {
            Some(widest) => *widest -= 1,
            None => break,
        }
    }
    loop {
        let mut has_grown = false;
        for (at, &column) in columns.iter().enumerate() {
            if total(&widths) < width && widths[at] < whole[column] && widths[at] >= least[column] {
                widths[at] += 1;
                has_grown = true;
            }
        }
        if !has_grown {
            break;
        }
    }
    columns.iter().copied().zip(widths).collect()
}

#[cfg(test)]
mod tests {
    use super::{Cells, wrapped};
    use crate::campaign_end::STEP_COLUMNS;

    fn steps() -> Cells<'static> {
        let header: Vec<&str> = std::iter::once("engine").chain(STEP_COLUMNS).collect();
        let mut cells = Cells::new(&header, &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]);
        let row = (0..12).map(|n| if n == 0 { "stepper-f32".to_owned() } else { (1001 * n).to_string() });
        cells.rows.push(row.collect());
        cells
    }

    #[test]
    fn sentences_break_between_words() {
        let text = "f32, no ties: safe to 1e2.\n  ✓ set  short\n";
        assert_eq!(wrapped(text, 80), text);
        assert_eq!(wrapped(text, 12), "f32, no\nties: safe\nto 1e2.\n  ✓ set \n  short\n");
        assert_eq!(wrapped("longerthanthat and\n", 4), "longerthanthat\nand\n");
    }

    fn sentences() -> Cells<'static> {
        let mut cells = Cells::new(&["verdict", "check", "found"], &[]);
        for (verdict, check, found) in [
            (
                "pass",
                "corpus cases/regressions/a.toml",
                "the finding recurs as recorded, and the exact answer is the one expected",
            ),
            (
                "fail",
                "findings with cause = defect at most 0",
                "12 findings in 320 pairs, and more words than fit into one line",
            ),
        ] {
            cells.rows.push([verdict, check, found].map(str::to_owned).to_vec());
        }
        cells
    }

    fn widest(text: &str) -> usize {
        text.lines().map(|line| line.chars().count()).max().unwrap_or(0)
    }

    #[test]
    fn tables_fit_and_lose_no_word() {
        for cells in [steps(), sentences()] {
            for width in [200, 120, 80, 60, 40] {
                let text = cells.within(width);
                assert!(widest(&text) <= width, "{width}:\n{text}");
                let words: Vec<&str> = text.split_whitespace().collect();
                for word in cells.rows.iter().chain([&cells.header]).flatten().flat_map(|cell| cell.split(' ')) {
                    assert!(words.contains(&word), "{width}, {word}:\n{text}");
                }
            }
        }
    }

    #[test]
    fn columns_wrap_and_then_continue_below() {
        let one_below_the_other = |text: &str| text.lines().filter(|line| line.contains("stepper-f32")).count();
        // The longest words take 89 characters, and 35 are between them.
        assert_eq!(one_below_the_other(&steps().within(124)), 1);
        assert_eq!(one_below_the_other(&steps().within(123)), 2);
        assert_eq!(one_below_the_other(&steps().within(80)), 2);
        assert_eq!(one_below_the_other(&steps().within(40)), 5);
        let text = sentences().within(80);
        assert_eq!(text.matches("verdict").count(), 1, "{text}");
    }

    #[test]
    fn a_word_without_room_is_broken_and_not_cut() {
        let mut cells = Cells::new(&["a", "b"], &[]);
        let long: String = ('a'..='z').cycle().take(70).collect();
        cells.rows.push(vec![long.clone(), "1".to_owned()]);
        let text = cells.within(40);
        assert!(widest(&text) <= 40, "{text}");
        let letters: String = text.lines().skip(3).flat_map(str::chars).filter(char::is_ascii_lowercase).collect();
        assert_eq!(letters, long, "{text}");
    }

    #[test]
    fn where_there_is_room_nothing_changes() {
        for cells in [steps(), sentences()] {
            let plain = cells.drawn(&cells.all(), None).to_string();
            assert_eq!(cells.within(widest(&plain)), plain);
            assert_ne!(cells.within(widest(&plain) - 1), plain);
        }
    }
}
