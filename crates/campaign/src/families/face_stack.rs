//! A block on the top face of another.

use super::{Family, Kit};
use crate::shapes::Solid;
use crate::steps::Manner;
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind};

#[derive(Debug)]
pub(super) struct FaceStack;

impl Family for FaceStack {
    fn name(&self) -> &'static str {
        "face_stack"
    }

    fn describe(&self) -> &'static str {
        "a block on the flat top of another: flush, shifted or turned, with a gap around zero"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &ContactKind::ALL
    }

    fn manner(&self) -> Manner {
        Manner::Pressing
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut kit = Kit::new(rng);
        let below = flat_topped(&mut kit);
        let above = match kit.below(5) {
            4 => {
                let upright = if kit.chance(50) { kit.cuboid(8, 48) } else { kit.convex(8, 48) };
                kit.tipped(&upright)
            }
            0 => {
                // A block standing on a tip or an edge instead of a face.
                let tilted = kit.convex(8, 48);
                kit.turned(&tilted)
            }
            1 => {
                let upright = kit.convex(8, 48);
                kit.turned_flat(&upright)
            }
            _ => kit.convex(8, 48),
        };
        let (below, above) = Solid::on_one_lattice(&below, &above);
        let unit = below.denominator() / kit.denominator();
        let top = below.extent(2).1;
        let mut shift = [0, 0, top - above.extent(2).0];
        for (axis, shift) in shift.iter_mut().enumerate().take(2) {
            let (low, high) = below.extent(axis);
            let (near, far) = above.extent(axis);
            *shift = match kit.below(5) {
                0 => low - near,
                1 => high - far,
                2 => (low + high) / 2 - (near + far) / 2,
                3 => low - near + kit.gap(2 * kit.denominator()) * unit,
                _ => low - near + kit.between(0, ((high - low) / unit).max(1)) * unit,
            };
        }
        shift[2] += kit.gap(2 * kit.denominator()) * unit;
        kit.finish(below, above.moved(shift))
    }
}

/// A block with a flat top, at z = its height.
fn flat_topped(kit: &mut Kit<'_>) -> Solid {
    let sides = kit.lengths(8, 48);
    match kit.below(6) {
        0 => kit.shape("hexagon", sides),
        1 => kit.shape("frustum", sides),
        2 => kit.shape("pentagon", sides),
        3 => kit.shape("trapezoid", sides),
        _ => kit.shape("cuboid", sides),
    }
}
