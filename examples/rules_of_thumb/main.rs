//! Measures what each tolerance does to contact types and penetration, and writes the tables and plots of docs/rules_of_thumb.md.
//!
//! `cargo run --release --example rules_of_thumb [FOLDER]`: writes `rules_of_thumb_tables.md` and `images/rules/*.svg` into the folder, `docs` by
//! default. No figure depends on the machine or on time.

mod grid;
mod page;
mod steps;

use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).map_or_else(|| PathBuf::from("docs"), PathBuf::from);
    let rows = grid::measure(grid::PAIRS)?;
    let approaches = steps::approaches()?;
    let crossings = steps::crossings()?;
    let classic = steps::classic_crossings()?;
    let images = folder.join("images/rules");
    std::fs::create_dir_all(&images)?;
    for (name, chart) in page::charts(&rows, &approaches, &crossings) {
        rockproof_results::write_atomically(images.join(format!("{name}.svg")), chart.svg()?)?;
    }
    let text = page::tables(&rows, &approaches, &crossings, &classic);
    rockproof_results::write_atomically(folder.join("rules_of_thumb_tables.md"), text)?;
    Ok(())
}
