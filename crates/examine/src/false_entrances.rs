//! Contacts that push where nothing met, or through a face that another block covers (docs/step.md, "False entrances"). The entrance of a contact is the plane with the
//! largest gap where a step begins, of these two blocks alone: what else is there, and where they are when they meet, it does not see.

use rockproof_model::{Block, ContactKey, VertexId};
use rockproof_oracle::audit::Screen;
use rockproof_simulate::FalseEntrance;
use rockproof_simulate::f64_vector::{dot, face_normal, length, minus, plus, point};
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::{ContactState, State};
use std::cell::OnceCell;
use std::collections::BTreeMap;

/// False entrances that bear no more than this share of what contacts press a block with are not told: cut rock at rest has them in many steps, and stays where it is.
const SHARE: f64 = 0.2;

/// Faces whose normals are nearer to one another than 60° are one way out.
const SAME_WAY: f64 = 0.5;

/// Where the vertices of a block are (m).
pub(crate) type Places = Vec<[f64; 3]>;

/// The places of a state.
pub(crate) fn places<R: Real>(state: &State<R>) -> Vec<Places> {
    state.blocks.iter().map(|block| block.vertices.iter().map(|&vertex| point(vertex)).collect()).collect()
}

/// The unit normal of a face, outwards, and a corner of it; none of a face without area.
type FacePlane = Option<([f64; 3], [f64; 3])>;

/// The planes of the faces of blocks where they were when the step began, of each block once it is asked for.
pub(crate) struct FacePlanes(Vec<OnceCell<Vec<FacePlane>>>);

impl FacePlanes {
    /// None yet, of so many blocks.
    pub(crate) fn of(blocks: usize) -> FacePlanes {
        FacePlanes(vec![OnceCell::new(); blocks])
    }
}

/// A vertex that a contact pushes out of another block.
struct PushedVertex {
    /// The block of the vertex.
    block: usize,
    vertex: VertexId,
    /// The block that it is pushed out of.
    out_of: usize,
    /// Of unit length.
    along: [f64; 3],
    /// The gap where the step begins (m).
    gap_before: f64,
    /// How far it is pushed at its end (m), to first order.
    depth: f64,
}

/// Where blocks were and are in a step.
pub(crate) struct StepGeometry<'s> {
    /// The blocks as the scene has them.
    pub(crate) shapes: &'s [Block],
    /// Whether each never moves.
    pub(crate) is_fixed: &'s [bool],
    /// Where they were when the step began.
    pub(crate) before: &'s [Places],
    /// Where they are now.
    pub(crate) after: &'s [Places],
    /// The same, for what is surely apart.
    pub(crate) screen: &'s Screen<'s>,
    /// The planes of faces where the step begins.
    pub(crate) planes: FacePlanes,
    /// `penetration` (m).
    pub(crate) penetration: f64,
    /// The depth that rounded coordinates alone can make (m).
    pub(crate) rounding: f64,
}

impl StepGeometry<'_> {
    /// The false entrances of blocks that these bear more than a fifth of what contacts press them with, those of each kind together: one for each pair and block behind
    /// it, those that never met first, in ascending order.
    pub(crate) fn false_entrances<R: Real>(&self, state: &State<R>) -> Vec<FalseEntrance> {
        let pressed = || state.contacts.iter().filter(|c| c.mode.is_closed() && -c.gap.to_f64() > self.rounding);
        let mut all = vec![0.0; self.shapes.len()];
        for contact in pressed() {
            contact.blocks.iter().for_each(|&block| all[block as usize] += normal_force(contact));
        }
        let known = OnceCell::new();
        let near = |block: usize| known.get_or_init(|| neighbours(state))[block].as_slice();
        let mut found: BTreeMap<([usize; 2], Option<usize>), f64> = BTreeMap::new();
        let mut may_be_apart: BTreeMap<[usize; 2], bool> = BTreeMap::new();
        for contact in pressed() {
            let blocks = contact.blocks.map(|block| block as usize);
            let is_deep = || self.screen.greatest_depth(blocks).is_some_and(|depth| depth > 2.0 * self.rounding);
            let is_unmet = *may_be_apart.entry(blocks).or_insert_with(|| !is_deep()) && self.never_met(contact);
            let into = if is_unmet { None } else { self.covering_block(contact, &near) };
            if is_unmet || into.is_some() {
                *found.entry((blocks, into)).or_default() += normal_force(contact);
            }
        }
        let is_told = |block: usize, force: f64| !self.is_fixed[block] && force > SHARE * all[block];
        let mut told = Vec::new();
        for is_covered in [false, true] {
            let of_kind = || found.iter().filter(|((_, into), _)| into.is_some() == is_covered);
            let mut sums = vec![0.0; self.shapes.len()];
            for ((blocks, _), force) in of_kind() {
                blocks.iter().for_each(|&block| sums[block] += force);
            }
            let share = |blocks: [usize; 2]| {
                let of = |block: usize| if is_told(block, sums[block]) { sums[block] / all[block] } else { 0.0 };
                blocks.map(of).into_iter().fold(0.0, f64::max)
            };
            let entrances = of_kind().map(|(&(blocks, into), _)| FalseEntrance { blocks, into, share: share(blocks) });
            told.extend(entrances.filter(|entrance| entrance.share > 0.0));
        }
        told
    }

    /// Whether a plane along a face of either block parts the blocks of a contact, but for rounding, from the beginning of the step to its end, vertices going straight, and
    /// the contact pushes along that plane rather than across it: across it, the gap of a block that turns is negative, to first order, where the blocks do not meet.
    fn never_met<R: Real>(&self, contact: &ContactState<R>) -> bool {
        let blocks = contact.blocks.map(|block| block as usize);
        let push = point(contact.normal);
        [blocks, [blocks[1], blocks[0]]].into_iter().any(|[own, other]| {
            let parts = |n: [f64; 3]| {
                dot(n, push).abs() < SAME_WAY
                    && [self.before, self.after].iter().all(|places| {
                        let along = |block: usize| places[block].iter().map(move |p| dot(n, *p));
                        let reach = along(own).fold(f64::NEG_INFINITY, f64::max);
                        along(other).fold(f64::INFINITY, f64::min) - reach > -self.rounding
                    })
            };
            let faces = 0..self.shapes[own].topology().faces().len();
            let planes = |face| [self.before, self.after].map(|places| self.plane(own, face, places));
            faces.flat_map(planes).flatten().any(|(n, _)| parts(n))
        })
    }

    /// The block that covers the way on which a contact pushes a vertex out of a block, though a face of that one lets it go and no block is behind there.
    fn covering_block<'n, R: Real>(
        &self,
        contact: &ContactState<R>,
        near: &dyn Fn(usize) -> &'n [usize],
    ) -> Option<usize> {
        let [a, b] = contact.blocks.map(|block| block as usize);
        let (out_of_b, depth) = (point(contact.normal), -contact.gap.to_f64());
        let out_of_a = out_of_b.map(|x| -x);
        let gap_before = dot(out_of_b, minus(point(contact.points[0]), point(contact.points[1])));
        let (of_a, of_b) = match contact.key() {
            ContactKey::VertexVertex(v, w) => (Some(v), Some(w)),
            ContactKey::VertexEdge(v, _) | ContactKey::VertexFace(v, _) => (Some(v), None),
            ContactKey::EdgeVertex(_, w) | ContactKey::FaceVertex(_, w) => (None, Some(w)),
            ContactKey::EdgeEdge(..) => (None, None),
        };
        let of_a = of_a.map(|vertex| PushedVertex { block: a, vertex, out_of: b, along: out_of_b, gap_before, depth });
        let of_b = of_b.map(|vertex| PushedVertex { block: b, vertex, out_of: a, along: out_of_a, gap_before, depth });
        of_a.into_iter().chain(of_b).find_map(|push| self.cover_of(&push, near))
    }

    /// The same of one vertex.
    fn cover_of<'n>(&self, push: &PushedVertex, near: &dyn Fn(usize) -> &'n [usize]) -> Option<usize> {
        let &PushedVertex { block, vertex, out_of, along, gap_before, depth } = push;
        if !self.shapes[out_of].is_convex() {
            return None;
        }
        // Blocks as they were, and the vertex moved along the normal as far as to first order it went in the step: only so is it as deep as the contact has it.
        let at = minus(self.before[block][vertex.index()], along.map(|x| x * (gap_before + depth)));
        let mut other_ways = Vec::new();
        for face in 0..self.shapes[out_of].topology().faces().len() {
            let (n, below) = self.depth_below((out_of, face), at)?;
            if below < 0.0 {
                // The vertex is not in the block.
                return None;
            }
            if below <= self.penetration && dot(n, along) < SAME_WAY {
                other_ways.push((n, below));
            }
        }
        if other_ways.is_empty() {
            return None;
        }
        let near = near(block);
        let beyond = |n: [f64; 3], way: f64| plus(at, n.map(|x| x * way));
        let holds = |other: usize, point, by: f64| other != out_of && self.is_inside(other, point, by);
        other_ways.into_iter().find_map(|(n, below)| {
            // Beyond a face that lets it go a block is no nearer than the contact pushes: where corners of a bond meet, each way leads into some block.
            if near.iter().any(|&other| holds(other, beyond(n, below + depth), 0.0)) {
                return None;
            }
            // Twice as far: on the surface itself both blocks of a seam are. As deep there as the lesser of both ways, or nearly: blocks side by side may overlap a little.
            let least = depth.min(below) / 2.0;
            let covers = |other| holds(other, beyond(along, 2.0 * depth), least) && !holds(other, at, 0.0);
            near.iter().copied().find(|&other| covers(other))
        })
    }

    /// How far a point is below the plane of a face where the step begins (m), with the face's unit normal, outwards; `None` of a face without area.
    fn depth_below(&self, (block, face): (usize, usize), point: [f64; 3]) -> Option<([f64; 3], f64)> {
        let faces = 0..self.shapes[block].topology().faces().len();
        let planes =
            self.planes.0[block].get_or_init(|| faces.map(|face| self.plane(block, face, self.before)).collect());
        let (n, on) = planes[face]?;
        Some((n, dot(n, minus(on, point))))
    }

    /// Whether a point is inside a convex block where the step begins, by more than rounding and so much (m).
    fn is_inside(&self, block: usize, point: [f64; 3], by: f64) -> bool {
        let mut faces = 0..self.shapes[block].topology().faces().len();
        let below = |face: usize| {
            self.depth_below((block, face), point).is_some_and(|(_, depth)| depth > self.rounding.max(by))
        };
        self.shapes[block].is_convex() && faces.all(below)
    }

    /// The unit normal of a face, outwards, and a corner of it.
    fn plane(&self, block: usize, face: usize, places: &[Places]) -> FacePlane {
        let corners = &self.shapes[block].topology().faces()[face];
        let corner = |vertex: VertexId| places[block][vertex.index()];
        let normal = face_normal(corners, corner);
        let size = length(normal);
        (size > 0.0).then(|| (normal.map(|x| x / size), corner(corners[0])))
    }
}

/// The blocks with which each has contacts, open ones too: those near it where the step begins.
fn neighbours<R: Real>(state: &State<R>) -> Vec<Vec<usize>> {
    let mut all = vec![Vec::new(); state.blocks.len()];
    for contact in &state.contacts {
        let [a, b] = contact.blocks.map(|block| block as usize);
        all[a].push(b);
        all[b].push(a);
    }
    for near in &mut all {
        near.sort_unstable();
        near.dedup();
    }
    all
}

/// What a contact presses its blocks apart with (N).
fn normal_force<R: Real>(contact: &ContactState<R>) -> f64 {
    dot(point(contact.force), point(contact.normal)).abs()
}
