//! Classifications that depart from SPEC in one respect: nothing changes where the respect does not come up, and what changes is that.

use crate::support::hand_worked;
use crate::support::shapes::{classic, slab, spike};
use rockproof_model::decision::Predicate;
use rockproof_model::{Contact, ContactKind, Sign};
use rockproof_oracle::{Gap, Pair, PreparedBlock, RuleVariant};

/// How many answers change under a variant, and how many do where it does not come up.
struct Changed {
    expected: usize,
    unexpected: Vec<String>,
}

/// Compares the answers under variants with those of the hand-worked cases; `comes_up` says of a predicate in a pair whether one is about something.
fn compared(
    variants: impl Fn(Predicate) -> RuleVariant<'static>,
    comes_up: impl Fn(&[(Predicate, i8, bool)], Predicate) -> bool,
) -> Changed {
    let mut changed = Changed { expected: 0, unexpected: Vec::new() };
    for case in hand_worked::cases().iter().filter(|case| case.kept.is_empty()) {
        let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
        let pair = Pair::new(&a, &b);
        let exact = pair.classify(&case.tolerances).contacts;
        let trace = pair.trace(&case.tolerances);
        let trace: Vec<_> = trace.iter().map(|entry| (entry.decision.predicate, entry.outcome, entry.tie)).collect();
        for predicate in Predicate::ALL {
            let differs = pair.classify_with_variant(&case.tolerances, variants(predicate)) != exact;
            match (differs, comes_up(&trace, predicate)) {
                (true, false) => changed.unexpected.push(format!("{}: {predicate}", case.name)),
                (differs, _) => changed.expected += usize::from(differs),
            }
        }
    }
    changed
}

#[test]
fn ties_are_turned_where_there_are_ties_and_nowhere_else() {
    let is_tie = |trace: &[(Predicate, i8, bool)], wanted: Predicate| {
        trace.iter().any(|&(predicate, _, tie)| predicate == wanted && tie)
    };
    for taken in [Sign::Negative, Sign::Positive] {
        let changed = compared(|predicate| RuleVariant::Tie(predicate, taken), is_tie);
        assert!(changed.unexpected.is_empty(), "{:?}", changed.unexpected);
        assert!(changed.expected > 20, "{} answers change", changed.expected);
    }
    let changed = compared(|predicate| RuleVariant::Tie(predicate, Sign::Zero), |_, _| false);
    assert_eq!((changed.expected, changed.unexpected), (0, Vec::new()), "a tie taken for a tie");
}

#[test]
fn a_rule_is_left_out_where_it_said_otherwise_and_nowhere_else() {
    for yes in [true, false] {
        let otherwise = |trace: &[(Predicate, i8, bool)], wanted: Predicate| {
            wanted != Predicate::GapSign
                && trace.iter().any(|&(predicate, outcome, _)| predicate == wanted && (outcome == 1) != yes)
        };
        let changed = compared(|predicate| RuleVariant::Always(predicate, yes), otherwise);
        assert!(changed.unexpected.is_empty(), "{:?}", changed.unexpected);
        assert!(changed.expected > 20, "{} answers change", changed.expected);
    }
}

#[test]
fn what_is_left_out_is_gone_before_an_exit_is_chosen() {
    let mut others = 0;
    for case in hand_worked::cases().iter().filter(|case| case.kept.is_empty()) {
        let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
        let pair = Pair::new(&a, &b);
        let exact = pair.classify(&case.tolerances).contacts;
        let nothing = |_: &Contact| false;
        assert_eq!(
            pair.classify_with_variant(&case.tolerances, RuleVariant::LeftOut(&nothing)),
            exact,
            "{}",
            case.name
        );
        for contact in &exact {
            let is_it = |found: &Contact| found == contact;
            let left = pair.classify_with_variant(&case.tolerances, RuleVariant::LeftOut(&is_it));
            assert!(!left.contains(contact), "{}", case.name);
            // What touches or is apart stays whatever is left out; of overlapping contacts others may come in its place.
            let stays = |contacts: &[Contact]| contacts.iter().filter(|c| !c.gap.is_negative()).count();
            assert_eq!(stays(&left), stays(&exact) - usize::from(!contact.gap.is_negative()), "{}", case.name);
            others += usize::from(left.len() >= exact.len());
        }
    }
    assert!(others > 0, "in some pair another exit is chosen");
}

/// Without limit of the distance as well: what is out of reach is not looked at, so only the tip is, not the base 4 above it.
#[test]
fn what_is_always_near_must_be_within_reach() {
    let (a, b) = (PreparedBlock::new(&spike(["0", "0", "1/20"])), PreparedBlock::new(&slab()));
    let pair = Pair::new(&a, &b);
    let tolerances = classic(&[("overlap_sine", "1")]);
    let near = pair.classify_with_variant(&tolerances, RuleVariant::Always(Predicate::VertexFaceNear, true));
    assert_eq!(near, pair.classify(&tolerances).contacts);
    assert_eq!(near.len(), 1);
}

#[test]
fn the_smallest_gap_is_chosen_where_there_are_several_planes() {
    let height = |gap: Gap| if gap.sign.is_negative() { -gap.squared } else { gap.squared };
    let mut changed = 0;
    for case in hand_worked::cases().iter().filter(|case| case.kept.is_empty()) {
        let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
        let pair = Pair::new(&a, &b);
        let exact = pair.classify(&case.tolerances).contacts;
        for contact in pair.classify_with_variant(&case.tolerances, RuleVariant::SmallestGap) {
            let Some(known) = exact.iter().find(|known| known.key == contact.key) else { continue };
            let [least, largest] = [contact.entrance, known.entrance].map(|plane| height(pair.gap(&plane)));
            assert!(least <= largest, "{}: {contact:?}", case.name);
            changed += usize::from(least < largest);
            // Others have one plane alone.
            let has_several =
                matches!(contact.kind(), ContactKind::VertexVertex | ContactKind::VertexEdge | ContactKind::EdgeVertex);
            assert!(contact == *known || has_several, "{}: {contact:?}", case.name);
        }
    }
    assert!(changed > 3, "{changed}");
}
