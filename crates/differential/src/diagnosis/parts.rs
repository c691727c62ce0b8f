//! Hypotheses about what is left out: kinds of contact, roles, corners, signs of gaps.

use super::hypothesis::{Hypothesis, HypothesisRange};
use super::question::PreparedQuestion;
use rockproof_model::decision::{Feature, Side};
use rockproof_model::{Block, Contact, ContactKind, Sign};
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
    /// Those of two edges whose directions are no further from parallel than the angle in this place of [`ANGLES`].
    NearParallel(usize),
}

/// Angles (°) that codes take edges within for parallel, whatever they are told.
const ANGLES: [f64; 14] = [0.01, 0.1, 0.5, 1.0, 2.0, 3.0, 5.0, 8.0, 10.0, 15.0, 20.0, 25.0, 30.0, 45.0];

/// The hypotheses about what is left out.
pub(super) fn all() -> impl Iterator<Item = Box<dyn Hypothesis>> {
    let kinds = ContactKind::ALL.map(LeftOut::Kind);
    let both = [ContactKind::VertexEdge, ContactKind::VertexFace].map(LeftOut::Kinds);
    let roles = [Side::A, Side::B].map(LeftOut::Role);
    let corners = [4, 5, 6, 7].map(LeftOut::Corners);
    let gaps = [Sign::Negative, Sign::Zero, Sign::Positive].map(LeftOut::Gap);
    let all = kinds.into_iter().chain(both).chain(roles).chain(corners).chain(gaps).chain([LeftOut::Concave]);
    let all = all.chain((0..ANGLES.len()).map(LeftOut::NearParallel));
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
            LeftOut::NearParallel(place) => format!("e-e-within-{}-degrees-left-out", ANGLES[*place]),
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
            LeftOut::NearParallel(place) => {
                format!("but for contacts e-e of edges within {}° of parallel, which are left out", ANGLES[*place])
            }
        }
    }

    fn contacts(&self, asked: &PreparedQuestion<'_>) -> Option<Vec<Contact>> {
        let features = asked.features();
        let convex = asked.question.blocks.iter().all(Block::is_convex);
        let is_left_out = |contact: &Contact| match self {
            LeftOut::NearParallel(place) => {
                contact.kind() == ContactKind::EdgeEdge
                    && sine(&asked.question.blocks, contact) <= ANGLES[*place].to_radians().sin()
            }
            _ => self.concerns(contact, features, convex),
        };
        Some(asked.pair.classify_with_variant(&asked.question.tolerances, RuleVariant::LeftOut(&is_left_out)))
    }

    fn ladder(&self) -> Option<(String, usize)> {
        match self {
            LeftOut::NearParallel(place) => Some(("e-e-left-out".to_owned(), *place)),
            _ => None,
        }
    }

    fn range_to(&self, last: usize) -> Option<HypothesisRange> {
        let LeftOut::NearParallel(place) = self else { return None };
        let [least, most] = [ANGLES[*place], ANGLES[last]];
        Some(HypothesisRange {
            name: format!("e-e-within-{least}-to-{most}-degrees-left-out"),
            sentence: format!(
                "but for contacts e-e of edges within {least}° to {most}° of parallel, which are left out"
            ),
        })
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
            LeftOut::NearParallel(_) => false,
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

/// The sine of the angle between the two edges of a contact e-e, in f64.
fn sine([a, b]: &[Block; 2], contact: &Contact) -> f64 {
    let [one, other] = contact.key.numbers();
    let direction = |block: &Block, edge: u32| -> [f64; 3] {
        let edge = block.topology().edges()[edge as usize];
        let [from, to] = [edge.p, edge.q].map(|v| &block.vertices()[v.index()]);
        [0, 1, 2].map(|k| to.components()[k].approximate() - from.components()[k].approximate())
    };
    let ([x, y, z], [u, v, w]) = (direction(a, one), direction(b, other));
    let length = |[x, y, z]: [f64; 3]| (x * x + y * y + z * z).sqrt();
    length([y * w - z * v, z * u - x * w, x * v - y * u]) / (length([x, y, z]) * length([u, v, w]))
}
