//! The pictures of the documentation are what the code draws: `cargo run --release --example pictures` renews them.

use std::path::Path;

#[test]
fn committed_pictures_are_current() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/images");
    let pictures = crate::drawings::pictures();
    for (name, drawn) in &pictures {
        let committed = std::fs::read_to_string(folder.join(name)).unwrap_or_default().replace("\r\n", "\n");
        assert!(*drawn == committed, "docs/images/{name} is stale; run `cargo run --release --example pictures`");
    }
    let mut kept: Vec<String> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| name.ends_with(".svg"))
        .collect();
    kept.sort();
    let mut names: Vec<String> = pictures.iter().map(|(name, _)| (*name).to_owned()).collect();
    names.sort();
    assert_eq!(kept, names, "pictures that nothing draws, or that were not committed");
}
