//! The 180 pairs of `golden_contacts.json`, whose contacts an independent implementation of SPEC section 4 worked out in exact rationals:
//! the tests of the oracle and of the stepper are held against the same file.

use num_rational::BigRational;
use rockproof_model::{
    Block, BlockOptions, Contact, ContactKey, ContactKind, Criteria, Entrance, EntranceKind, Number, Sign,
    ToleranceSet, Vec3,
};
use serde_json::Value;

/// A pair of blocks, tolerances, and the contacts expected.
pub(crate) struct GoldenPair {
    pub(crate) name: String,
    pub(crate) a: Block,
    pub(crate) b: Block,
    pub(crate) tolerances: ToleranceSet,
    /// Each contact with the square of its gap.
    pub(crate) expected: Vec<(Contact, BigRational)>,
}

/// All pairs of the file, in its order.
pub(crate) fn pairs() -> Vec<GoldenPair> {
    let pairs: Value = serde_json::from_str(include_str!("golden_contacts.json")).unwrap();
    pairs.as_array().unwrap().iter().map(pair).collect()
}

fn pair(pair: &Value) -> GoldenPair {
    let t = &pair["tolerances"];
    let criteria = [Criteria::Classic, Criteria::Revised].into_iter().find(|c| t["criteria"] == c.name()).unwrap();
    let mut tolerances = ToleranceSet { criteria, ..ToleranceSet::ZERO };
    let given = ["search", "territory", "penetration", "overlap_sine", "parallel_sine", "equal"];
    for (name, place) in tolerances.numbers_mut().into_iter().filter(|(name, _)| given.contains(name)) {
        *place = number(&t[name]);
    }
    GoldenPair {
        name: pair["name"].as_str().unwrap().to_owned(),
        a: block(&pair["a"]),
        b: block(&pair["b"]),
        tolerances,
        expected: pair["contacts"].as_array().unwrap().iter().map(|c| (contact(c), ratio(&c["gap_squared"]))).collect(),
    }
}

fn contact(c: &Value) -> Contact {
    let index = |name: &str| c[name].as_u64().unwrap() as u32;
    let kind = ContactKind::from_name(c["kind"].as_str().unwrap()).unwrap();
    let entrance = EntranceKind::from_name(c["entrance"].as_str().unwrap()).unwrap();
    Contact {
        key: ContactKey::of_kind(kind, [index("feature_a"), index("feature_b")]),
        entrance: Entrance::of_kind(entrance, [index("entrance_a"), index("entrance_b")]),
        gap: Sign::of_ordering(c["gap_sign"].as_i64().unwrap().cmp(&0)),
    }
}

fn block(block: &Value) -> Block {
    let vertices = block["vertices"].as_array().unwrap();
    let vertices = vertices.iter().map(|v| Vec3::new(number(&v[0]), number(&v[1]), number(&v[2]))).collect();
    let faces: Vec<Vec<u32>> = serde_json::from_value(block["faces"].clone()).unwrap();
    // Two faces of each roof of the family `ridge` are bent, by up to 8/1000 of the block's size.
    let planarity = Number::from_rational(BigRational::new(1.into(), 100.into()));
    Block::new(vertices, faces, &BlockOptions { planarity }).unwrap()
}

fn number(text: &Value) -> Number {
    Number::from_rational(ratio(text))
}

fn ratio(text: &Value) -> BigRational {
    text.as_str().unwrap().parse().unwrap()
}
