//! Hypotheses that explain the same answers, told as ranges where nothing tells their numbers apart.

use super::hypothesis::{Hypothesis, HypothesisRange};
use super::tolerances::range_of_factors;

/// Hypotheses that explain the same, with those put together that are neighbours: factors of one tolerance, all above 1 or all below, and places of one
/// ladder, as angles and times of states are. No number is told that the answers do not tell.
pub(super) fn as_ranges(alike: &[usize], hypotheses: &[Box<dyn Hypothesis>]) -> Vec<(usize, Option<HypothesisRange>)> {
    let side = |number: &usize| hypotheses[*number].factor().map(|(name, factor)| (name, factor > 1000));
    let mut told: Vec<(usize, Option<HypothesisRange>)> = Vec::new();
    for number in alike {
        if let Some((name, _)) = hypotheses[*number].ladder() {
            let is_of_name = |other: &usize| hypotheses[*other].ladder().is_some_and(|(known, _)| known == name);
            if !told.iter().any(|(known, _)| is_of_name(known)) {
                told.extend(on_ladder(alike.iter().copied().filter(is_of_name).collect(), hypotheses));
            }
            continue;
        }
        let of = side(number);
        if of.is_some() && told.iter().any(|(known, _)| side(known) == of) {
            continue;
        }
        let same: Vec<usize> = match of {
            None => vec![*number],
            Some(_) => alike.iter().copied().filter(|other| side(other) == of).collect(),
        };
        let factors: Vec<i64> = same.iter().filter_map(|&other| Some(hypotheses[other].factor()?.1)).collect();
        match of.and_then(|(name, _)| range_of_factors(name, &factors)) {
            // Without a range each by itself.
            None => told.extend(same.into_iter().map(|number| (number, None))),
            range => told.push((*number, range)),
        }
    }
    told
}

/// Hypotheses of one ladder: as one where no place between them is missing, else each by itself.
fn on_ladder(same: Vec<usize>, hypotheses: &[Box<dyn Hypothesis>]) -> Vec<(usize, Option<HypothesisRange>)> {
    let mut places: Vec<(usize, usize)> =
        same.iter().filter_map(|&number| Some((hypotheses[number].ladder()?.1, number))).collect();
    places.sort_unstable();
    match (places.first(), places.last()) {
        (Some(&(first, number)), Some(&(last, _))) if last > first && last - first + 1 == places.len() => {
            vec![(number, hypotheses[number].range_to(last))]
        }
        _ => same.into_iter().map(|number| (number, None)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::hypothesis::all;

    /// What is told where factors of `search`, in thousandths, explain the same.
    fn told(factors: &[i64]) -> Vec<String> {
        let hypotheses = all();
        let number = |factor: &i64| {
            hypotheses.iter().position(|one| one.factor() == Some(("search", *factor))).expect("a factor that is tried")
        };
        let alike: Vec<usize> = factors.iter().map(number).collect();
        let sentence = |(number, range): (usize, Option<HypothesisRange>)| {
            range.map_or_else(|| hypotheses[number].sentence(), |range| range.sentence)
        };
        as_ranges(&alike, &hypotheses).into_iter().map(sentence).collect()
    }

    #[test]
    fn factors_that_explain_the_same_are_a_range_only_where_none_between_them_is_missing() {
        let one = |factor: &str| format!("with search times {factor}");
        assert_eq!(told(&[10_000]), [one("10")]);
        assert_eq!(told(&[2_000, 5_000, 10_000]), [one("2 to 10")]);
        assert_eq!(told(&[5_000, 10_000, 100_000, 1_000_000]), [one("5 or more")]);
        assert_eq!(told(&[0, 1, 10, 100]), [one("0.1 or less")]);
        // Five speaks against it: two numbers, each by itself.
        assert_eq!(told(&[2_000, 10_000]), [one("2"), one("10")]);
        // On either side of 1 they are no range.
        assert_eq!(told(&[500, 2_000]), [one("0.5"), one("2")]);
    }
}
