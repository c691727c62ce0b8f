//! Good inputs, from which others are made: the corpus of a target, and files of the project.

use crate::Target;
use crate::dice::Dice;
use crate::mutate::mutated;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Files of the project that are good inputs of a target, beside its corpus.
const FILES: [(&str, &[&str]); 11] = [
    (
        "scene",
        &[
            "cases/handmade/wedge.toml",
            "cases/handmade/spring.toml",
            "cases/handmade/ramp_load.toml",
            "cases/handmade/free_fall.toml",
            "cases/handmade/corner_impact_deformable.toml",
        ],
    ),
    (
        "obj",
        &[
            "tests/fixtures/cube_triangles.obj",
            "tests/fixtures/cube_triangles_turned.obj",
            "tests/fixtures/l_block_triangles.obj",
            "tests/fixtures/two_cubes.obj",
        ],
    ),
    ("vtk", &["tests/fixtures/two_cubes.vtk", "tests/fixtures/two_cubes_version_5.vtk"]),
    ("stl", &["tests/fixtures/two_wedges.stl"]),
    ("ply", &["tests/fixtures/box.ply"]),
    ("msh", &["tests/fixtures/cells.msh", "tests/fixtures/surfaces.msh"]),
    ("vtu", &["tests/fixtures/cells.vtu"]),
    ("dda", &["cases/real/smallAngle.dda", "cases/real/smallEdge.dda"]),
    (
        "case",
        &[
            "cases/regressions/v-f-tolerance-edge-territory.toml",
            "cases/regressions/e-v-arithmetic-gap-sign.toml",
            "cases/regressions/e-e-representation-edge-edge-near.toml",
        ],
    ),
    ("gate", &[".ci/gate.toml"]),
    ("campaign", &["examples/other_codes/campaign.toml", "reports/reference/sweep.toml"]),
];

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// The committed inputs of a target, by file, in order: under `fuzz/corpus/`.
///
/// # Panics
/// When a file cannot be read.
pub fn corpus(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let Ok(entries) = fs::read_dir(root().join("fuzz/corpus").join(target)) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry of the corpus").path()).collect();
    paths.sort();
    let read = |path: PathBuf| {
        let bytes = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        (path, bytes)
    };
    paths.into_iter().map(read).collect()
}

/// What begins the name of an input that is refused; the rest is the kind of error, as [`crate::Reach`] counts it.
pub const REFUSED: &str = "refused-";
/// What begins the name of an input that is kept for what it reaches; the rest is that, as [`crate::Reach`] counts it.
pub const REACHES: &str = "reaches-";
/// What begins the name of an input that libFuzzer found to reach something new: good or not.
const GROWN: &str = "grown-";

/// All good inputs of a target that are files: of its corpus and of the project.
///
/// # Panics
/// When a file cannot be read.
pub fn seeds(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let files = FILES.iter().find(|(of, _)| *of == target).map_or(&[][..], |(_, files)| files);
    let of_project = files.iter().map(|name| {
        let path = root().join(name);
        let bytes = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        (path, bytes)
    });
    let is_good = |path: &Path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        !name.starts_with(REFUSED) && !name.starts_with(GROWN)
    };
    corpus(target).into_iter().filter(|(path, _)| is_good(path)).chain(of_project).collect()
}

/// A good input with a few changes.
pub(crate) fn changed_seed(target: &Target, dice: &mut Dice) -> Vec<u8> {
    static SEEDS: OnceLock<BTreeMap<&'static str, Vec<Vec<u8>>>> = OnceLock::new();
    let all = SEEDS.get_or_init(|| {
        let bytes = |name: &str| seeds(name).into_iter().map(|(_, bytes)| bytes).collect();
        crate::TARGETS.iter().map(|target| (target.name, bytes(target.name))).collect()
    });
    let seeds = &all[target.name];
    assert!(!seeds.is_empty(), "{}: no file to begin with", target.name);
    let (good, other) = (dice.one_of(seeds), dice.one_of(seeds));
    mutated(good, other, dice)
}
