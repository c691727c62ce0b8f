//! The fast path against the golden pairs: contacts, entrances, and gaps as exact squares.

use rockproof_oracle::{Pair, PreparedBlock};

#[test]
fn reproduces_every_golden_pair() {
    let mut wrong = Vec::new();
    for golden in crate::support::golden::pairs() {
        let (a, b) = (PreparedBlock::new(&golden.a), PreparedBlock::new(&golden.b));
        let pair = Pair::new(&a, &b);
        let found: Vec<_> = pair
            .classify(&golden.tolerances)
            .contacts
            .into_iter()
            .map(|contact| {
                let gap = pair.gap(&contact.entrance);
                assert_eq!(gap.sign, contact.gap, "{}", golden.name);
                (contact, gap.squared)
            })
            .collect();
        if found != golden.expected {
            wrong.push(format!("{}\n  found    {found:?}\n  expected {:?}", golden.name, golden.expected));
        }
    }
    assert!(wrong.is_empty(), "{} pairs differ:\n{}", wrong.len(), wrong.join("\n"));
}
