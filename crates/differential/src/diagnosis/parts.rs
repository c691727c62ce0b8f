//! Hypotheses about what is left out: kinds of contact, roles, corners, signs of gaps.

use super::hypothesis::Hypothesis;
use super::question::PreparedQuestion;
use rockproof_model::decision::{Feature, Side};
use rockproof_model::{Contact, ContactKind, Sign};
use rockproof_oracle::RuleVariant;

use crate::compare::Features;

/// Contacts that are left out.
#[derive(Clone, Copy, Debug)]
enum LeftOut {
    /// Those of a kind.
    Kind(ContactKind),
    /// v-e and e-v, or v-f and f-v.
    Kinds(ContactKind),
    /// Those of a vertex of one block with an edge or a face of the other.
    Role(Side),
    /// Those at a corner where so many edges meet, or more.
    Corners(usize),
    /// Those whose gap has this sign.
    Gap(Sign),
    /// All of a pair of blocks that are not both convex.
    Concave,
}

/// The hypotheses about what is left out.
pub(super) fn all() -> impl Iterator<Item = Box<dyn Hypothesis>> {
    let kinds = ContactKind::ALL.map(LeftOut::Kind);
    let both = [ContactKind::VertexEdge, ContactKind::VertexFace].map(LeftOut::Kinds);
    let roles = [Side::A, Side::B].map(LeftOut::Role);
    let corners = [4, 5, 6, 7].map(LeftOut::Corners);
    let gaps = [Sign::Negative, Sign::Zero, Sign::Positive].map(LeftOut::Gap);
    let all = kinds.into_iter().chain(both).chain(roles).chain(corners).chain(gaps).chain([LeftOut::Concave]);
    all.map(|left_out| Box::new(left_out) as Box<dyn Hypothesis>)
}

impl Hypothesis for LeftOut {
    fn name(&self) -> String {
        match self {
            LeftOut::Kind(kind) => format!("{kind}-left-out"),
            LeftOut::Kinds(kind) => format!("{kind}-and-{}-left-out", kind.swapped()),
            LeftOut::Role(side) => format!("vertices-of-{}-left-out", block(*side).to_ascii_lowercase()),
            LeftOut::Corners(edges) => format!("corners-of-{edges}-edges-left-out"),
            LeftOut::Gap(sign) => format!("{}-left-out", gap(*sign)),
            LeftOut::Concave => "concave-blocks-left-out".to_owned(),
        }
    }

    fn sentence(&self) -> String {
        match self {
            LeftOut::Kind(kind) => format!("but for contacts {kind}, which are left out"),
            LeftOut::Kinds(kind) => format!("but for contacts {kind} and {}, which are left out", kind.swapped()),
            LeftOut::Role(side) => {
                let (one, other) = (block(*side), block(side.other()));
                format!("but for contacts of {one}'s vertices with edges and faces of {other}, which are left out")
            }
            LeftOut::Corners(edges) => format!("but for corners where {edges} or more edges meet, which are left out"),
            LeftOut::Gap(sign) => format!("but for contacts that are {}, which are left out", gap(*sign)),
            LeftOut::Concave => "but for pairs with a concave block, which are left out".to_owned(),
        }
    }

    fn contacts(&self, asked: &PreparedQuestion<'_>) -> Option<Vec<Contact>> {
        let features = asked.features();
        let convex = asked.question.blocks.iter().all(rockproof_model::Block::is_convex);
        let is_left_out = |contact: &Contact| self.concerns(contact, features, convex);
        Some(asked.pair.classify_with_variant(&asked.question.tolerances, RuleVariant::LeftOut(&is_left_out)))
    }
}

impl LeftOut {
    fn concerns(self, contact: &Contact, features: Features<'_>, convex: bool) -> bool {
        use ContactKind::{EdgeVertex, FaceVertex, VertexEdge, VertexFace};
        match self {
            LeftOut::Kind(kind) => contact.kind() == kind,
            LeftOut::Kinds(kind) => contact.kind() == kind || contact.kind().swapped() == kind,
            LeftOut::Role(Side::A) => matches!(contact.kind(), VertexEdge | VertexFace),
            LeftOut::Role(Side::B) => matches!(contact.kind(), EdgeVertex | FaceVertex),
            LeftOut::Corners(edges) => contact.key.features().into_iter().any(|feature| match feature {
                Feature::Vertex(Side::A, v) => features.a.vertex_edges(v).len() >= edges,
                Feature::Vertex(Side::B, v) => features.b.vertex_edges(v).len() >= edges,
                Feature::Edge(..) | Feature::Face(..) => false,
            }),
            LeftOut::Gap(sign) => contact.gap == sign,
            LeftOut::Concave => !convex,
        }
    }
}

fn block(side: Side) -> &'static str {
    match side {
        Side::A => "A",
        Side::B => "B",
    }
}

fn gap(sign: Sign) -> &'static str {
    match sign {
        Sign::Negative => "overlapping",
        Sign::Zero => "touching",
        Sign::Positive => "apart",
    }
}
