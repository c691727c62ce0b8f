//! The stepper and the oracle are two implementations of one specification: the stepper's sources may not use the oracle,
//! nor the integers it calculates with.

use std::path::Path;

#[test]
fn the_stepper_does_not_use_the_oracle() {
    let mut files = 0;
    visit(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src/stepper"), &mut |path, text| {
        files += 1;
        for line in text.lines().filter(|line| !line.trim_start().starts_with("//")) {
            let foreign =
                ["oracle", "ruint", "rug::", "model::ring", "ExactRing"].iter().find(|word| line.contains(**word));
            assert!(foreign.is_none(), "{}: {line}", path.display());
        }
    });
    assert!(files >= 15, "only {files} files read");
}

fn visit(folder: &Path, look: &mut impl FnMut(&Path, &str)) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            visit(&path, look);
        } else {
            look(&path, &std::fs::read_to_string(&path).unwrap());
        }
    }
}
