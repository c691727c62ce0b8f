//! Pairs of blocks that are past the middle of one another: a contact that was closed before still pushes them back the way they came, though the other way out
//! has become shorter. It says nothing of an overlap that it cannot undo, and it lets the blocks go once they are through.

use num_rational::BigRational;
use rockproof_model::block::face_normal;
use rockproof_model::ring::Ring;
use rockproof_model::{Block, Contact, ContactKey, Entrance, Number, ToleranceSet, Vec3, VertexId};
use rockproof_oracle::audit::Screen;
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_simulate::PairDepth;
use rockproof_stepper::dynamics::State;
use rockproof_stepper::{Real, Vector};

/// What f64 finds to be less than another length by this share is less.
const DOUBT: f64 = 1e-6;

/// The pairs of a state that are past the middle of one another, in ascending order, each with the greatest overlap that such a contact measures.
///
/// A contact pushes A along n, from B to A, until the overlap −h that it measures is gone. Moving A along −n by `max n·a − min n·b` over the vertices of A and of B
/// certainly parts the two as well. **Where that is less than −h, the contact is on the wrong side; where it is as much, it is not.** A pair is meant where a contact
/// that the step left closed and that is deeper than `penetration` (to first order, as the step has it) is on the wrong side, and every contact with h < 0 is: of
/// those that the step left closed, and of those that the exact classification finds. The blocks need not overlap any more: the contact pushes all the same.
pub(crate) fn past_middle<R: Real>(
    shapes: &[Block],
    set: &ToleranceSet,
    screen: &Screen<'_>,
    state: &State<R>,
) -> Vec<PairDepth> {
    let penetration = set.penetration.approximate();
    let closed = || state.contacts.iter().filter(|contact| contact.mode.is_closed());
    let pair = |blocks: [u32; 2]| blocks.map(|block| block as usize);
    let deep = closed().filter(|contact| -contact.gap.to_f64() > penetration);
    let near = |v: &Vector<R>| Vec3::new(v.x, v.y, v.z).map(|c| Near(c.to_f64()));
    let may_be = deep.filter(|contact| {
        let places = pair(contact.blocks).map(|block| state.blocks[block].vertices.iter().map(near).collect());
        let shapes = pair(contact.blocks).map(|block| &shapes[block]);
        let [overlap, other] = ways_out(shapes, &places, &contact.entrance());
        let is_less = overlap.0 < (1.0 - DOUBT) * other.0;
        // What is not a number may be anything.
        !is_less
    });
    let mut pairs: Vec<[usize; 2]> = may_be.map(|contact| pair(contact.blocks)).collect();
    pairs.sort_unstable();
    pairs.dedup();
    let measured = |blocks: [usize; 2]| {
        let closed: Vec<Contact> = closed().filter(|c| pair(c.blocks) == blocks).map(|c| c.contact).collect();
        let depth_m = pushed_from_the_wrong_side(screen, set, blocks, &closed)?;
        Some(PairDepth { blocks, depth_m })
    };
    pairs.into_iter().filter_map(measured).collect()
}

/// The greatest overlap (m) that a contact of a pair measures, where all contacts with h < 0 are on the wrong side.
fn pushed_from_the_wrong_side(
    screen: &Screen<'_>,
    set: &ToleranceSet,
    blocks: [usize; 2],
    closed: &[Contact],
) -> Option<f64> {
    let prepared = blocks.map(|block| PreparedBlock::new(&screen.block(block)));
    let pair = Pair::new(&prepared[0], &prepared[1]);
    let kept: Vec<ContactKey> = closed.iter().map(|contact| contact.key).collect();
    let found = pair.classify_with_kept(set, &kept).contacts;
    let shapes = prepared.each_ref().map(PreparedBlock::block);
    let exactly = |v: &Vec3<Number>| v.map(Number::to_rational);
    let places: [Vec<Vec3<BigRational>>; 2] = shapes.map(|block| block.vertices().iter().map(exactly).collect());
    let mut deepest: Option<f64> = None;
    for contact in closed.iter().chain(&found) {
        let gap = pair.gap(&contact.entrance);
        if gap.sign.is_negative() {
            let [overlap, other] = ways_out(shapes, &places, &contact.entrance);
            if overlap <= other {
                return None;
            }
            let depth = Number::from_rational(gap.squared).approximate().sqrt();
            deepest = Some(deepest.map_or(depth, |known| known.max(depth)));
        }
    }
    deepest
}

/// How far an entrance with h < 0 pushes block A until its overlap is gone, and how far A would have to move the other way to be certainly apart from B: both times
/// the length of one normal.
fn ways_out<T: Ring + PartialOrd>(shapes: [&Block; 2], places: &[Vec<Vec3<T>>; 2], entrance: &Entrance) -> [T; 2] {
    let [a, b] = places;
    let by_face = |(face, of_face, with_face): (&[VertexId], &[Vec3<T>], &[Vec3<T>]), vertex: VertexId| {
        let n = face_normal(with_face, face);
        let corners = face.iter().map(|v| n.dot(&with_face[v.index()]));
        let Some(sum) = corners.reduce(|sum, one| sum.plus(&one)) else { return [T::from_i32(0), T::from_i32(0)] };
        // The face's point is the mean of its corners.
        let count = T::from_i32(face.len() as i32);
        let overlap = sum.minus(&count.times(&n.dot(&of_face[vertex.index()])));
        [overlap, count.times(&behind(&n, of_face, with_face))]
    };
    match *entrance {
        Entrance::VertexFace(vertex, face) => by_face((shapes[1].topology().face(face), a, b), vertex),
        Entrance::FaceVertex(face, vertex) => by_face((shapes[0].topology().face(face), b, a), vertex),
        Entrance::EdgeEdge(edge_a, edge_b) => {
            let [one, two] = [(0, edge_a), (1, edge_b)].map(|(k, edge)| {
                let edge = shapes[k].topology().edge(edge);
                [edge.p, edge.q].map(|v| &places[k][v.index()])
            });
            let n = one[1].minus(one[0]).cross(&two[1].minus(two[0]));
            let gap = n.dot(&one[0].minus(two[0]));
            // Of the two directions across both edges that along which A is behind B.
            let (n, gap) = if gap > T::from_i32(0) { (n.negated(), gap.negated()) } else { (n, gap) };
            [gap.negated(), behind(&n, a, b)]
        }
    }
}

/// How far one block would have to move against a direction to be behind all of the other.
fn behind<T: Ring + PartialOrd>(n: &Vec3<T>, one: &[Vec3<T>], other: &[Vec3<T>]) -> T {
    let along = |points: &[Vec3<T>], is_better: fn(&T, &T) -> bool| {
        let all = points.iter().map(|point| n.dot(point));
        all.reduce(|best, next| if is_better(&next, &best) { next } else { best }).unwrap_or_else(|| T::from_i32(0))
    };
    along(one, |next, best| next > best).minus(&along(other, |next, best| next < best))
}

/// An f64, rounded as it is.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct Near(f64);

impl Ring for Near {
    fn from_i32(value: i32) -> Near {
        Near(value.into())
    }

    fn plus(&self, other: &Near) -> Near {
        Near(self.0 + other.0)
    }

    fn minus(&self, other: &Near) -> Near {
        Near(self.0 - other.0)
    }

    fn times(&self, other: &Near) -> Near {
        Near(self.0 * other.0)
    }

    fn negated(&self) -> Near {
        Near(-self.0)
    }
}
