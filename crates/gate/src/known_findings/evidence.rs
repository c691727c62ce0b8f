//! Whether the counts in a baseline can be those of a campaign, and of this one: as where somebody changed the file, and a sort of finding may become
//! more frequent unseen.

use super::{ClassCount, KnownFindings, is_of_step};
use rockproof_differential::answer_detail::{AnswerDetail, StateDetail};
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use std::collections::{BTreeMap, BTreeSet};

impl KnownFindings {
    /// The first sort of finding whose counts no campaign can come to, and why.
    pub fn impossible(&self) -> Option<String> {
        let impossible = |(fingerprint, count): (&String, &ClassCount)| {
            let ClassCount { findings, pairs, squares } = *count;
            // Nothing in the file bounds those of steps: each engine may make steps of other pairs.
            let examined = if is_of_step(fingerprint) { 0 } else { self.examined_of(fingerprint) };
            let what = if examined > 0 && pairs > examined {
                format!("was in {pairs} of {examined} pairs examined")
            } else if pairs > findings {
                format!("was found {findings} times in {pairs} pairs")
            } else if squares < pairs || squares > pairs.saturating_mul(pairs) {
                format!("was in {pairs} pairs whose squares by batch add up to {squares}")
            } else {
                return None;
            };
            Some(format!("\"{}\" {what}, which cannot be", excerpt(fingerprint, EXCERPT_LENGTH)))
        };
        self.known.iter().find_map(impossible).or_else(|| self.impossibly_said())
    }

    /// An engine that gave something for more contacts or states than it named.
    fn impossibly_said(&self) -> Option<String> {
        let impossible = |detail: &AnswerDetail| {
            let of_contacts =
                [("entrances", detail.entrances), ("gap_m", detail.gap_m)].map(|of| (of, detail.contacts));
            let of_states = detail.by_state().map(|(_, StateDetail { answers, gaps, normals })| {
                [("gaps", gaps), ("normals", normals)].map(|of| (of, answers))
            });
            let mut all = of_contacts.into_iter().chain(of_states.into_iter().flatten());
            all.find(|((_, given), of)| given > of).map(|((what, given), of)| (what, given, of))
        };
        self.said.iter().find_map(|(engine, detail)| {
            let (what, given, of) = impossible(detail)?;
            Some(format!("{} gave {what} for {given} of {of}, which cannot be", excerpt(engine, EXCERPT_LENGTH)))
        })
    }

    /// That a campaign of the same settings examined other numbers of pairs than the file says, and of which families; nothing of what it does not count.
    pub(super) fn other_pairs(&self, now: &KnownFindings) -> Option<String> {
        let (families, [are, were]) = differing(&now.examined, &self.examined).or_else(|| {
            let [now, was] = [now, self].map(|of| of.moved.as_ref());
            differing(now?, was?)
        })?;
        Some(format!("pairs examined of {families} are {are}, in the baseline {were}"))
    }
}

/// The families of which there are other numbers of pairs than there were, and how many there are of all these, now and then.
fn differing(now: &BTreeMap<String, u64>, was: &BTreeMap<String, u64>) -> Option<(String, [u64; 2])> {
    let families: BTreeSet<&String> = now.keys().chain(was.keys()).collect();
    let differing: Vec<&str> =
        families.into_iter().filter(|name| now.get(*name) != was.get(*name)).map(String::as_str).collect();
    let sum = |of: &BTreeMap<String, u64>| differing.iter().filter_map(|name| of.get(*name)).sum();
    (!was.is_empty() && !differing.is_empty()).then(|| (differing.join(", "), [sum(now), sum(was)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(sort: &str, [findings, pairs, squares]: [u64; 3]) -> KnownFindings {
        KnownFindings {
            fields: vec!["cause".to_owned(), "family".to_owned()],
            examined: [("sliver".to_owned(), 18)].into(),
            known: [(sort.to_owned(), ClassCount { findings, pairs, squares })].into(),
            ..KnownFindings::default()
        }
    }

    #[test]
    fn counts_that_no_campaign_comes_to_are_told() {
        let why = |sort: &str, counts| known(sort, counts).impossible().unwrap_or_default();
        for [findings, pairs, squares] in [[0, 0, 0], [1, 1, 1], [40, 18, 18], [18, 18, 324], [20, 18, 260]] {
            assert_eq!(why("engine | sliver", [findings, pairs, squares]), "", "{findings} {pairs} {squares}");
        }
        let engine = "\"engine | sliver\"";
        let told = format!("{engine} was in 999999 of 18 pairs examined, which cannot be");
        assert_eq!(why("engine | sliver", [999_999, 999_999, 999_999]), told);
        assert_eq!(
            why("engine | sliver", [3, 4, 4]),
            format!("{engine} was found 3 times in 4 pairs, which cannot be")
        );
        for squares in [3, 17] {
            let told = format!("{engine} was in 4 pairs whose squares by batch add up to {squares}, which cannot be");
            assert_eq!(why("engine | sliver", [4, 4, squares]), told);
        }
        assert!(why("step | not-held | sliver", [1, 999_999, 999_999]).contains("found 1 times in 999999 pairs"));
        // Of families that the file does not count, as that of an early version, nothing is known.
        assert_eq!(why("engine | joint_cut", [99, 99, 99]), "");
    }

    #[test]
    fn engines_that_said_more_than_they_can_are_told() {
        let of = |entrances, gaps| {
            let apart = StateDetail { answers: 3, gaps, normals: 0 };
            let said = AnswerDetail { contacts: 5, entrances, apart, ..AnswerDetail::default() };
            KnownFindings { said: [("mine".to_owned(), said)].into(), ..KnownFindings::default() }.impossible()
        };
        assert_eq!(of(5, 3), None);
        assert_eq!(of(9, 3).as_deref(), Some("mine gave entrances for 9 of 5, which cannot be"));
        assert_eq!(of(5, 4).as_deref(), Some("mine gave gaps for 4 of 3, which cannot be"));
    }

    #[test]
    fn other_numbers_of_pairs_are_told() {
        let was = known("engine | sliver", [1, 1, 1]);
        let with = |family: &str, pairs| KnownFindings { examined: [(family.to_owned(), pairs)].into(), ..was.clone() };
        assert_eq!(was.other_pairs(&was), None);
        let told = |known: &KnownFindings, now: &KnownFindings| known.other_pairs(now).unwrap_or_default();
        assert_eq!(told(&with("sliver", 999), &was), "pairs examined of sliver are 18, in the baseline 999");
        assert_eq!(told(&with("real", 3), &was), "pairs examined of real, sliver are 18, in the baseline 3");
        let moved = KnownFindings { moved: Some([("sliver".to_owned(), 2)].into()), ..was.clone() };
        let fewer = KnownFindings { moved: Some([("sliver".to_owned(), 1)].into()), ..was.clone() };
        assert_eq!(told(&moved, &fewer), "pairs examined of sliver are 1, in the baseline 2");
        // A file of an early version, or of a gate without steps.
        assert_eq!(KnownFindings { examined: BTreeMap::new(), ..was.clone() }.other_pairs(&was), None);
        assert_eq!(was.other_pairs(&moved), None);
    }
}
