//! Orders that break ties, and `ideal`, written out from docs/spec.md.

use rockproof_model::{
    Contact, ContactKind, Criteria, Entrance, EntranceKind, Number, Sign, ToleranceSet, contact::ContactKey,
};

/// Section 4, "Result": contacts are sorted by kind (v-v, v-e, e-v, v-f, f-v, e-e), then A's feature, then B's.
const KINDS: [&str; 6] = ["v-v", "v-e", "e-v", "v-f", "f-v", "e-e"];
/// Section 4, "Choosing the entrance": ties by the order v-f, f-v, e-e, then A's feature, then B's.
const ENTRANCES: [&str; 3] = ["v-f", "f-v", "e-e"];

/// Three-digit numbers, of which the first two come first in the order that letters would have.
const FEATURES: [u32; 4] = [0, 2, 10, 100];

#[test]
fn contacts_are_sorted_by_kind_then_a_then_b() {
    let entrance = |kind: &str, a, b| Entrance::of_kind(EntranceKind::from_name(kind).expect(kind), [a, b]);
    let mut wanted = Vec::new();
    for kind in KINDS {
        for a in FEATURES {
            for b in FEATURES {
                // The features decide, not the entrance or the gap.
                let backwards = entrance(ENTRANCES[(b % 3) as usize], 1000 - a, 1000 - b);
                let gap = [Sign::Positive, Sign::Zero, Sign::Negative][(a % 3) as usize];
                let kind = ContactKind::from_name(kind).expect(kind);
                wanted.push(Contact { key: ContactKey::of_kind(kind, [a, b]), entrance: backwards, gap });
            }
        }
    }
    let mut found: Vec<Contact> = wanted.iter().rev().copied().collect();
    found.sort();
    assert_eq!(found, wanted);
    let mut keys: Vec<ContactKey> = wanted.iter().rev().map(|contact| contact.key).collect();
    keys.sort();
    assert_eq!(keys, wanted.iter().map(|contact| contact.key).collect::<Vec<_>>());
    assert_eq!(ContactKind::ALL.map(ContactKind::name), KINDS);
}

#[test]
fn entrances_are_sorted_by_kind_then_a_then_b() {
    let all = ENTRANCES.iter().flat_map(|kind| {
        let kind = EntranceKind::from_name(kind).expect("a kind");
        FEATURES.iter().flat_map(move |&a| FEATURES.iter().map(move |&b| Entrance::of_kind(kind, [a, b])))
    });
    let wanted: Vec<Entrance> = all.collect();
    let mut found: Vec<Entrance> = wanted.iter().rev().copied().collect();
    found.sort();
    assert_eq!(found, wanted);
}

/// Exchanging A and B, name by name.
#[test]
fn exchanged_blocks_exchange_the_names() {
    for (kind, swapped) in
        [("v-v", "v-v"), ("v-e", "e-v"), ("e-v", "v-e"), ("v-f", "f-v"), ("f-v", "v-f"), ("e-e", "e-e")]
    {
        let kind = ContactKind::from_name(kind).expect(kind);
        assert_eq!(kind.swapped().name(), swapped);
        let found = ContactKey::of_kind(kind, [3, 7]).swapped();
        assert_eq!((found.kind(), found.numbers()), (kind.swapped(), [7, 3]));
    }
    for (kind, swapped) in [("v-f", "f-v"), ("f-v", "v-f"), ("e-e", "e-e")] {
        let kind = EntranceKind::from_name(kind).expect(kind);
        let found = Entrance::of_kind(kind, [3, 7]).swapped();
        assert_eq!((found.kind().name(), found.numbers()), (swapped, [7, 3]));
    }
}

#[test]
fn ideal_is_the_set_with_four_zeros_and_the_revised_criteria() {
    let whole = Number::from_integer;
    let set = ToleranceSet {
        search: whole(1),
        territory: whole(2),
        penetration: whole(3),
        overlap_sine: Number::parse("1/4").expect("a number"),
        parallel_sine: Number::parse("1/5").expect("a number"),
        equal: whole(6),
        open: whole(7),
        close: whole(8),
        max_displacement: whole(9),
        max_rotation: whole(10),
        criteria: Criteria::Classic,
    };
    let found: Vec<(&str, String)> =
        set.ideal().numbers().into_iter().map(|(name, number)| (name, number.to_string())).collect();
    let wanted = [
        ("search", "1"),
        ("territory", "0"),
        ("penetration", "3"),
        ("overlap_sine", "0"),
        ("parallel_sine", "0"),
        ("equal", "0"),
        ("open", "7"),
        ("close", "8"),
        ("max_displacement", "9"),
        ("max_rotation", "10"),
    ];
    assert_eq!(found, wanted.map(|(name, number)| (name, number.to_owned())));
    assert_eq!(set.ideal().criteria, Criteria::Revised);
}
