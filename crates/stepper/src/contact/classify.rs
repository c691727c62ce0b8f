//! The classification of a pair: rough phase, the four tests in their order, exits.

use crate::contact::boxes::{NearFeatures, neighbours, reach_of_kept};
use crate::contact::contact_rules::ContactRules;
use crate::contact::nearby_features::{NearbyFeatures, Planes};
use crate::contact::pair::{ExitCandidate, Pair};
use crate::contact::prepared_block::PreparedBlock;
use crate::contact::tolerances::Tolerances;
use crate::contact::trace::Observer;
use crate::real::Real;
use rockproof_model::decision::{Decision, Predicate, Side};
use rockproof_model::{Contact, ContactKey};
use std::marker::PhantomData;

/// A contact and its gap as calculated.
#[derive(Clone, Copy, Debug)]
pub struct ComputedContact<R> {
    /// The contact, with the sign of its gap.
    pub contact: Contact,
    /// The gap of its entrance in metres: positive apart, negative overlapping.
    pub gap: R,
}

/// What is classified: a pair of blocks, in a step with the contacts that the step before left it.
#[derive(Clone, Copy, Debug)]
pub struct ClassificationRequest<'s, R> {
    /// The first block.
    pub a: &'s PreparedBlock<R>,
    /// The second block.
    pub b: &'s PreparedBlock<R>,
    /// The tolerances.
    pub tolerances: &'s Tolerances<R>,
    /// The contacts of this pair that the step before left closed, in any order: depth alone does not end them.
    pub kept: &'s [ContactKey],
    /// The only pairs of features of which there can be contacts, where that is known: then no others are looked at.
    pub among: Option<&'s NearbyFeatures>,
}

/// The contacts of two blocks, in the order of SPEC section 4, where nothing is kept.
pub fn classify<R: Real, M: ContactRules>(
    a: &PreparedBlock<R>,
    b: &PreparedBlock<R>,
    t: &Tolerances<R>,
) -> Vec<ComputedContact<R>> {
    classify_with_kept::<R, M>(a, b, t, &[])
}

/// The contacts of two blocks in a step; `kept` as in [`ClassificationRequest`].
///
/// # Panics
/// When a kept contact names a feature that its block does not have.
pub fn classify_with_kept<R: Real, M: ContactRules>(
    a: &PreparedBlock<R>,
    b: &PreparedBlock<R>,
    t: &Tolerances<R>,
    kept: &[ContactKey],
) -> Vec<ComputedContact<R>> {
    M::contacts(ClassificationRequest { a, b, tolerances: t, kept, among: None })
}

/// The contacts of two blocks where nothing is kept, with every decision made on the way.
pub fn classify_traced<R: Real, M: ContactRules>(
    a: &PreparedBlock<R>,
    b: &PreparedBlock<R>,
    t: &Tolerances<R>,
) -> (Vec<ComputedContact<R>>, Vec<(Decision, i8)>) {
    ClassificationRequest { a, b, tolerances: t, kept: &[], among: None }.traced::<M>()
}

impl<R: Real> ClassificationRequest<'_, R> {
    /// The contacts, with every decision made on the way.
    ///
    /// # Panics
    /// When a kept contact names a feature that its block does not have.
    pub fn traced<M: ContactRules>(self) -> (Vec<ComputedContact<R>>, Vec<(Decision, i8)>) {
        M::traced(self)
    }

    /// The contacts, in the order of SPEC section 4, watched by an observer.
    ///
    /// # Panics
    /// When a kept contact names a feature that its block does not have.
    pub fn observed<M: ContactRules, O: Observer>(self, seen: &mut O) -> Vec<ComputedContact<R>> {
        let ClassificationRequest { a, b, tolerances: t, kept, among } = self;
        let adjacent = neighbours::<R, M>(a, b, t);
        seen.observe(Predicate::Neighbours, &[], i8::from(adjacent));
        if !adjacent {
            return Vec::new();
        }
        let mut pair: Pair<'_, R, M, O> = Pair {
            a,
            b,
            t,
            kept,
            seen,
            candidates: Vec::new(),
            true_exits: Vec::new(),
            hits: Vec::with_capacity(among.map_or(0, NearbyFeatures::len)),
            rules: PhantomData,
        };
        if let Some(among) = among {
            pair.look_among(among);
            return pair.finish();
        }
        let reach = reach_of_kept(self);
        let near = NearFeatures::<R>::new::<M>(a, b, reach);
        pair.vertices_and_vertices(&near);
        pair.vertices_and_edges(&near, Side::A);
        if M::edge_vertex_role() {
            pair.vertices_and_edges(&near, Side::B);
        }
        pair.vertices_and_faces(&near, Side::A);
        if M::face_vertex_role() {
            pair.vertices_and_faces(&near, Side::B);
        }
        pair.edges_and_edges(&near, reach);
        pair.finish()
    }
}

impl<R: Real, M: ContactRules, O: Observer> Pair<'_, R, M, O> {
    fn vertices_and_vertices(&mut self, near: &NearFeatures<R>) {
        for &v in near.vertices(Side::A) {
            for &w in near.vertices(Side::B) {
                if R::is_given_up() {
                    return;
                }
                if R::leaves_out(ContactKey::VertexVertex(v, w)) {
                    continue;
                }
                self.vertex_vertex(v, w, Planes::ALL);
            }
        }
    }

    fn vertices_and_edges(&mut self, near: &NearFeatures<R>, side: Side) {
        let own = self.prepared(side);
        for &v in near.vertices(side) {
            for &(e, bounds) in near.edges(side.other()) {
                if R::is_given_up() {
                    return;
                }
                let contact = match side {
                    Side::A => ContactKey::VertexEdge(v, e),
                    Side::B => ContactKey::EdgeVertex(e, v),
                };
                if !R::leaves_out(contact) && !bounds.is_beyond(own.vertex(v).at, self.t.reach) {
                    self.vertex_edge(side, v, e, Planes::ALL);
                }
            }
        }
    }

    fn vertices_and_faces(&mut self, near: &NearFeatures<R>, side: Side) {
        let exits = M::shortest_exit_applies(self.both_convex());
        let faces = self.prepared(side.other()).block().topology();
        for &v in near.vertices(side) {
            let first = self.hits.len();
            for f in faces.face_ids() {
                if R::is_given_up() {
                    return;
                }
                let contact = match side {
                    Side::A => ContactKey::VertexFace(v, f),
                    Side::B => ContactKey::FaceVertex(f, v),
                };
                if !R::leaves_out(contact) {
                    self.vertex_face(side, v, f, Planes::ALL);
                }
            }
            if exits && self.hits.len() > first + 1 && !R::leaves_exits_out() {
                self.shortest_exit(side, first);
            }
        }
    }

    fn edges_and_edges(&mut self, near: &NearFeatures<R>, reach: R) {
        for (e, bounds) in near.edges(Side::A) {
            for (f, other) in near.edges(Side::B) {
                if R::is_given_up() {
                    return;
                }
                if !R::leaves_out(ContactKey::EdgeEdge(*e, *f)) && !bounds.beyond(other, reach) {
                    self.edge_edge(*e, *f, Planes::ALL);
                }
            }
        }
    }

    fn finish(mut self) -> Vec<ComputedContact<R>> {
        self.hits.sort_unstable_by_key(|hit| hit.contact);
        if M::one_exit_applies(self.both_convex()) && !R::leaves_exits_out() {
            self.one_exit();
        }
        self.hits.iter().map(|&ExitCandidate { contact, gap, .. }| ComputedContact { contact, gap }).collect()
    }

    fn both_convex(&self) -> bool {
        self.a.block().is_convex() && self.b.block().is_convex()
    }
}
