use super::*;
use crate::contact::contact_rules::SpecRules;
use crate::double::Double;
use crate::wide::{Wide, count_unsettled};
use proptest::prelude::*;

/// Gaps of so many thirds of 2^-20, each with so many thirds of a power of two added, and their keys.
type Gaps = [(i32, i32, i32, u32)];

/// The place of the chosen gap, and what is left unsettled. Gaps count as equal from 3 of 4 of the largest.
fn chosen<R: Real>(gaps: &Gaps) -> (Option<usize>, u64) {
    let third = R::from_f64(1.0) / R::from_f64(3.0);
    let gap = |many: i32, more: i32, exponent: i32| {
        let size = R::from_f64(f64::from(many)) * R::from_f64(2f64.powi(-20));
        third * size + third * R::from_f64(f64::from(more)) * R::from_f64(2f64.powi(exponent))
    };
    let made = gaps.iter().enumerate();
    let gaps: Vec<(usize, R, u32)> = made.map(|(k, &(many, more, at, key))| (k, gap(many, more, at), key)).collect();
    count_unsettled(|| first_of_the_best::<R, SpecRules, u32>(gaps.iter().copied(), R::from_f64(0.25)))
}

#[test]
fn two_f64_choose_where_it_does_not_matter_which_gap_is_the_largest() {
    // The largest; one of two that may be; one that is equal to either; one that is not.
    assert_eq!(chosen::<Double>(&[(4, 0, 0, 0), (9, 0, 0, 1), (6, 0, 0, 2)]), (Some(1), 0));
    assert_eq!(chosen::<Double>(&[(9, 0, 0, 2), (9, 1, -200, 1)]), (Some(1), 0));
    assert_eq!(chosen::<Double>(&[(9, 1, -200, 2), (9, 0, 0, 3), (7, 0, 0, 1)]), (Some(2), 0));
    assert_eq!(chosen::<Double>(&[(9, 1, -200, 2), (9, 0, 0, 3), (6, 0, 0, 1)]), (Some(0), 0));
    assert_eq!(chosen::<Double>(&[]), (None, 0));
    // Three of four is a tie, which is asked of each that may be the largest; 512 bits tell how 2^-200 makes it come out.
    let tie = [(8, 1, -200, 2), (8, 0, 0, 3), (6, 0, 0, 1)];
    assert_eq!(chosen::<Double>(&tie).1, 2);
    assert_eq!(chosen::<Wide>(&tie), (Some(0), 0));
}

proptest! {
    #[test]
    fn what_two_f64_choose_without_doubt_is_what_512_bits_choose(
        gaps in proptest::collection::vec((-9..9, -1..2, prop_oneof![Just(-40), Just(-110), Just(-200)], any::<u32>()), 1..6),
    ) {
        let found = chosen::<Double>(&gaps);
        prop_assert!(found.1 > 0 || found == chosen::<Wide>(&gaps), "{found:?}");
    }
}
