//! Blocks where a state has them, and what the oracle has worked out of each pair: exact steps ask it for contacts, and causes for decisions.

use crate::lockstep::scene::{BlockContacts, ExactScene};
use rockproof_model::Block;
use rockproof_oracle::step::{KnownNeighbours, State};
use rockproof_oracle::{Pair, PreparedBlock};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// So many pairs are remembered with their decisions, which take some 100 kB each.
const MOST_REMEMBERED: usize = 512;

/// The blocks of a state, prepared.
pub(super) struct ClassifiedBlocks<'b> {
    blocks: &'b [Block],
    prepared: &'b [PreparedBlock],
    /// Pairs of which decisions are remembered, or may come to be.
    pairs: RefCell<BTreeMap<[u32; 2], Rc<Pair<'b>>>>,
}

impl<'b> ClassifiedBlocks<'b> {
    /// Blocks and the same, prepared.
    pub(super) fn new(blocks: &'b [Block], prepared: &'b [PreparedBlock]) -> ClassifiedBlocks<'b> {
        ClassifiedBlocks { blocks, prepared, pairs: RefCell::default() }
    }

    /// A block.
    pub(super) fn block(&self, block: u32) -> &'b Block {
        &self.blocks[block as usize]
    }

    /// A pair of blocks, the same for all who ask: what it has worked out exactly serves all that is asked of it.
    pub(super) fn pair(&self, blocks: [u32; 2]) -> Rc<Pair<'b>> {
        let [a, b] = blocks.map(|block| &self.prepared[block as usize]);
        let mut pairs = self.pairs.borrow_mut();
        if let Some(known) = pairs.get(&blocks) {
            return Rc::clone(known);
        }
        let pair = Rc::new(Pair::new(a, b));
        if pairs.len() < MOST_REMEMBERED {
            pairs.insert(blocks, Rc::clone(&pair));
        }
        pair
    }

    /// The contacts that a step of a scene finds in a state in which the blocks are, with tolerances that may be others than the scene's. Of pairs
    /// whose decisions will be `traced`, in all likelihood, all decisions are remembered with them; of others they are found by what earlier steps of the same
    /// scene know.
    pub(super) fn contacts(
        &self,
        scene: &ExactScene,
        state: &State,
        traced: &BTreeSet<[u32; 2]>,
        known: &mut KnownNeighbours,
    ) -> BlockContacts {
        let tolerances = scene.tolerances();
        let mut found = Vec::new();
        known.begin_step();
        for pair in scene.neighbours(self.prepared) {
            let (kept, blocks) = (state.kept_contacts(pair), pair.map(|block| block as u32));
            let contacts = if traced.contains(&blocks) {
                self.pair(blocks).traced_contacts(tolerances, &kept)
            } else {
                let [a, b] = pair.map(|block| &self.prepared[block]);
                known.contacts(pair, &Pair::new(a, b), tolerances, &kept)
            };
            found.extend(contacts.into_iter().map(|contact| (pair, contact)));
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lockstep::answer::StepDecisions;
    use crate::lockstep::run::KEPT_PRECISION;
    use rockproof_model::{Motion, Number, Precision, Scene, SceneBlock, ToleranceSpec, Vec3};

    /// Three bricks in a row on a fixed one, the middle one a little aslant into it, and one far away.
    fn scene() -> ExactScene {
        let brick = |low: [&str; 3], high: [&str; 3]| {
            let at = |[x, y, z]: [&str; 3]| Vec3::new(x, y, z).map(|x| Number::parse(x).expect("a number"));
            SceneBlock::new("brick", Block::cuboid(&at(low), &at(high)).expect("a block"))
        };
        let blocks = vec![
            brick(["-1", "-1", "-1"], ["5", "2", "0"]),
            brick(["0", "0", "0"], ["1", "1", "1"]),
            brick(["1", "0", "-1/1000"], ["2", "1", "999/1000"]),
            brick(["2", "0", "1/100000"], ["3", "1", "1"]),
            brick(["100", "0", "0"], ["101", "1", "1"]),
        ];
        let mut scene = Scene { blocks, ..Scene::default() };
        scene.blocks[0].body.motion = Motion::Fixed;
        let set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F64).expect("tolerances");
        scene.derive_stiffness(&set);
        ExactScene::new(&scene, &set)
    }

    #[test]
    fn contacts_are_the_same_whatever_is_traced_and_those_that_the_step_finds() {
        let scene = scene();
        let (mut state, mut kept) = (scene.begin(), 0);
        for step in 0..3 {
            let found = scene.step(&state, KEPT_PRECISION).expect("a step");
            let blocks = scene.blocks_at(&state);
            let prepared: Vec<PreparedBlock> = blocks.iter().map(PreparedBlock::new).collect();
            let all: BTreeSet<[u32; 2]> = (0..5).flat_map(|i| (i + 1..5).map(move |j| [i, j])).collect();
            for traced in [BTreeSet::new(), BTreeSet::from([[0, 2]]), all] {
                let here = ClassifiedBlocks::new(&blocks, &prepared);
                let contacts = here.contacts(&scene, &state, &traced, &mut KnownNeighbours::default());
                assert_eq!(contacts, found.contacts, "step {step}");
                assert_eq!(here.pairs.borrow().len(), if traced.len() > 1 { 5 } else { traced.len() });
                let with = scene.step_with(&state, KEPT_PRECISION, contacts.clone()).expect("a step");
                assert_eq!(StepDecisions::of_oracle(&with), StepDecisions::of_oracle(&found));
                assert_eq!(with.state, found.state, "step {step}");
                let decided = scene.decide_with(&state, contacts).expect("a step");
                assert_eq!(StepDecisions::of_certified(&decided), StepDecisions::of_oracle(&found));
            }
            state = found.state;
            kept += state.kept_contacts([0, 2]).len();
        }
        assert!(kept > 0, "no step leaves a contact to the next");
    }

    /// The bricks come to rest, and what steps know of them is kept.
    #[test]
    fn contacts_are_the_same_by_what_earlier_steps_know() {
        let scene = scene();
        let (mut state, mut known) = (scene.begin(), KnownNeighbours::default());
        for step in 0..24 {
            let blocks = scene.blocks_at(&state);
            let prepared: Vec<PreparedBlock> = blocks.iter().map(PreparedBlock::new).collect();
            let here = ClassifiedBlocks::new(&blocks, &prepared);
            let found = scene.step(&state, KEPT_PRECISION).expect("a step");
            let contacts = here.contacts(&scene, &state, &BTreeSet::new(), &mut known);
            assert_eq!(contacts, found.contacts, "step {step}");
            state = found.state;
        }
        assert!(known.spared() > 20, "{} spared", known.spared());
    }

    #[test]
    fn a_pair_is_one_for_all_who_ask_until_there_are_many() {
        let blocks: Vec<Block> = scene().scene().blocks.iter().map(|block| block.block.clone()).collect();
        let blocks: Vec<Block> = std::iter::repeat_n(blocks, 8).flatten().collect();
        let prepared: Vec<PreparedBlock> = blocks.iter().map(PreparedBlock::new).collect();
        let here = ClassifiedBlocks::new(&blocks, &prepared);
        let pairs: Vec<[u32; 2]> = (0..40).flat_map(|i| (i + 1..40).map(move |j| [i, j])).collect();
        assert!(pairs.len() > MOST_REMEMBERED);
        let asked: Vec<_> = pairs.iter().map(|&pair| here.pair(pair)).collect();
        for (place, (&pair, one)) in pairs.iter().zip(&asked).enumerate() {
            assert_eq!(Rc::ptr_eq(one, &here.pair(pair)), place < MOST_REMEMBERED, "pair {place}");
        }
    }
}
