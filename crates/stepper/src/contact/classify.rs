//! The classification of a pair: rough phase, the four tests in their order, exits.

use crate::contact::broad::{Near, neighbours};
use crate::contact::pair::{Hit, Pair};
use crate::contact::rules::Rules;
use crate::contact::solid::Solid;
use crate::contact::tolerances::Tolerances;
use crate::contact::trace::{Observer, Trace, Unobserved};
use crate::real::Real;
use rockproof_model::Contact;
use rockproof_model::decision::{Decision, Predicate, Side};
use std::marker::PhantomData;

/// A contact and its gap as calculated.
#[derive(Clone, Copy, Debug)]
pub struct Found<R> {
    /// The contact, with the sign of its gap.
    pub contact: Contact,
    /// The gap of its entrance in metres: positive apart, negative overlapping.
    pub gap: R,
}

/// The contacts of two blocks, in the order of SPEC section 4.
pub fn classify<R: Real, M: Rules>(a: &Solid<R>, b: &Solid<R>, t: &Tolerances<R>) -> Vec<Found<R>> {
    classify_observed::<R, M, _>(a, b, t, &mut Unobserved)
}

/// The same, with every decision made on the way.
pub fn classify_traced<R: Real, M: Rules>(
    a: &Solid<R>,
    b: &Solid<R>,
    t: &Tolerances<R>,
) -> (Vec<Found<R>>, Vec<(Decision, i8)>) {
    let mut trace = Trace::default();
    let found = classify_observed::<R, M, _>(a, b, t, &mut trace);
    (found, trace.decisions)
}

/// The same, watched by an observer.
pub fn classify_observed<R: Real, M: Rules, O: Observer>(
    a: &Solid<R>,
    b: &Solid<R>,
    t: &Tolerances<R>,
    seen: &mut O,
) -> Vec<Found<R>> {
    let adjacent = neighbours::<R, M>(a, b, t);
    seen.saw(Predicate::Neighbours, &[], i8::from(adjacent));
    if !adjacent {
        return Vec::new();
    }
    let near = Near::<R>::new::<M>(a, b, t.reach);
    let mut pair: Pair<'_, R, M, O> =
        Pair { a, b, t, seen, candidates: Vec::new(), hits: Vec::new(), rules: PhantomData };
    pair.vertices_and_vertices(&near);
    pair.vertices_and_edges(&near, Side::A);
    if M::edge_vertex_role() {
        pair.vertices_and_edges(&near, Side::B);
    }
    pair.vertices_and_faces(&near, Side::A);
    if M::face_vertex_role() {
        pair.vertices_and_faces(&near, Side::B);
    }
    pair.edges_and_edges(&near);
    pair.finish()
}

impl<R: Real, M: Rules, O: Observer> Pair<'_, R, M, O> {
    fn vertices_and_vertices(&mut self, near: &Near<R>) {
        for &v in near.vertices(Side::A) {
            for &w in near.vertices(Side::B) {
                self.vertex_vertex(v, w);
            }
        }
    }

    fn vertices_and_edges(&mut self, near: &Near<R>, side: Side) {
        let own = self.solid(side);
        for &v in near.vertices(side) {
            for &(e, bounds) in near.edges(side.other()) {
                if !bounds.is_beyond(own.vertex(v).at, self.t.reach) {
                    self.vertex_edge(side, v, e);
                }
            }
        }
    }

    fn vertices_and_faces(&mut self, near: &Near<R>, side: Side) {
        let exits = M::shortest_exit_applies(self.both_convex());
        let faces = self.solid(side.other()).faces().len() as u32;
        for &v in near.vertices(side) {
            let first = self.hits.len();
            for f in 0..faces {
                self.vertex_face(side, v, f);
            }
            if exits && self.hits.len() > first + 1 {
                self.shortest_exit(side, first);
            }
        }
    }

    fn edges_and_edges(&mut self, near: &Near<R>) {
        for (e, bounds) in near.edges(Side::A) {
            for (f, other) in near.edges(Side::B) {
                if !bounds.beyond(other, self.t.reach) {
                    self.edge_edge(*e, *f);
                }
            }
        }
    }

    fn finish(mut self) -> Vec<Found<R>> {
        self.hits.sort_unstable_by_key(|hit| hit.contact);
        if M::one_exit_applies(self.both_convex()) {
            self.one_exit();
        }
        self.hits.iter().map(|&Hit { contact, gap, .. }| Found { contact, gap }).collect()
    }

    fn both_convex(&self) -> bool {
        self.a.block().is_convex() && self.b.block().is_convex()
    }
}
