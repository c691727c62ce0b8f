//! What a step left of blocks between others: how deep they are pressed into them, and which way these push.

use crate::dynamics::state::State;
use crate::real::Real;
use rockproof_model::{Block, Number};

/// The contacts of a state by blocks.
pub struct PressedBlocks {
    contacts: Vec<PressingContact>,
    /// The numbers of the contacts of each block.
    of_block: Vec<Vec<usize>>,
}

/// A contact, in f64.
struct PressingContact {
    blocks: [usize; 2],
    /// Of unit length; the first block is pushed along it, the second against it.
    normal: [f64; 3],
    /// In m, to first order.
    gap: f64,
    is_closed: bool,
}

impl PressedBlocks {
    /// Those of a state.
    pub fn of<R: Real>(state: &State<R>) -> PressedBlocks {
        let contacts = state.contacts.iter().map(|contact| PressingContact {
            blocks: contact.blocks.map(|block| block as usize),
            normal: contact.normal.components().map(R::to_f64),
            gap: contact.gap.to_f64(),
            is_closed: contact.mode.is_closed(),
        });
        PressedBlocks::among(state.blocks.len(), contacts.collect())
    }

    fn among(blocks: usize, contacts: Vec<PressingContact>) -> PressedBlocks {
        let mut of_block = vec![Vec::new(); blocks];
        for (number, contact) in contacts.iter().enumerate() {
            contact.blocks.iter().for_each(|&block| of_block[block].push(number));
        }
        PressedBlocks { contacts, of_block }
    }

    /// Whether an overlap of a pair that no contact sees is the yielding of its neighbours' springs, given the way on which the first block gets free, of any
    /// length. It is less than a tenth of what closed contacts press both blocks into others, and less than a thousandth of `size` (all m); and each
    /// block has a contact with another one that is no further open than that and pushes it out, by 60° at most from its way. `size` is that of [`yielding_size`].
    ///
    /// # Panics
    /// When there is no block of one of the numbers.
    pub fn explain(&self, [a, b]: [usize; 2], depth: f64, way_out: [f64; 3], size: f64) -> bool {
        let pressed = |block, partner| self.with_others(block, partner).filter(|c| c.is_closed).map(|c| -c.gap);
        let least = pressed(a, b).fold(0.0, f64::max).min(pressed(b, a).fold(0.0, f64::max));
        let limit = (least / 10.0).min(size / 1000.0);
        let largest = way_out.iter().fold(0.0f64, |largest, c| largest.max(c.abs()));
        let way_out = way_out.map(|c| c / largest);
        let length = dot(way_out, way_out).sqrt();
        let is_held = |block, partner, sign: f64| {
            self.with_others(block, partner).any(|contact| {
                let push = if contact.blocks[0] == block { sign } else { -sign };
                contact.gap < limit && push * dot(contact.normal, way_out) >= length / 2.0
            })
        };
        depth < limit && is_held(a, b, 1.0) && is_held(b, a, -1.0)
    }

    /// The contacts of a block with others than one.
    fn with_others(&self, block: usize, partner: usize) -> impl Iterator<Item = &PressingContact> {
        let all = self.of_block[block].iter().map(|&number| &self.contacts[number]);
        all.filter(move |contact| !contact.blocks.contains(&partner))
    }
}

/// What an overlap of two blocks that [`PressedBlocks::explain`] may explain is measured by: `penetration`, or half of a length that neither is thinner than (volume over
/// the square of the diagonal of its box) where that is less (all m). `None` where one is not convex: the depth of such a pair is no way out, however far the
/// blocks are in one another.
pub fn yielding_size(blocks: [&Block; 2], penetration: f64) -> Option<f64> {
    let thickness = |block: &Block| {
        let bounds = block.bounds();
        let side =
            |axis: usize| bounds.max.components()[axis].approximate() - bounds.min.components()[axis].approximate();
        let sides = [side(0), side(1), side(2)];
        block.is_convex().then(|| Number::from_rational(block.volume()).approximate() / dot(sides, sides))
    };
    let [one, two] = blocks.map(thickness);
    Some(penetration.min(one?.min(two?) / 2.0))
}

fn dot(one: [f64; 3], two: [f64; 3]) -> f64 {
    one[0] * two[0] + one[1] * two[1] + one[2] * two[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks 0 and 1 side by side along x on 2, each with one beyond it, 3 and 4, between which and the two there is a gap.
    fn between(gaps: [f64; 2], pressed: [f64; 2]) -> PressedBlocks {
        let contact = |blocks, normal, gap: f64| PressingContact { blocks, normal, gap, is_closed: gap < 0.0 };
        PressedBlocks::among(
            5,
            vec![
                contact([0, 1], [-1.0, 0.0, 0.0], -1.0),
                contact([0, 2], [0.0, 0.0, 1.0], -pressed[0]),
                contact([1, 2], [0.0, 0.0, 1.0], -pressed[1]),
                contact([0, 3], [-0.6, 0.8, 0.0], gaps[0]),
                contact([1, 4], [0.6, 0.8, 0.0], gaps[1]),
            ],
        )
    }

    #[test]
    fn both_blocks_must_be_pressed_into_others_and_pushed_out_by_others() {
        let out = [-7.0, 0.0, 0.0];
        let all = between([1e-5, -1e-6], [2e-3, 3e-3]);
        assert!(all.explain([0, 1], 1.9e-4, out, 1.0) && !all.explain([0, 1], 2.1e-4, out, 1.0));
        // However long the way; a thousandth of the size; the other way out; a way across, more than 60° off.
        assert!(all.explain([0, 1], 1.9e-4, out.map(|c| c * 1e300), 1.0));
        assert!(!all.explain([0, 1], 1.9e-4, [f64::NEG_INFINITY, 0.0, 0.0], 1.0));
        assert!(!all.explain([0, 1], 1.9e-4, out, 0.19));
        assert!(!all.explain([0, 1], 1.9e-4, [7.0, 0.0, 0.0], 1.0));
        assert!(!all.explain([0, 1], 1.9e-4, [-1.0, -0.2, 0.0], 1.0));
        // One is pressed too little; one has nothing near that pushes it out.
        assert!(!between([1e-5, -1e-6], [2e-3, 1e-3]).explain([0, 1], 1.9e-4, out, 1.0));
        assert!(!between([3e-4, -1e-6], [2e-3, 3e-3]).explain([0, 1], 1.9e-4, out, 1.0));
        assert!(!between([1e-5, 3e-4], [2e-3, 3e-3]).explain([0, 1], 1.9e-4, out, 1.0));
    }
}
