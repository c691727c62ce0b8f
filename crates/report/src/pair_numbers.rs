//! Which pairs of a campaign a run examined. A pair is a function of the settings and its number, so runs of the same settings that share numbers share pairs.

use super::load::RunFile;
use rockproof_campaign::merge::Parts;
use rockproof_campaign::part::Part;
use rockproof_pairs::batch::BATCH;
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::iter;
use std::ops::Range;

/// Settings that say nothing about which pairs there are, which steps they make and under which tolerances.
const NOT_ABOUT_PAIRS: [&str; 11] = [
    "pairs",
    Part::KEY,
    Parts::KEY,
    "chunk",
    "engines",
    "external",
    "ask_twice",
    "cases_per_cause",
    "cases_per_fingerprint",
    "shrink_evaluations",
    "metamorphic_every",
];

/// The numbers of a run's pairs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PairNumbers {
    /// In ascending order, none of them empty.
    ranges: Vec<Range<u64>>,
}

impl PairNumbers {
    /// Those of a run.
    pub(crate) fn of(run: &RunFile) -> PairNumbers {
        let text = |key: &str| run.configuration.get(key).and_then(Value::as_str);
        let planned = run.configuration.get("pairs").and_then(Value::as_u64).unwrap_or(run.pairs);
        if let Some(part) = text(Part::KEY).and_then(|part| part.parse::<Part>().ok()) {
            let start = part.pairs(planned, BATCH).start;
            return PairNumbers::new(iter::once(start..start + run.pairs));
        }
        let Some((numbers, of)) = text(Parts::KEY).and_then(|parts| parts.rsplit_once(" of ")) else {
            return PairNumbers::new(iter::once(0..run.pairs));
        };
        let range = |number: &str| {
            let number = number.trim_end_matches(" (unfinished)");
            Some(format!("{number}/{of}").parse::<Part>().ok()?.pairs(planned, BATCH))
        };
        PairNumbers::new(numbers.split(", ").filter_map(range))
    }

    fn new(ranges: impl IntoIterator<Item = Range<u64>>) -> PairNumbers {
        let mut ranges: Vec<Range<u64>> = ranges.into_iter().filter(|range| !range.is_empty()).collect();
        ranges.sort_by_key(|range| range.start);
        PairNumbers { ranges }
    }

    /// Those that another run has too.
    pub(crate) fn shared(&self, other: &PairNumbers) -> PairNumbers {
        let both = |one: &Range<u64>, two: &Range<u64>| one.start.max(two.start)..one.end.min(two.end);
        let ranges = self.ranges.iter().flat_map(|one| other.ranges.iter().map(move |two| both(one, two)));
        PairNumbers::new(ranges)
    }

    /// How many.
    pub(crate) fn count(&self) -> u64 {
        self.ranges.iter().map(|range| range.end - range.start).sum()
    }

    /// The first of them and the last.
    pub(crate) fn ends(&self) -> Option<[u64; 2]> {
        Some([self.ranges.first()?.start, self.ranges.last()?.end - 1])
    }

    /// As ranges, in ascending order.
    pub(crate) fn into_ranges(self) -> Vec<Range<u64>> {
        self.ranges
    }
}

/// Whether runs of these configurations have the same pair wherever they have the same number.
pub(crate) fn are_of_one_campaign(one: &Map<String, Value>, other: &Map<String, Value>) -> bool {
    let names: BTreeSet<&str> = one.keys().chain(other.keys()).map(String::as_str).collect();
    names.into_iter().all(|name| NOT_ABOUT_PAIRS.contains(&name) || one.get(name) == other.get(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(settings: Value, pairs: u64) -> PairNumbers {
        let run = serde_json::json!({
            "version": "0.1.0", "seed": 1, "configuration": settings, "finished": true, "pairs": pairs, "contacts": 0, "metamorphic_checks": 0,
            "machine": { "os": "", "architecture": "", "cores": 1 }, "findings": { "total": 0, "by_cause": {} }, "seconds": 0.0,
        });
        PairNumbers::of(&serde_json::from_value(run).expect("a run"))
    }

    #[test]
    fn runs_share_the_pairs_whose_numbers_both_have() {
        // Of 160 pairs, which are ten batches: parts of three, three and four.
        let part = |part: &str, pairs| numbers(serde_json::json!({ "pairs": 160, "part": part }), pairs);
        let whole = numbers(serde_json::json!({ "pairs": 160 }), 160);
        let [first, second, third] = [("1/3", 48), ("2/3", 48), ("3/3", 64)].map(|(of, pairs)| part(of, pairs));
        assert_eq!(first.ends(), Some([0, 47]));
        assert_eq!(second.ends(), Some([48, 95]));
        assert_eq!(third.ends(), Some([96, 159]));
        assert_eq!(first.shared(&second).count(), 0);
        assert_eq!(second.shared(&whole), second);
        assert_eq!(part("2/3", 16).shared(&second).ends(), Some([48, 63]));
        // Halves are of five batches, so the second third is partly in each.
        assert_eq!(part("1/2", 80).shared(&second).ends(), Some([48, 79]));
        let merged = |parts: &str| numbers(serde_json::json!({ "pairs": 160, "parts": parts }), 112);
        let ends = merged("1, 3 of 3");
        assert!(ends.shared(&second).count() == 0 && ends.shared(&whole).count() == 112);
        // How many an unfinished part has nobody knows, but where it begins.
        assert_eq!(merged("1, 3 (unfinished) of 3"), ends);
    }
}
