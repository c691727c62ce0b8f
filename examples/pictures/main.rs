//! Draws the pictures of the documentation into `docs/images`: `cargo run --release --example pictures`.
//!
//! Shapes, contacts and radii come from the library, so a picture shows what the code does. `tests/documentation/pictures.rs` draws
//! them again and compares.

mod drawings;

use std::path::Path;

fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/images");
    std::fs::create_dir_all(&folder)?;
    for (name, svg) in drawings::pictures() {
        let path = folder.join(name);
        std::fs::write(&path, svg)?;
        println!("{}", path.display());
    }
    Ok(())
}
