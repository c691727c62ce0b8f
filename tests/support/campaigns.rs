//! Campaigns in a folder of their own, in one process, in parts and put together, and whether they wrote the same files.
#![allow(dead_code, reason = "each test uses its part")]

use crate::place::{Place, Ran};
pub(crate) use rockproof_fuzz::files;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Some steps can have no case; chunks and parts do not end together.
pub(crate) const SETTINGS: &str = "pairs = 250\nchunk = 48\nfamilies = [\"sliver\", \"edge_cross\", \"face_stack\"]\ntolerances = [\"auto\"]\n\
                        steps_every = 3\nsteps = 2\ncases_per_cause = 60\nshrink_evaluations = 3\n";

/// Settings of campaigns of whose cases a test needs no small ones: to make a case smaller examines its pair hundreds of times.
pub(crate) const CASES_AS_FOUND: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/cases_as_found.toml");

/// Settings of campaigns of which a test reads no case: to write them takes most of the time even as they were found.
pub(crate) const WITHOUT_CASES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/without_cases.toml");

/// A folder of its own, with settings.
pub(crate) struct Campaigns(Place);

impl Campaigns {
    pub(crate) fn new(settings: &str) -> Campaigns {
        let place = Place::new();
        place.file("campaign.toml", settings);
        Campaigns(place)
    }

    pub(crate) fn at(&self, name: &str) -> PathBuf {
        self.0.path(name)
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Ran {
        self.0.run(arguments)
    }

    pub(crate) fn works(&self, arguments: &[&str]) -> String {
        let (code, out, err) = self.run(arguments);
        assert_eq!(code, 0, "{arguments:?}: {err}");
        out
    }

    /// A command that is refused, says all of `wanted`, and makes no directory.
    pub(crate) fn refuses(&self, arguments: &[&str], wanted: &[&str]) {
        let (code, _, err) = self.run(arguments);
        assert!(code == 2 && wanted.iter().all(|part| err.contains(part)), "{arguments:?}: {code}: {err}");
        assert!(!self.at("out").exists(), "{arguments:?} wrote something");
    }

    pub(crate) fn campaign(&self, out: &str, more: &[&str]) {
        self.works(&[&["campaign", "campaign.toml", "--out", out], more].concat());
    }

    /// Makes all parts, threads by turns, and gives their directories.
    pub(crate) fn parts(&self, of: u64, more: &[&str]) -> Vec<String> {
        (1..=of)
            .map(|number| {
                let (part, threads) = (format!("{number}/{of}"), (number % 2 + 1).to_string());
                let out = format!("part{number}of{of}");
                self.campaign(&out, &[&["--part", &part, "--threads", &threads], more].concat());
                out
            })
            .collect()
    }

    pub(crate) fn merge(&self, parts: &[String], out: &str, more: &[&str]) {
        // In another order than theirs.
        let parts: Vec<&str> = parts.iter().rev().map(String::as_str).collect();
        self.works(&[&["merge", "--out", out], &parts[..], more].concat());
    }

    /// Every file of a directory, without what only times and machines make differ.
    pub(crate) fn files(&self, dir: &str) -> BTreeMap<String, Vec<u8>> {
        let mut found = files(&self.at(dir), "");
        assert!(found.remove("run.json").is_some());
        // It counts questions, and the merge asks again about some findings.
        found.remove("engines.csv");
        let progress = found.remove("progress.json").expect("progress");
        let mut progress: serde_json::Map<String, serde_json::Value> = serde_json::from_slice(&progress).expect("JSON");
        // The first signs of a process are decided before the filter's bounds are known, so levels differ a little.
        for key in ["seconds", "resumed", "levels", "engines", "sha256"] {
            assert!(progress.remove(key).is_some(), "{key}");
        }
        found.insert("progress.json".to_owned(), format!("{progress:?}").into_bytes());
        found
    }

    pub(crate) fn same(&self, one: &str, other: &str) {
        let (one, other) = (self.files(one), self.files(other));
        assert_eq!(one.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>());
        for (name, bytes) in &one {
            assert!(other[name] == *bytes, "{name} differs");
        }
    }
}
