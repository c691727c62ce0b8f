//! Which decision made two answers differ.

use super::compare::{Difference, Features};
use super::engine::Trace;
use super::finding::{DecidingDecision, FAR_FROM_TIE};
use super::indexed_trace::IndexedTrace;
use rockproof_model::decision::{Decision, Feature, Side};
use rockproof_model::{Contact, VertexId};
use std::collections::{BTreeSet, HashMap};
use std::rc::Rc;

/// The two sides of a link of the chain, asked only when there is something to explain.
pub struct ChainLink<'x> {
    /// The decisions on the side of the first answer.
    pub before: &'x dyn Fn() -> Option<Rc<IndexedTrace>>,
    /// The decisions on the side of the second answer.
    pub after: &'x dyn Fn() -> Option<Rc<IndexedTrace>>,
    /// The exact relative margins of decisions.
    pub margins: &'x dyn Fn(&[Decision]) -> Vec<Option<f64>>,
    /// Half the eps of the precision that changed the answer, if one did.
    pub roundoff: Option<f64>,
}

/// A decision that came out differently on the two sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DivergentDecision {
    /// The decision.
    pub decision: Decision,
    /// Its outcomes before and after.
    pub outcomes: [i8; 2],
}

/// The decisions taken on both sides with different outcomes, in the order of the second trace.
pub fn divergent_decisions(before: &IndexedTrace, after: &Trace) -> Vec<DivergentDecision> {
    let mut found: Vec<DivergentDecision> = Vec::new();
    // Both sides take most decisions in the same order.
    let mut next = 0;
    for (decision, outcome) in after {
        let Some(place) = before.find(decision, next) else { continue };
        next = place + 1;
        let was = before.decisions()[place].1;
        if was != *outcome && found.iter().all(|p| p.decision != *decision) {
            found.push(DivergentDecision { decision: *decision, outcomes: [was, *outcome] });
        }
    }
    found
}

/// For each difference the decision nearest to a tie among those that parted, preferring decisions about features
/// that touch those of the difference; of equally near ones the first taken. Where that is too far from a tie for rounding to have
/// turned it, a nearer one that parted before it, anywhere, since it chose between features elsewhere. `None` where no trace tells.
pub fn explain(
    differences: &[Difference],
    link: &ChainLink<'_>,
    features: Features<'_>,
) -> Vec<Option<DecidingDecision>> {
    let traces = (link.before)().and_then(|before| Some((before, (link.after)()?)));
    let Some((before, after)) = traces else { return vec![None; differences.len()] };
    let parted = divergent_decisions(&before, after.decisions());
    // What parted around each difference, or everything that parted where that is nothing.
    let near: Vec<Vec<usize>> = differences
        .iter()
        .map(|difference| {
            let place = DifferenceVertices::of(difference, features);
            let near: Vec<usize> =
                (0..parted.len()).filter(|&i| place.touches(&parted[i].decision, features)).collect();
            if near.is_empty() { (0..parted.len()).collect() } else { near }
        })
        .collect();
    let wanted: BTreeSet<usize> = near.iter().flatten().copied().collect();
    let decisions: Vec<Decision> = wanted.iter().map(|&i| parted[i].decision).collect();
    let margins: HashMap<usize, Option<f64>> = wanted.into_iter().zip((link.margins)(&decisions)).collect();
    let size = |margin: Option<f64>| margin.map_or(f64::INFINITY, f64::abs);
    near.into_iter()
        .map(|candidates| {
            let margin = |i: usize| margins.get(&i).copied().flatten();
            let nearer = |best: usize, i: usize| if size(margin(i)) < size(margin(best)) { i } else { best };
            let nearest = candidates.into_iter().reduce(nearer)?;
            let (mut deciding, mut margin) = (parted[nearest], margin(nearest));
            let far = link.roundoff.is_some_and(|unit| size(margin) > FAR_FROM_TIE * unit);
            if far && let Some((cause, nearer)) = upstream(&parted[..nearest], link, size(margin)) {
                (deciding, margin) = (cause, Some(nearer));
            }
            let margin_ulps = link.roundoff.and_then(|unit| margin.map(|m| m / unit));
            let DivergentDecision { decision, outcomes } = deciding;
            Some(DecidingDecision { decision, outcomes, margin, margin_ulps })
        })
        .collect()
}

/// What no rounding turned follows from something that rounding did: of the decisions that parted before it, wherever they were taken, the
/// one nearest to a tie, with its margin, if that is below `below`.
fn upstream(before: &[DivergentDecision], link: &ChainLink<'_>, below: f64) -> Option<(DivergentDecision, f64)> {
    let decisions: Vec<Decision> = before.iter().map(|parted| parted.decision).collect();
    let margins = (link.margins)(&decisions);
    let known = before.iter().zip(margins).filter_map(|(parted, margin)| Some((*parted, margin?)));
    known.filter(|(_, margin)| margin.abs() < below).min_by(|(_, one), (_, other)| one.abs().total_cmp(&other.abs()))
}

/// For an engine that tells no decisions: around each difference, the decision of the oracle nearest to a tie, which is the
/// first to suspect. Its outcome after the change is not known and stands as before.
pub fn nearest_decisions(
    differences: &[Difference],
    link: &ChainLink<'_>,
    features: Features<'_>,
) -> Vec<Option<DecidingDecision>> {
    let Some(trace) = (link.before)() else { return vec![None; differences.len()] };
    differences
        .iter()
        .map(|difference| {
            let place = DifferenceVertices::of(difference, features);
            let (near, outcomes): (Vec<Decision>, Vec<i8>) =
                trace.decisions().iter().copied().filter(|(decision, _)| place.touches(decision, features)).unzip();
            let margins = (link.margins)(&near);
            let known = margins.iter().enumerate().filter_map(|(i, margin)| Some((i, (*margin)?)));
            let (i, margin) = known.reduce(|best, next| if next.1.abs() < best.1.abs() { next } else { best })?;
            Some(DecidingDecision {
                decision: near[i],
                outcomes: [outcomes[i]; 2],
                margin: Some(margin),
                margin_ulps: link.roundoff.map(|unit| margin / unit),
            })
        })
        .collect()
}

/// The vertices around a difference, in each block.
struct DifferenceVertices {
    a: Vec<VertexId>,
    b: Vec<VertexId>,
}

impl DifferenceVertices {
    fn of(difference: &Difference, features: Features<'_>) -> DifferenceVertices {
        let mut place = DifferenceVertices { a: Vec::new(), b: Vec::new() };
        for contact in [difference.before, difference.after].into_iter().flatten() {
            for feature in all_features(&contact) {
                place.side(feature.side()).extend(features.vertices(feature));
            }
        }
        place
    }

    fn side(&mut self, side: Side) -> &mut Vec<VertexId> {
        match side {
            Side::A => &mut self.a,
            Side::B => &mut self.b,
        }
    }

    fn touches(&self, decision: &Decision, features: Features<'_>) -> bool {
        decision.features().iter().flatten().all(|&feature| {
            let around = match feature.side() {
                Side::A => &self.a,
                Side::B => &self.b,
            };
            features.any_vertex(feature, |v| around.contains(&v))
        })
    }
}

fn all_features(contact: &Contact) -> impl Iterator<Item = Feature> {
    contact.key.features().into_iter().chain(contact.entrance.features())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::AnswerChange;
    use rockproof_model::decision::Predicate;
    use rockproof_model::{ContactKey, Entrance, FaceId, Sign, Topology};

    /// What is named for a contact of two corners that went because another way out was chosen, elsewhere, with this margin.
    fn named(chosen: f64, roundoff: Option<f64>) -> Option<Predicate> {
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let solid = Topology::new(4, faces.map(|face| face.to_vec()).to_vec()).expect("a tetrahedron");
        let about =
            |predicate, v| Decision::about(predicate, &[Feature::Vertex(Side::A, v), Feature::Vertex(Side::B, v)]);
        // Vertex 3 is no part of the contact: of the two, the second decision alone is near it.
        let (elsewhere, here) = (about(Predicate::TrueExit, VertexId(3)), about(Predicate::OneExit, VertexId(0)));
        let entrance = Entrance::VertexFace(VertexId(0), FaceId(0));
        let gone = Contact { key: ContactKey::VertexVertex(VertexId(0), VertexId(0)), entrance, gap: Sign::Negative };
        let difference = Difference { change: AnswerChange::Missing, before: Some(gone), after: None };
        let link = ChainLink {
            before: &|| Some(Rc::new(IndexedTrace::of(vec![(elsewhere, 0), (here, 1)]))),
            after: &|| Some(Rc::new(IndexedTrace::of(vec![(elsewhere, 1), (here, 0)]))),
            margins: &|decisions| decisions.iter().map(|d| Some(if *d == here { 0.5 } else { chosen })).collect(),
            roundoff,
        };
        let deciding = explain(&[difference], &link, Features { a: &solid, b: &solid }).remove(0);
        deciding.map(|deciding| deciding.decision.predicate)
    }

    #[test]
    fn what_no_rounding_turned_follows_from_what_parted_before_it() {
        let unit = f64::EPSILON / 2.0;
        assert_eq!(named(unit / 8.0, Some(unit)), Some(Predicate::TrueExit));
        // What is further from a tie explains nothing, and without rounding the nearest decision is the answer.
        assert_eq!(named(0.9, Some(unit)), Some(Predicate::OneExit));
        assert_eq!(named(unit / 8.0, None), Some(Predicate::OneExit));
    }
}
