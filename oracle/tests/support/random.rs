//! Random pairs near ties, random tolerances, and contacts to keep.

use super::shapes::{WEDGE, classic, cuboid, leaning_spike, number, revised, slab, spike, step, step_between};
use num_rational::BigRational;
use proptest::prelude::*;
use rockproof_model::{Block, ContactKey, ContactKind, Number, ToleranceSet, Vec3};
use rockproof_oracle::plain;

fn lower() -> impl Strategy<Value = Block> {
    (0..5).prop_map(|shape| match shape {
        0 => slab(),
        1 => WEDGE.upside_down_along_x(),
        2 => WEDGE.upside_down_along_y(),
        3 => step(),
        _ => step_between("0", "1/20"),
    })
}

/// A lower block, and an upper one near one of its vertices: along each axis either within 5/100, in steps of 1/100 so that
/// ties are common, or 1 away, so that edges and faces are met as well.
pub(crate) fn blocks() -> impl Strategy<Value = (Block, Block)> {
    let step_aside = || prop_oneof![3 => -5i32..=5, 1 => Just(100), 1 => Just(-100)];
    let offset = (step_aside(), step_aside(), step_aside());
    (0..5, lower(), any::<prop::sample::Index>(), offset).prop_map(|(shape, b, vertex, (x, y, z))| {
        let a = match shape {
            0 => spike(["0", "0", "0"]),
            1 => leaning_spike(["0", "0", "0"]),
            2 => WEDGE.turned(),
            3 => step(),
            _ => cuboid(["0", "0", "0"], ["2", "2", "1"]),
        };
        let near = vertex.get(b.vertices());
        let hundredths = |steps: i32| number(&format!("{steps}/100"));
        let place = Vec3::new(near.x.plus(&hundredths(x)), near.y.plus(&hundredths(y)), near.z.plus(&hundredths(z)));
        (a.translated(&place), b)
    })
}

/// Either criteria; sines and lengths with ties, g < s = 1/10 < g, and g so large that edges pass however they dip.
pub(crate) fn tolerances() -> impl Strategy<Value = ToleranceSet> {
    let sine = || prop::sample::select(vec!["0", "3/64", "3/5"]);
    let territory = prop::sample::select(vec!["0", "1/50", "1/25"]);
    let penetration = prop::sample::select(vec!["0", "1/20", "1/4", "4"]);
    (any::<bool>(), sine(), sine(), territory, penetration).prop_map(|(is_classic, overlap, parallel, r, g)| {
        let changes = [("overlap_sine", overlap), ("parallel_sine", parallel), ("territory", r), ("penetration", g)];
        if is_classic { classic(&changes) } else { revised(&changes) }
    })
}

/// Which contacts to keep: some of those the pair could have, and one at random.
#[derive(Clone, Debug)]
pub(crate) struct KeptChoice {
    keep: Vec<bool>,
    stray: ContactKey,
}

pub(crate) fn kept_choice() -> impl Strategy<Value = KeptChoice> {
    let stray = (prop::sample::select(ContactKind::ALL.to_vec()), 0..20u32, 0..20u32);
    (prop::collection::vec(any::<bool>(), 16), stray)
        .prop_map(|(keep, (kind, a, b))| KeptChoice { keep, stray: ContactKey::of_kind(kind, [a, b]) })
}

impl KeptChoice {
    /// The contacts kept of a pair: of those it would have at any depth, every one whose turn says so.
    pub(crate) fn of(&self, a: &Block, b: &Block, tolerances: &ToleranceSet) -> Vec<ContactKey> {
        let deep = ToleranceSet { penetration: Number::from_integer(100), ..tolerances.clone() };
        let possible = plain::classify::<BigRational>(a, b, &deep);
        let turns = self.keep.iter().cycle();
        let chosen = possible.iter().zip(turns).filter(|(_, keep)| **keep).map(|(found, _)| found.contact.key);
        std::iter::once(self.stray).chain(chosen).collect()
    }
}
