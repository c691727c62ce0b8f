//! Finds the pairs of features of two blocks that can be in a contact ([`NearbyFeatures`]).

use crate::contact::boxes::{Bounds, reach_of_kept};
use crate::contact::classify::ClassificationRequest;
use crate::contact::contact_rules::ContactRules;
use crate::contact::entrance::{Candidate, KnownPlane, Plane};
use crate::contact::nearby_features::{NearbyFeatures, NearbyPair, Planes};
use crate::contact::pair::Pair;
use crate::contact::prepared_block::{PreparedBlock, Vertex};
use crate::contact::tolerances::Tolerances;
use crate::contact::trace::Unobserved;
use crate::motion_interval::{MotionInterval, certainly, is_open, leave_open, possibly, the_other_way};
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::decision::Side;
use rockproof_model::{Block, ContactKey, ContactKind, EdgeId, FaceId, VertexId};
use std::marker::PhantomData;

impl NearbyFeatures {
    /// The pairs of features of which there can be contacts while no coordinate of a vertex of either block is farther than `margin` (m) from where it is now, and
    /// nothing else is kept than what is now, or was found meanwhile. None where that is not known: of blocks that are not convex, and of such as are
    /// so thin that the margin matters.
    ///
    /// # Panics
    /// When a kept contact names a feature that its block does not have.
    pub fn of<R: Real>(request: ClassificationRequest<'_, R>, margin: f64) -> Option<NearbyFeatures> {
        let ClassificationRequest { a, b, tolerances, kept, .. } = request;
        let blocks = [a, b].map(PreparedBlock::block);
        let is_small = |n: usize| n <= usize::from(u16::MAX);
        let small = blocks.iter().all(|block| is_small(block.topology().edges().len()));
        if !R::IS_FLOAT || !small || !blocks.iter().all(|block| block.is_convex()) {
            return None;
        }
        let points = [a, b].map(|prepared| {
            let at = |v: &Vertex<R>| v.at.components().map(R::to_f64);
            prepared.vertices().iter().map(at).collect::<Vec<_>>()
        });
        let near = |length: R| MotionInterval::exact(length.to_f64());
        let tolerances = Tolerances {
            search: near(tolerances.search),
            territory: near(tolerances.territory),
            penetration: near(tolerances.penetration),
            overlap_sine: near(tolerances.overlap_sine),
            parallel_sine: near(tolerances.parallel_sine),
            equal: near(tolerances.equal),
            revised: tolerances.revised,
            reach: near(tolerances.reach),
        };
        // A little more, since it is rounded.
        let reach = reach_of_kept(request).to_f64() * (1.0 + 1e-6) + 2.0 * margin;
        Search::new([a.block(), b.block()], &points, margin)?.pairs(&tolerances, kept, reach)
    }
}

/// Two blocks, the vertices of which may be anywhere within a margin.
struct Search<'s> {
    points: &'s [Vec<[f64; 3]>; 2],
    prepared: [PreparedBlock<MotionInterval>; 2],
}

impl<'s> Search<'s> {
    fn new(blocks: [&Block; 2], points: &'s [Vec<[f64; 3]>; 2], margin: f64) -> Option<Search<'s>> {
        let prepare = |side: Side| {
            let near = |at: &[f64; 3]| {
                let [x, y, z] = at.map(|x| MotionInterval::within(x, margin));
                Vector::new(x, y, z)
            };
            let points: Vec<Vector<MotionInterval>> = points[side as usize].iter().map(near).collect();
            let (prepared, open) = is_open(|| {
                let prepared = PreparedBlock::unprepared(blocks[side as usize].clone()).with_points(&points).ok()?;
                let faces = || prepared.block().topology().face_ids();
                let all_left = faces().all(|face| prepared.turns_left(face));
                all_left.then_some(prepared)
            });
            prepared.filter(|_| !open)
        };
        Some(Search { points, prepared: [prepare(Side::A)?, prepare(Side::B)?] })
    }

    fn pairs(&self, t: &Tolerances<MotionInterval>, kept: &[ContactKey], reach: f64) -> Option<NearbyFeatures> {
        let [a, b] = &self.prepared;
        let bounds = [Side::A, Side::B].map(|side| {
            let points = &self.points[side as usize];
            points.iter().map(point_bounds).reduce(|all, one| all.joined(&one)).unwrap_or(point_bounds(&[0.0; 3]))
        });
        let vertices = [Side::A, Side::B].map(|side| {
            let all = (0..).map(VertexId).zip(&self.points[side as usize]);
            all.map(|(v, at)| (v, point_bounds(at))).collect::<Vec<_>>()
        });
        let edges = [Side::A, Side::B].map(|side| {
            let (points, prepared) = (&self.points[side as usize], &self.prepared[side as usize]);
            let at = |v: VertexId| point_bounds(&points[v.index()]);
            let all = prepared.block().topology().edge_ids().map(|e| (e, prepared.edge(e).edge));
            let boxes = all.map(|(e, edge)| (e, at(edge.p).joined(&at(edge.q))));
            boxes.filter(|(_, own)| !own.beyond(&bounds[side.other() as usize], reach)).collect::<Vec<_>>()
        });
        // As `reach_of_faces` in `boxes.rs`, or a little farther.
        let near = [a, b].map(|prepared| reach + 2.0 * prepared.bulge().highest());
        let mut seen = Unobserved;
        let (candidates, true_exits, hits) = (Vec::new(), Vec::new(), Vec::new());
        let seen = &mut seen;
        let mut pair: NearbyPairOfBlocks<'_> =
            Pair { a, b, t, kept, seen, candidates, true_exits, hits, rules: PhantomData };
        let mut found = Vec::new();
        let mut add = |kind, a: u32, b: u32, planes: Planes| {
            if planes.possible != 0 {
                found.push(NearbyPair { planes, a: a as u16, b: b as u16, kind });
            }
        };
        for (v, at) in &vertices[0] {
            for (w, other) in &vertices[1] {
                if !at.beyond(other, reach) {
                    add(ContactKind::VertexVertex, v.0, w.0, pair.vertices_may_meet(*v, *w));
                }
            }
        }
        for side in [Side::A, Side::B] {
            for (v, at) in &vertices[side as usize] {
                for (e, other) in &edges[side.other() as usize] {
                    if !at.beyond(other, reach) {
                        let planes = pair.vertex_may_meet_edge(side, *v, *e);
                        match side {
                            Side::A => add(ContactKind::VertexEdge, v.0, e.0, planes),
                            Side::B => add(ContactKind::EdgeVertex, e.0, v.0, planes),
                        }
                    }
                }
            }
        }
        for side in [Side::A, Side::B] {
            for (v, at) in &vertices[side as usize] {
                if at.beyond(&bounds[side.other() as usize], near[side.other() as usize]) {
                    continue;
                }
                for f in self.prepared[side.other() as usize].block().topology().face_ids() {
                    let planes = pair.vertex_may_meet_face(side, *v, f);
                    match side {
                        Side::A => add(ContactKind::VertexFace, v.0, f.0, planes),
                        Side::B => add(ContactKind::FaceVertex, f.0, v.0, planes),
                    }
                }
            }
        }
        for (e, own) in &edges[0] {
            for (f, other) in &edges[1] {
                if !own.beyond(other, reach) {
                    add(ContactKind::EdgeEdge, e.0, f.0, pair.edges_may_meet(*e, *f));
                }
            }
        }
        Some(NearbyFeatures { pairs: found.into_boxed_slice() })
    }
}

fn point_bounds(&[x, y, z]: &[f64; 3]) -> Bounds<f64> {
    Bounds::of_point(Vector::new(x, y, z))
}

type NearbyPairOfBlocks<'p> = Pair<'p, MotionInterval, NearbyRules, Unobserved>;

/// What a test says wherever the vertices are, if that is one thing.
fn verdict(mut test: impl FnMut() -> bool) -> Option<bool> {
    match (is_open(|| possibly(&mut test)), is_open(|| certainly(&mut test))) {
        ((false, false), _) => Some(false),
        (_, (true, false)) => Some(true),
        _ => None,
    }
}

impl NearbyPairOfBlocks<'_> {
    /// What is known of a pair of features by a test of where they are; all planes are possible then, or none.
    fn place(&mut self, mut test: impl FnMut(&mut Self) -> bool) -> Planes {
        let (possible, open) = is_open(|| possibly(|| test(self)));
        if !possible && !open {
            return Planes::NONE;
        }
        // A contact that is kept now may be found and not kept later.
        let kept = std::mem::take(&mut self.kept);
        let (certain, open) = is_open(|| certainly(|| test(self)));
        self.kept = kept;
        Planes { meets: certain && !open, ..Planes::ALL }
    }

    /// The same of v-v or v-e, of planes of which nothing is known yet.
    fn planeless(&mut self, test: impl FnMut(&mut Self) -> bool) -> Option<Planes> {
        let Planes { possible, meets, .. } = self.place(test);
        (possible != 0).then_some(Planes { meets, ..Planes::NONE })
    }

    fn vertices_may_meet(&mut self, v: VertexId, w: VertexId) -> Planes {
        let Some(mut planes) = self.planeless(|pair| pair.vertices_meet(v, w)) else { return Planes::NONE };
        self.vertex_vertex_planes(v, w, |pair, number, plane| {
            if let Some(known) = pair.may_pass(plane) {
                planes.add(number, known);
            }
        });
        planes
    }

    fn vertex_may_meet_edge(&mut self, side: Side, v: VertexId, e: EdgeId) -> Planes {
        let edge = self.prepared(side.other()).edge(e).edge;
        let meets = |pair: &mut Self| {
            pair.vertex_meets_edge(side, v, e, |pair| {
                unless(|| pair.in_vertex_territory(side, v, edge.p) || pair.in_vertex_territory(side, v, edge.q))
            })
        };
        let Some(mut planes) = self.planeless(meets) else { return Planes::NONE };
        self.vertex_edge_planes(side, v, e, |pair, number, plane| {
            if let Some(known) = pair.may_pass(plane) {
                planes.add(number, known);
            }
        });
        planes
    }

    fn vertex_may_meet_face(&mut self, side: Side, v: VertexId, f: FaceId) -> Planes {
        let contact = match side {
            Side::A => ContactKey::VertexFace(v, f),
            Side::B => ContactKey::FaceVertex(f, v),
        };
        let planes = self.place(|pair| {
            pair.vertex_meets_face(side, v, f, contact)
                && pair.cone_passes(side, v, f)
                && !unless(|| pair.belongs_to_rim(side, v, f))
        });
        let plane = self.vertex_face_entrance(side, v, f);
        self.with_exit(planes, plane)
    }

    fn edges_may_meet(&mut self, e: EdgeId, f: EdgeId) -> Planes {
        let mut plane = None;
        let planes = self.place(|pair| {
            plane = pair.edges_meet(e, f);
            plane.is_some_and(|plane| pair.wedges_pass(e, f, plane.normal)) && !unless(|| pair.ends_belong(e, f))
        });
        match plane {
            Some(plane) if planes.meets => self.with_exit(planes, plane),
            _ => planes,
        }
    }

    /// With what is known of the one plane.
    fn with_exit(&mut self, planes: Planes, plane: Candidate<MotionInterval>) -> Planes {
        if planes.possible == 0 {
            return planes;
        }
        let mut with = Planes { meets: planes.meets, ..Planes::NONE };
        with.add(0, KnownPlane { passes: planes.meets, exits: self.known_exit(plane) });
        with
    }

    fn known_exit(&mut self, plane: Candidate<MotionInterval>) -> Option<bool> {
        verdict(|| self.is_true_exit(plane))
    }

    /// What is known of a plane that may be a candidate.
    fn may_pass(&mut self, plane: Plane) -> Option<KnownPlane> {
        let unknown = KnownPlane { passes: false, exits: None };
        let offers = |pair: &mut Self| {
            pair.candidates.clear();
            let ((), open) = is_open(|| pair.offer(plane, unknown));
            (pair.candidates.first().copied(), open)
        };
        let (candidate, open) = possibly(|| offers(self));
        if open {
            return Some(unknown);
        }
        let candidate = candidate?;
        let (certain, open) = certainly(|| offers(self));
        let passes = certain.is_some() && !open;
        Some(KnownPlane { passes, exits: self.known_exit(candidate) })
    }
}

/// The answer of a test that takes a contact away: certain where others may be possible, and the other way round.
fn unless(test: impl FnOnce() -> bool) -> bool {
    the_other_way(test)
}

/// The rules of SPEC in [`MotionInterval`]. A test that lets a contact pass is possible, or certain, if all its comparisons are: but for these, which take
/// contacts away or decide neither way.
struct NearbyRules;

impl ContactRules for NearbyRules {
    fn nearly_parallel<R: Real>(sine: R, length_a: R, length_b: R, t: &Tolerances<R>) -> bool {
        let crosses = |value: R, limit: R| value > limit;
        !crosses(sine, t.parallel_sine) && (!t.revised || !crosses(sine * length_a.smaller(length_b), t.territory))
    }

    fn sigma_is_positive<R: Real>(lean: R) -> bool {
        let positive = lean >= R::ZERO;
        if positive == (lean < R::ZERO) {
            leave_open();
        }
        positive
    }
}
