//! The 180 pairs of `tests/golden/golden_contacts.json` (the workspace's: its float engine is held against the same file),
//! whose contacts an independent implementation of SPEC section 4 worked out in exact rationals.

use num_rational::BigRational;
use rockproof_model::{
    Block, BlockOptions, Contact, ContactKey, ContactKind, Criteria, Entrance, EntranceKind, Number, Sign,
    ToleranceSet, Vec3,
};
use serde::Deserialize;

/// A pair of blocks, tolerances, and the contacts expected.
pub(crate) struct GoldenPair {
    pub(crate) name: String,
    pub(crate) a: Block,
    pub(crate) b: Block,
    pub(crate) tolerances: ToleranceSet,
    /// Each contact with the square of its gap.
    pub(crate) expected: Vec<(Contact, BigRational)>,
}

#[derive(Deserialize)]
struct RawPair {
    name: String,
    tolerances: RawTolerances,
    a: RawBlock,
    b: RawBlock,
    contacts: Vec<RawContact>,
}

#[derive(Deserialize)]
struct RawTolerances {
    search: String,
    territory: String,
    penetration: String,
    overlap_sine: String,
    parallel_sine: String,
    equal: String,
    criteria: String,
}

#[derive(Deserialize)]
struct RawBlock {
    vertices: Vec<[String; 3]>,
    faces: Vec<Vec<u32>>,
}

#[derive(Deserialize)]
struct RawContact {
    kind: String,
    feature_a: u32,
    feature_b: u32,
    entrance: String,
    entrance_a: u32,
    entrance_b: u32,
    gap_sign: i8,
    gap_squared: String,
}

/// All pairs of the file, in its order.
pub(crate) fn pairs() -> Vec<GoldenPair> {
    let raw: Vec<RawPair> = serde_json::from_str(include_str!("../../../tests/golden/golden_contacts.json")).unwrap();
    raw.into_iter().map(pair).collect()
}

fn pair(raw: RawPair) -> GoldenPair {
    let t = &raw.tolerances;
    let tolerances = ToleranceSet {
        search: number(&t.search),
        territory: number(&t.territory),
        penetration: number(&t.penetration),
        overlap_sine: number(&t.overlap_sine),
        parallel_sine: number(&t.parallel_sine),
        equal: number(&t.equal),
        open: Number::ZERO,
        close: Number::ZERO,
        max_displacement: Number::ZERO,
        max_rotation: Number::ZERO,
        criteria: [Criteria::Classic, Criteria::Revised].into_iter().find(|c| c.name() == t.criteria).unwrap(),
    };
    let expected = raw.contacts.iter().map(|c| (contact(c), c.gap_squared.parse().unwrap())).collect();
    GoldenPair { name: raw.name, a: block(raw.a), b: block(raw.b), tolerances, expected }
}

fn contact(raw: &RawContact) -> Contact {
    let kind = EntranceKind::from_name(&raw.entrance).unwrap();
    Contact {
        key: ContactKey::of_kind(ContactKind::from_name(&raw.kind).unwrap(), [raw.feature_a, raw.feature_b]),
        entrance: Entrance::of_kind(kind, [raw.entrance_a, raw.entrance_b]),
        gap: [Sign::Negative, Sign::Zero, Sign::Positive].into_iter().find(|s| s.as_i8() == raw.gap_sign).unwrap(),
    }
}

fn block(raw: RawBlock) -> Block {
    let vertices = raw.vertices.iter().map(|[x, y, z]| Vec3::new(number(x), number(y), number(z))).collect();
    // Two faces of each roof of the family `ridge` are bent, by up to 7/1000 of the block's size.
    Block::new(vertices, raw.faces, &BlockOptions { planarity: number("1/100") }).unwrap()
}

fn number(text: &str) -> Number {
    Number::from_rational(text.parse().unwrap())
}
