//! Damage to a directory of results: bytes of its files changed, cut off, put in or taken away, files exchanged or removed. Whatever is
//! done, a resumed run finds what was written, byte by byte, or an error that names a file; never a panic, and no file of somebody else
//! is touched.

use rockproof_results::{Claim, Directory, FileKind, MANIFEST, Owner, ResultsError, Seal, Start};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

const DAMAGES: u64 = if cfg!(debug_assertions) { 100 } else { 200 };
const HEADER: &[u8] = b"pair,found\n";
const ROWS: &[u8] = b"1,none\n2,v-f 0 3\n3,e-e 1 2\n";
const THEIRS: &[u8] = b"not ours";

/// What a run goes on from.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Checkpoint {
    next: u64,
    bytes: u64,
    sha256: String,
}

/// SplitMix64: the same damage everywhere.
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

fn claim(dir: &Path, start: Start) -> Result<Directory, ResultsError> {
    Directory::claim(Claim { dir, owner: Owner::Campaign, start, files: &["checkpoint.json", "rows.csv"] })
}

fn write(dir: &Path) {
    let mut directory = claim(dir, Start::Fresh).expect("an empty folder");
    let mut table = directory.begin_table("rows.csv", HEADER).expect("written");
    table.append(ROWS).expect("written");
    let Seal { bytes, sha256 } = table.seal().expect("written");
    directory.write_sealed("checkpoint.json", &Checkpoint { next: 4, bytes, sha256 }).expect("written");
    directory.write("cases/one.toml", FileKind::Case, b"a = 1\n").expect("written");
    // Rows after the seal: what a killed run leaves.
    table.append(b"4,no").expect("written");
    drop(directory);
    fs::write(dir.join("theirs.txt"), THEIRS).expect("written");
}

/// Goes on as a command does; what it goes on from.
fn resume(dir: &Path) -> Result<(Option<Checkpoint>, Vec<u8>), ResultsError> {
    let mut directory = claim(dir, Start::Resume)?;
    if !directory.is_resumable("checkpoint.json", "rows.csv")? {
        return Ok((None, Vec::new()));
    }
    let checkpoint: Checkpoint = directory.read_sealed("checkpoint.json")?;
    let seal = Seal { bytes: checkpoint.bytes, sha256: checkpoint.sha256.clone() };
    directory.resume_tables([("rows.csv", &seal)])?;
    let rows = fs::read(dir.join("rows.csv")).map_err(ResultsError::at(dir))?;
    Ok((Some(checkpoint), rows))
}

fn damage(dir: &Path, dice: &mut Dice) -> String {
    let names = [MANIFEST, "checkpoint.json", "rows.csv"];
    let name = names[dice.below(names.len())];
    let file = dir.join(name);
    let mut bytes = fs::read(&file).expect("a file");
    let at = dice.below(bytes.len());
    let what = match dice.below(8) {
        0 => {
            bytes.truncate(at);
            "cut off"
        }
        1 => {
            bytes[at] ^= 1 << dice.below(8);
            "a bit changed"
        }
        2 => {
            bytes.insert(at, dice.below(256) as u8);
            "a byte put in"
        }
        3 => {
            bytes.remove(at);
            "a byte taken away"
        }
        4 => {
            bytes.extend_from_slice(b"{}\n");
            "more at its end"
        }
        5 => {
            bytes = fs::read(dir.join(names[dice.below(names.len())])).expect("a file");
            "exchanged"
        }
        6 => {
            bytes = vec![0; at];
            "zeros"
        }
        _ => {
            fs::remove_file(&file).expect("removed");
            return format!("{name}: removed");
        }
    };
    fs::write(&file, bytes).expect("written");
    format!("{name}: {what} at {at}")
}

fn variant(error: &ResultsError) -> String {
    format!("{error:?}").chars().take_while(char::is_ascii_alphanumeric).collect()
}

#[test]
fn a_damaged_directory_is_whole_again_or_refused() {
    let mut dice = Dice(1);
    let mut reached: BTreeMap<String, u64> = BTreeMap::new();
    let whole = [HEADER, ROWS].concat();
    for _ in 0..DAMAGES {
        let dir = tempfile::tempdir().expect("a folder");
        write(dir.path());
        let about = damage(dir.path(), &mut dice);
        let outcome = match resume(dir.path()) {
            Ok((Some(checkpoint), rows)) => {
                assert_eq!((checkpoint.next, rows), (4, whole.clone()), "{about}");
                "whole".to_owned()
            }
            Ok((None, _)) => panic!("{about}: begun anew, and what was there is lost"),
            Err(error) => {
                assert!(error.to_string().contains(dir.path().to_str().expect("text")), "{about}: {error}");
                variant(&error)
            }
        };
        assert_eq!(fs::read(dir.path().join("theirs.txt")).expect("a file"), THEIRS, "{about}");
        *reached.entry(outcome).or_default() += 1;
    }
    println!("{reached:?}");
    for kind in ["whole", "Damaged", "Manifest"] {
        assert!(reached.contains_key(kind), "{kind} is not reached: {reached:?}");
    }
}
