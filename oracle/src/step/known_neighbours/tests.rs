//! What is known of neighbours changes no contact, however they move, and is given up with them.

use super::*;
use crate::soundness::{Dice, without_tolerances};
use rockproof_model::{Block, Number, Vec3};

fn number(value: f64) -> Number {
    Number::from_f64(value).expect("finite")
}

fn tolerances() -> ToleranceSet {
    let (search, territory, penetration, sine) = (number(0.5), number(0.01), number(0.25), number(0.01));
    let parallel_sine = sine.clone();
    ToleranceSet { search, territory, penetration, overlap_sine: sine, parallel_sine, ..without_tolerances() }
}

/// A brick of 4 × 4 × 1 with its lowest corner here, each coordinate off by up to `noise`.
fn brick(dice: &mut Dice, at: [f64; 3], noise: f64) -> PreparedBlock {
    let corner = |at: [f64; 3]| Vec3::new(number(at[0]), number(at[1]), number(at[2]));
    let block = Block::cuboid(&corner(at), &corner([at[0] + 4.0, at[1] + 4.0, at[2] + 1.0])).expect("a brick");
    let mut near = |c: &Number| c.plus(&number((dice.below(2001) as f64 - 1000.0) / 1000.0 * noise));
    let vertices = block.vertices().iter().map(|v| Vec3::new(near(&v.x), near(&v.y), near(&v.z))).collect();
    PreparedBlock::new(&block.with_vertices(vertices))
}

/// Two bricks, the second on the first, looked at again and again.
struct Run {
    known: KnownNeighbours,
    dice: Dice,
    kept: Vec<ContactKey>,
}

impl Run {
    fn new() -> Run {
        Run { known: KnownNeighbours::default(), dice: Dice(5), kept: Vec::new() }
    }

    /// Looks at the bricks where both are moved by `common` and the second by `at` as well; says whether only nearby pairs of features were looked at, and how
    /// many contacts there are.
    fn look(&mut self, common: [f64; 3], at: [f64; 3]) -> (bool, usize) {
        let second = [0, 1, 2].map(|k| common[k] + at[k]);
        let (a, b) = (brick(&mut self.dice, common, 1e-7), brick(&mut self.dice, second, 1e-7));
        let (pair, set) = (Pair::new(&a, &b), tolerances());
        let before = self.known.spared();
        self.known.begin_step();
        let found = self.known.contacts([0, 1], &pair, &set, &self.kept);
        assert_eq!(found, pair.classify_with_kept(&set, &self.kept).contacts, "second brick at {at:?}");
        self.kept = found.iter().map(|contact| contact.key).collect();
        (self.known.spared() > before, found.len())
    }

    /// How many of so many looks at the second brick here were at nearby pairs of features.
    fn looks(&mut self, looks: u16, at: [f64; 3]) -> u16 {
        (0..looks).map(|_| u16::from(self.look([0.0; 3], at).0)).sum()
    }
}

const ON_TOP: [f64; 3] = [1.0, 2.0, 1.0];

/// At rest, falling together, creeping, then moved: onto an edge, into the brick, away, and back.
#[test]
fn contacts_are_those_of_all_features_wherever_the_blocks_go() {
    let mut run = Run::new();
    assert_eq!(run.looks(LOOKS_BEFORE_LISTING, ON_TOP), 0);
    assert_eq!(run.looks(20, ON_TOP), 20);
    let (spared, count) = run.look([1e3, -2.0, 0.5], ON_TOP);
    assert!(spared && count >= 4, "falling together is no motion: {count}");
    // 0.5 / 32 is the margin.
    let mut left = None;
    for step in 1..100 {
        let (spared, _) = run.look([0.0; 3], [1.0 + 0.001 * f64::from(step), 2.0, 1.0]);
        assert_eq!(spared, step <= 15, "step {step} of 0.001");
        if !spared {
            left = Some(step);
            break;
        }
    }
    assert_eq!(left, Some(16));
    let mut counts = vec![count];
    for at in [[3.99, 2.0, 1.0], [1.0, 2.0, 0.9], [1.0, 2.0, 1.2], [0.0, 0.0, 1.0], [4.0, 4.0, 1.0], [1.0, 2.0, 2.0]] {
        let (spared, count) = run.look([0.0; 3], at);
        assert!(!spared);
        counts.push(count);
        assert!(run.looks(60, at) > 10, "at rest at {at:?}");
    }
    counts.sort_unstable();
    counts.dedup();
    assert!(counts[0] == 0 && counts.len() >= 4, "contacts of many kinds: {counts:?}");
}

#[test]
fn what_moves_too_fast_to_be_worth_it_is_looked_at_whole() {
    let mut run = Run::new();
    // Over a quarter of the margin in eight looks.
    for step in 0..200 {
        let (spared, _) = run.look([0.0; 3], [1.0 + 0.0006 * f64::from(step), 2.0, 1.0]);
        assert!(!spared, "step {step}");
    }
}

/// Pairs of features that held for a few looks alone are waited for twice as long; those that held for many, as at first.
#[test]
fn what_did_not_pay_is_found_again_later() {
    let mut run = Run::new();
    let mut at = ON_TOP;
    let mut patience = |looks: u16| {
        // Until the second of them is only nearby, then on for so many looks, and away.
        let mut waited = 0;
        while !run.look([0.0; 3], at).0 {
            waited += 1;
            assert!(waited < 200);
        }
        run.looks(looks - 1, at);
        at[0] = if at[0] == 1.0 { 2.0 } else { 1.0 };
        waited
    };
    let waits = [5, 5, 5, WORTH, 5, 5].map(&mut patience);
    // The look that finds the blocks gone counts for nothing but that.
    let of = |looks: u16| i32::from(looks);
    let first = of(LOOKS_BEFORE_LISTING);
    assert_eq!(waits, [first, 2 * first + 1, 4 * first + 1, 8 * first + 1, first + 1, 2 * first + 1]);
}

#[test]
fn pairs_that_were_not_asked_for_are_forgotten() {
    let mut run = Run::new();
    run.looks(LOOKS_BEFORE_LISTING + 1, ON_TOP);
    assert_eq!((run.known.pairs.len(), run.known.listed), (1, 1));
    run.known.begin_step();
    assert_eq!((run.known.pairs.len(), run.known.listed), (1, 1), "it was asked for");
    run.known.begin_step();
    assert_eq!((run.known.pairs.len(), run.known.listed), (0, 0));
    assert_eq!(run.looks(LOOKS_BEFORE_LISTING, ON_TOP), 0, "as at first");
}

#[test]
fn no_more_is_kept_than_is_allowed() {
    let mut run = Run::new();
    run.known.listed = MOST_LISTED;
    assert_eq!(run.looks(3 * LOOKS_BEFORE_LISTING, ON_TOP), 0);
    run.known.listed -= 1;
    assert!(run.looks(3 * LOOKS_BEFORE_LISTING, ON_TOP) > LOOKS_BEFORE_LISTING);
    assert_eq!(run.known.listed, MOST_LISTED);
    // A prism of 40 sides has 242 features: 26 of a brick beside it, or so many again.
    let sides = 40u32;
    let corner = |k: u32, z: i32| Vec3::new(number(f64::from(k)), number(f64::from(k * k)), Number::from_integer(z));
    let vertices = (0..sides).map(|k| corner(k, 0)).chain((0..sides).map(|k| corner(k, 1))).collect();
    let around = (0..sides).map(|k| vec![k, (k + 1) % sides, sides + (k + 1) % sides, sides + k]);
    let faces = [(0..sides).rev().collect(), (sides..2 * sides).collect()].into_iter().chain(around).collect();
    let prism =
        Block::new(vertices, faces, &rockproof_model::BlockOptions { planarity: Number::ZERO }).expect("a prism");
    let (prism, brick) = (PreparedBlock::new(&prism), brick(&mut Dice(1), [0.0; 3], 0.0));
    assert!(are_small([&prism, &brick]) && are_small([&brick, &prism]) && !are_small([&prism, &prism]));
}
