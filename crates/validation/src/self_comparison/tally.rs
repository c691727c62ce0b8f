//! What was compared, in counts that add up in any order.

use rockproof_differential::engine::Levels;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::AddAssign;

/// Counts of one family of pairs, or of all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tally {
    /// Pairs compared as they were made.
    pub exact: u64,
    /// Pairs compared as an engine in f32 sees them.
    pub in_f32: u64,
    /// Of both, those with contacts.
    pub with_contacts: u64,
    /// Of both, those with a comparison of the stepper at a tie of square roots, which no number of bits settles.
    pub at_ties: u64,
    /// Of both, those that the plain path in pure Rust rationals was asked about.
    pub plain: u64,
    /// Of both, those that the plain path in GMP's rationals was asked about.
    pub gmp: u64,
    /// Not compared: rounding left no block.
    pub collapsed: u64,
    /// Answers that differ from that of the fast path, or were not given: at most one of each path a pair.
    pub disagreements: u64,
}

impl Tally {
    /// The counts by the names of the tables' columns.
    pub fn by_name(&self) -> [(&'static str, u64); 8] {
        [
            ("exact", self.exact),
            ("in_f32", self.in_f32),
            ("with_contacts", self.with_contacts),
            ("at_ties", self.at_ties),
            ("plain", self.plain),
            ("gmp", self.gmp),
            ("collapsed", self.collapsed),
            ("disagreements", self.disagreements),
        ]
    }

    /// Pairs compared, those as an engine in f32 sees them among them.
    pub fn compared(&self) -> u64 {
        self.exact + self.in_f32
    }
}

impl AddAssign for Tally {
    fn add_assign(&mut self, other: Tally) {
        self.exact += other.exact;
        self.in_f32 += other.in_f32;
        self.with_contacts += other.with_contacts;
        self.at_ties += other.at_ties;
        self.plain += other.plain;
        self.gmp += other.gmp;
        self.collapsed += other.collapsed;
        self.disagreements += other.disagreements;
    }
}

/// The counts of a comparison.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Totals {
    /// By family of pairs.
    pub families: BTreeMap<String, Tally>,
    /// Signs decided by each level of the oracle's fast path, in the order of [`Levels::NAMES`]. The first signs of a process are decided before the bounds of
    /// its filter are known, some of them by more signs, so these counts differ a little from one way of sharing out the pairs to another.
    pub levels: [u64; Levels::NAMES.len()],
}

impl Totals {
    /// The counts of all families.
    pub fn all(&self) -> Tally {
        let mut sum = Tally::default();
        self.families.values().for_each(|tally| sum += *tally);
        sum
    }

    /// Adds the counts of one family.
    pub fn add(&mut self, family: &str, tally: Tally) {
        *self.families.entry(family.to_owned()).or_default() += tally;
    }

    /// Adds signs by level.
    pub fn add_levels(&mut self, levels: [u64; Levels::NAMES.len()]) {
        for (sum, count) in self.levels.iter_mut().zip(levels) {
            *sum += count;
        }
    }

    /// The rows of `totals.csv`.
    ///
    /// # Errors
    /// Those of the CSV writer.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let names = Tally::default().by_name().map(|(name, _)| name);
        writer.write_record(std::iter::once("family").chain(names))?;
        for (family, tally) in &self.families {
            let counts = tally.by_name().map(|(_, count)| count.to_string());
            writer.write_record(std::iter::once(family.clone()).chain(counts))?;
        }
        writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
    }

    /// The rows of `levels.csv`.
    ///
    /// # Errors
    /// Those of the CSV writer.
    pub fn levels_to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(["level", "signs"])?;
        for (name, count) in Levels::NAMES.into_iter().zip(self.levels) {
            writer.write_record([name.to_owned(), count.to_string()])?;
        }
        writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
    }
}

impl AddAssign<&Totals> for Totals {
    fn add_assign(&mut self, other: &Totals) {
        for (family, tally) in &other.families {
            self.add(family, *tally);
        }
        self.add_levels(other.levels);
    }
}
