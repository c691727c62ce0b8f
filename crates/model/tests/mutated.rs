//! Readers on mutated files: a few hundred seeded mutations of good files in each format end in a scene or in an error that names
//! the file and says what is wrong, never in a panic. What they reach is counted, so that the mutations cannot quietly miss the readers.

use rockproof_model::Scene;
use rockproof_model::scene::{SceneFormat, SceneProblem};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const MUTANTS: u64 = if cfg!(debug_assertions) { 400 } else { 4_000 };

const OBJ: &str = "o box\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

const VTK: &str = "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n0 0 0 1 0 0 1 1 0 0 1 0\n0 0 1 1 0 1 1 1 1 0 1 1\nCELLS 1 32\n31 6 4 0 3 2 1 4 4 5 6 7 4 0 1 5 4 4 1 2 6 5 4 2 3 7 6 4 3 0 4 7\nCELL_TYPES 1\n42\n";

/// Faces run clockwise seen from outside.
const VORO: &str = "3 8 (0,0,0) (1,0,0) (1,1,0) (0,1,0) (0,0,1) (1,0,1) (1,1,1) (0,1,1) 6 (0,1,2,3) (4,7,6,5) (0,4,5,1) (1,5,6,2) (2,6,7,3) (3,7,4,0)\n";

const STL: &str = include_str!("../../../tests/fixtures/two_wedges.stl");
const VTU: &str = include_str!("../../../tests/fixtures/cells.vtu");
const PLY: &str = include_str!("../../../tests/fixtures/box.ply");
const MSH_2: &str = include_str!("../../../tests/fixtures/cells.msh");
const MSH_4: &str = include_str!("../../../tests/fixtures/surfaces.msh");

fn real(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Good files: format, name, text.
fn seeds() -> Vec<(SceneFormat, &'static str, String)> {
    vec![
        (SceneFormat::Toml, "handmade/wedge.toml", real("handmade/wedge.toml")),
        (SceneFormat::Toml, "handmade/spring.toml", real("handmade/spring.toml")),
        (SceneFormat::Toml, "handmade/ramp_load.toml", real("handmade/ramp_load.toml")),
        (SceneFormat::Dda, "real/smallAngle.dda", real("real/smallAngle.dda")),
        (SceneFormat::Dda, "real/smallEdge.dda", real("real/smallEdge.dda")),
        (SceneFormat::Obj, "box.obj", OBJ.to_owned()),
        (SceneFormat::Vtk, "box.vtk", VTK.to_owned()),
        (SceneFormat::Voro, "cell.voro", VORO.to_owned()),
        (SceneFormat::Stl, "wedges.stl", STL.to_owned()),
        (SceneFormat::Vtu, "cells.vtu", VTU.to_owned()),
        (SceneFormat::Ply, "box.ply", PLY.to_owned()),
        (SceneFormat::Msh, "cells.msh", MSH_2.to_owned()),
        (SceneFormat::Msh, "surfaces.msh", MSH_4.to_owned()),
    ]
}

/// SplitMix64: the same mutations everywhere.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }
}

/// What stands in the way of readers: numbers at the ends of types, signs, words, characters of more than one byte.
const WORDS: [&str; 30] = [
    "0",
    "-1",
    "1e308",
    "-1e309",
    "1e-400",
    "nan",
    "inf",
    "4294967296",
    "18446744073709551616",
    "-0",
    "1/0",
    "1/3",
    "0x10",
    "",
    " ",
    "\n",
    "\t",
    "é",
    "\u{0}",
    "\"",
    "[[",
    "]]",
    "=",
    "#",
    ",",
    "f",
    "v",
    "true",
    "[blocks]",
    "9999999999999999999999999",
];

fn mutated(text: &str, dice: &mut Dice) -> String {
    let mut chars: Vec<char> = text.chars().collect();
    for _ in 0..1 + dice.below(3) {
        let at = dice.below(chars.len());
        // A token from `at` on.
        let end = (at..chars.len()).find(|&k| chars[k].is_whitespace()).unwrap_or(chars.len());
        match dice.below(8) {
            0 => chars.truncate(at),
            1 => drop(chars.drain(at..end)),
            2 => {
                let word: Vec<char> = WORDS[dice.below(WORDS.len())].chars().collect();
                drop(chars.splice(at..end, word));
            }
            3 => {
                let word: Vec<char> = WORDS[dice.below(WORDS.len())].chars().collect();
                drop(chars.splice(at..at, word));
            }
            4 => {
                let copy: Vec<char> = chars[at..end].to_vec();
                let to = dice.below(chars.len());
                drop(chars.splice(to..to, copy));
            }
            5 if !chars.is_empty() => chars[at] = char::from(32 + dice.below(95) as u8),
            6 if !chars.is_empty() => drop(chars.remove(at)),
            _ => {
                // A line taken away or twice there.
                let lines: Vec<String> = chars.iter().collect::<String>().lines().map(str::to_owned).collect();
                let line = dice.below(lines.len());
                let twice = dice.below(2) == 0;
                let kept = lines.iter().enumerate().flat_map(|(k, text)| {
                    let times = if k != line { 1 } else { 2 * usize::from(twice) };
                    std::iter::repeat_n(format!("{text}\n"), times)
                });
                chars = kept.collect::<String>().chars().collect();
            }
        }
    }
    chars.into_iter().collect()
}

fn name_of(problem: &SceneProblem) -> String {
    let text = format!("{problem:?}");
    text.chars().take_while(char::is_ascii_alphanumeric).collect()
}

#[test]
fn mutated_files_are_read_or_refused_with_a_reason() {
    let mut reached: BTreeMap<&str, BTreeMap<String, u64>> = BTreeMap::new();
    for (seed, (format, name, text)) in seeds().into_iter().enumerate() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name);
        Scene::parse(&text, format, &path).unwrap_or_else(|error| panic!("{name} as it is: {error}"));
        let mut dice = Dice(seed as u64);
        for mutant in 0..MUTANTS {
            let text = mutated(&text, &mut dice);
            let outcome = match Scene::parse(&text, format, &path) {
                Ok(scene) => {
                    assert!(!scene.blocks.is_empty(), "{name}, mutant {mutant}: a scene without a block");
                    "read".to_owned()
                }
                Err(error) => {
                    let lines = text.lines().count().max(1);
                    assert!(error.file.ends_with(path.file_name().unwrap()), "{name}, mutant {mutant}: {error}");
                    assert!(
                        error.line.is_none_or(|line| line >= 1 && line <= lines + 1),
                        "{name}, mutant {mutant}: {error}"
                    );
                    assert!(
                        error.to_string().len() < 4_000,
                        "{name}, mutant {mutant}: a message of {}",
                        error.to_string().len()
                    );
                    name_of(&error.problem)
                }
            };
            *reached.entry(name).or_default().entry(outcome).or_default() += 1;
        }
    }
    println!("{reached:#?}");
    let all: BTreeSet<&str> = reached.values().flat_map(|of| of.keys().map(String::as_str)).collect();
    let wanted = ["read", "Unexpected", "Truncated", "Number", "NotAllowed", "Toml", "UnknownKey", "Block"];
    let missing: Vec<_> = wanted.iter().filter(|kind| !all.contains(*kind)).collect();
    assert!(missing.is_empty(), "not reached: {missing:?} of {all:?}");
    for (name, outcomes) in &reached {
        assert!(outcomes.contains_key("read") && outcomes.len() > 2, "{name}: {outcomes:?}");
    }
}
