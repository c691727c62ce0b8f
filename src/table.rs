//! Tables for people, all in one style.

use comfy_table::{CellAlignment, ContentArrangement, Table, TableComponent, presets};

use rockproof_model::text::{SHOWN, excerpt};
pub(crate) use rockproof_report::table::grouped;

/// A table with a header; the columns named in `numbers` are aligned to the right. Cells are of one line and show what they hold, cut where it
/// is long.
pub(crate) fn table(header: &[&str], numbers: &[usize], rows: impl IntoIterator<Item = Vec<String>>) -> Table {
    let mut table = Table::new();
    table.load_preset(presets::UTF8_HORIZONTAL_ONLY).set_content_arrangement(ContentArrangement::Disabled);
    // A line under the header, none between rows.
    table.remove_style(TableComponent::HorizontalLines);
    table.remove_style(TableComponent::MiddleIntersections);
    table.set_header(header.iter().map(|cell| excerpt(cell, SHOWN)));
    for &at in numbers {
        if let Some(column) = table.column_mut(at) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    for row in rows {
        table.add_row(row.iter().map(|cell| excerpt(cell, SHOWN)));
    }
    table
}
