//! What a step left of blocks between others: how deep they are pressed into them, and which way these push.

use crate::dynamics::state::State;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::{Block, Number};

/// The blocks of a state with their contacts.
pub struct PressedBlocks {
    contacts: Vec<PressingContact>,
    blocks: Vec<PressedBlock>,
}

/// A block, in f64.
struct PressedBlock {
    is_fixed: bool,
    vertices: Vec<[f64; 3]>,
    /// The numbers of its contacts.
    contacts: Vec<usize>,
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

impl PressingContact {
    /// The direction in which it pushes one of its blocks.
    fn push_on(&self, block: usize) -> [f64; 3] {
        if self.blocks[0] == block { self.normal } else { self.normal.map(|c| -c) }
    }
}

impl PressedBlocks {
    /// Those of a state; `is_fixed` says of each block whether it never moves.
    ///
    /// # Panics
    /// When there are fewer of `is_fixed` than blocks.
    pub fn of<R: Real>(state: &State<R>, is_fixed: &[bool]) -> PressedBlocks {
        let in_f64 = |v: &Vector<R>| v.components().map(R::to_f64);
        let contacts = state.contacts.iter().map(|contact| PressingContact {
            blocks: contact.blocks.map(|block| block as usize),
            normal: in_f64(&contact.normal),
            gap: contact.gap.to_f64(),
            is_closed: contact.mode.is_closed(),
        });
        let places = state.blocks.iter().map(|block| block.vertices.iter().map(in_f64).collect());
        let blocks = places.enumerate().map(|(block, vertices)| (is_fixed[block], vertices));
        PressedBlocks::among(blocks.collect(), contacts.collect())
    }

    fn among(blocks: Vec<(bool, Vec<[f64; 3]>)>, contacts: Vec<PressingContact>) -> PressedBlocks {
        let alone = |(is_fixed, vertices)| PressedBlock { is_fixed, vertices, contacts: Vec::new() };
        let mut blocks: Vec<PressedBlock> = blocks.into_iter().map(alone).collect();
        for (number, contact) in contacts.iter().enumerate() {
            contact.blocks.iter().for_each(|&block| blocks[block].contacts.push(number));
        }
        PressedBlocks { contacts, blocks }
    }

    /// Whether an overlap of a pair that no contact sees is the yielding of its neighbours' springs, given the way on which the first block gets free, of any
    /// length. It is less than a tenth of what closed contacts press each block that can move into others, and less than a thousandth of `size` (all m); and each
    /// of these blocks has a contact with another one that is no further open than that and pushes it out, by 60° at most from its way. Instead of that, a block that overlaps a fixed
    /// one may be no deeper in it, along the way on which another one pushes it, than that contact has yielded. `size` is that of [`yielding_size`].
    ///
    /// # Panics
    /// When there is no block of one of the numbers.
    pub fn explain(&self, [a, b]: [usize; 2], depth: f64, way_out: [f64; 3], size: f64) -> bool {
        // A fixed block goes nowhere, neither out of the other one nor on into it.
        let movable = || [(a, b, 1.0), (b, a, -1.0)].into_iter().filter(|&(block, ..)| !self.blocks[block].is_fixed);
        let pressed = |(block, partner, _)| {
            self.with_others(block, partner).filter(|c| c.is_closed).map(|c| -c.gap).fold(0.0, f64::max)
        };
        let limit = (movable().map(pressed).reduce(f64::min).unwrap_or(0.0) / 10.0).min(size / 1000.0);
        let largest = way_out.iter().fold(0.0f64, |largest, c| largest.max(c.abs()));
        let way_out = way_out.map(|c| c / largest);
        let length = dot(way_out, way_out).sqrt();
        let is_held = |block, partner, sign: f64| {
            self.with_others(block, partner)
                .any(|contact| contact.gap < limit && sign * dot(contact.push_on(block), way_out) >= length / 2.0)
        };
        depth < limit
            && movable().all(|(block, partner, sign)| {
                is_held(block, partner, sign)
                    || self.blocks[partner].is_fixed && self.is_no_deeper_than_in_others(block, partner, limit, size)
            })
    }

    /// Whether a block that another one pushes would be out of a partner if it moved on that way by no more than that contact has yielded and `limit`, and by less than `size` (m).
    fn is_no_deeper_than_in_others(&self, block: usize, partner: usize, limit: f64, size: f64) -> bool {
        self.with_others(block, partner).filter(|contact| contact.is_closed).any(|contact| {
            let push = contact.push_on(block);
            let along = |block: usize| self.blocks[block].vertices.iter().map(move |v| dot(push, *v));
            let front = along(partner).fold(f64::NEG_INFINITY, f64::max);
            let way = front - along(block).fold(f64::INFINITY, f64::min);
            way <= limit - contact.gap && way < size
        })
    }

    /// The contacts of a block with others than one.
    fn with_others(&self, block: usize, partner: usize) -> impl Iterator<Item = &PressingContact> {
        let all = self.blocks[block].contacts.iter().map(|&number| &self.contacts[number]);
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
            (0..5).map(|_| (false, Vec::new())).collect(),
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

    /// Block 0 pressed by 1 mm into the fixed block 1, off its edge by a little above or in the fixed block 2, whose top is higher than that of 1 by so much.
    struct AtSeam {
        higher: f64,
        is_fixed: bool,
        is_closed: bool,
    }

    const AT_SEAM: AtSeam = AtSeam { higher: 0.0, is_fixed: true, is_closed: true };

    impl AtSeam {
        /// Whether an overlap of 0 and 2, of which 0 gets free along −x, is explained: in both orders of the pair the same.
        fn explains(&self, depth: f64, size: f64) -> bool {
            self.explains_with([0.0, 0.0, -1.0], -1e-3, depth, size)
        }

        /// So, where the contact of 1 and 0 has another normal (1 is pushed along it) or gap.
        fn explains_with(&self, normal: [f64; 3], gap: f64, depth: f64, size: f64) -> bool {
            let plate = |x: [f64; 2], z: [f64; 2]| x.into_iter().flat_map(|x| z.map(|z| [x, 0.0, z])).collect();
            let blocks = vec![
                (false, plate([-1.0, 0.0], [-1e-3, 1.0])),
                (true, plate([-2.0, 0.0], [-1.0, 0.0])),
                (self.is_fixed, plate([0.0, 2.0], [-1.0, self.higher])),
            ];
            let mut contacts = vec![PressingContact { blocks: [1, 0], normal, gap, is_closed: self.is_closed }];
            if !self.is_fixed {
                // Pressed down, off block 0.
                let normal = [0.0, 0.0, 1.0];
                contacts.push(PressingContact { blocks: [1, 2], normal, gap: -1e-3, is_closed: true });
            }
            let pressed = PressedBlocks::among(blocks, contacts);
            let answers =
                [([0, 2], -5.0), ([2, 0], 5.0)].map(|(pair, x)| pressed.explain(pair, depth, [x, 0.0, 0.0], size));
            assert_eq!(answers[0], answers[1]);
            answers[0]
        }
    }

    #[test]
    fn in_a_fixed_block_springs_explain_what_is_no_deeper_than_they_yield() {
        // A tenth of what presses block 0 into the other one, a thousandth of the size, and along the push less than the size.
        assert!(AT_SEAM.explains(0.9e-4, 1.0) && !AT_SEAM.explains(1.1e-4, 1.0));
        assert!(AT_SEAM.explains(0.9e-4, 0.1) && !AT_SEAM.explains(0.9e-4, 0.08));
        assert!(AT_SEAM.explains(8e-7, 1.1e-3) && !AT_SEAM.explains(8e-7, 0.9e-3));
        // A step up by less than that tenth is as flush; a higher one, or a wall, is one that block 0 goes into.
        let higher = |higher| AtSeam { higher, ..AT_SEAM };
        assert!(higher(0.9e-4).explains(0.9e-4, 1.0) && higher(-0.1).explains(0.9e-4, 1.0));
        assert!(!higher(1.1e-4).explains(0.9e-4, 1.0) && !higher(0.5).explains(0.9e-4, 1.0));
        // Block 2 can move, and could come after block 0; nothing presses block 0.
        assert!(!AtSeam { is_fixed: false, ..AT_SEAM }.explains(0.9e-4, 1.0));
        assert!(!AtSeam { is_closed: false, ..AT_SEAM }.explains(0.9e-4, 1.0));
    }

    #[test]
    fn of_a_fixed_block_only_the_other_one_must_be_pushed_out() {
        // A wall that overlaps block 0, which something pushes away from the wall, by 60° off at most, or deeper into it, as in a gap too narrow for it.
        let wall = AtSeam { higher: 1.0, ..AT_SEAM };
        let (sine, cosine) = 59.0_f64.to_radians().sin_cos();
        assert!(wall.explains_with([cosine, 0.0, -sine], -1e-3, 0.9e-4, 1.0));
        assert!(!wall.explains_with([cosine, 0.0, -sine], -1e-3, 1.1e-4, 1.0));
        assert!(!wall.explains_with([-cosine, 0.0, -sine], -1e-3, 0.9e-4, 1.0));
        assert!(!wall.explains_with([-1.0, 0.0, 0.0], -1e-3, 0.9e-4, 1.0));
        let (sine, cosine) = 61.0_f64.to_radians().sin_cos();
        assert!(!wall.explains_with([cosine, 0.0, -sine], -1e-3, 0.9e-4, 1.0));
        // A block 2 that can move could go on into block 0.
        assert!(!AtSeam { is_fixed: false, ..wall }.explains_with([1.0, 0.0, 0.0], -1e-3, 0.9e-4, 1.0));
    }
}
