//! Contacts of two blocks, exactly or as a program in floats finds them.

use crate::block::Block;
use crate::boundary::text;
use crate::distance::Distance;
use crate::tolerances::{Tolerances, set_for};
use num_traits::Signed;
use rockproof_model::{Number, Precision, ToleranceSet};
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_stepper::Real;
use rockproof_stepper::contact::{PreparedBlock as FloatBlock, SpecRules, classify};

/// Which features touch; A's is named first.
#[repr(C)]
#[derive(Clone, Copy)]
pub enum ContactKind {
    /// A vertex and a vertex.
    VertexVertex,
    /// A vertex of A and an edge of B.
    VertexEdge,
    /// An edge of A and a vertex of B.
    EdgeVertex,
    /// A vertex of A and a face of B.
    VertexFace,
    /// A face of A and a vertex of B.
    FaceVertex,
    /// Two edges that cross.
    EdgeEdge,
}

/// Which features span the plane through which the blocks enter one another; A's is named first.
#[repr(C)]
#[derive(Clone, Copy)]
pub enum EntranceKind {
    /// A vertex of A and a face of B.
    VertexFace,
    /// A face of A and a vertex of B.
    FaceVertex,
    /// An edge of each.
    EdgeEdge,
}

/// A contact. Features are numbered as `rockproof_block_vertex`, `rockproof_block_edge` and `rockproof_block_face` number them.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Contact {
    /// Which features touch.
    pub kind: ContactKind,
    /// A's vertex, edge or face, by `kind`.
    pub feature_a: u32,
    /// B's, likewise.
    pub feature_b: u32,
    /// Which features span the entrance plane.
    pub entrance: EntranceKind,
    /// A's feature of the entrance plane.
    pub entrance_a: u32,
    /// B's, likewise.
    pub entrance_b: u32,
    /// 1 apart, 0 touching, -1 overlapping.
    pub gap_sign: i32,
    /// The gap in metres, negative for an overlap: the double nearest to the exact one, or what floats calculate.
    pub gap: f64,
}

/// The contacts of two blocks, sorted by kind and features. They never change, so threads may share them.
pub struct Contacts(pub(crate) Vec<(Contact, Distance)>);

impl Contacts {
    /// The contacts of two blocks; in floats of a precision, or exactly.
    pub(crate) fn of(
        [a, b]: [&Block; 2],
        tolerances: Option<&Tolerances>,
        precision: Option<Precision>,
    ) -> Result<Contacts, String> {
        let set = set_for(tolerances, [a, b], precision.unwrap_or(Precision::F64))?;
        match precision {
            None => Ok(exact(a, b, &set)),
            Some(Precision::F64) => in_floats::<f64>(a, b, &set),
            Some(Precision::F32) => in_floats::<f32>(a, b, &set),
        }
    }
}

fn exact(a: &Block, b: &Block, set: &ToleranceSet) -> Contacts {
    let (a, b) = (PreparedBlock::new(&a.block), PreparedBlock::new(&b.block));
    let pair = Pair::new(&a, &b);
    let found = pair.classify(set).contacts.into_iter().map(|contact| {
        let gap = pair.gap(&contact.entrance);
        let distance = Distance::new(i32::from(gap.sign.as_i8()), &gap.squared);
        (of_model(&contact, distance.nearest), distance)
    });
    Contacts(found.collect())
}

fn in_floats<R: Real + Into<f64>>(a: &Block, b: &Block, set: &ToleranceSet) -> Result<Contacts, String> {
    let prepared = |block: &Block, name: &str| {
        FloatBlock::<R>::new(&block.block).map_err(|error| format!("block {name}: {error}"))
    };
    let (a, b) = (prepared(a, "a")?, prepared(b, "b")?);
    let tolerances = rockproof_stepper::contact::Tolerances::new(set).map_err(|error| error.to_string())?;
    let with_gap = |found: rockproof_stepper::contact::ComputedContact<R>| {
        let gap: f64 = found.gap.into();
        let exact = Number::from_f64(gap).map_err(|error| format!("the gap of a contact: {error}"))?.to_rational();
        let distance = Distance {
            sign: if exact.is_negative() { -1 } else { i32::from(exact.is_positive()) },
            nearest: gap,
            squared: text(&(&exact * &exact).to_string()),
            exact: Some(text(&exact.to_string())),
        };
        Ok((of_model(&found.contact, gap), distance))
    };
    classify::<R, SpecRules>(&a, &b, &tolerances).into_iter().map(with_gap).collect::<Result<_, String>>().map(Contacts)
}

fn of_model(contact: &rockproof_model::Contact, gap: f64) -> Contact {
    use rockproof_model::{ContactKind as Kind, EntranceKind as Entrance};
    let ([feature_a, feature_b], [entrance_a, entrance_b]) = (contact.key.numbers(), contact.entrance.numbers());
    Contact {
        kind: match contact.kind() {
            Kind::VertexVertex => ContactKind::VertexVertex,
            Kind::VertexEdge => ContactKind::VertexEdge,
            Kind::EdgeVertex => ContactKind::EdgeVertex,
            Kind::VertexFace => ContactKind::VertexFace,
            Kind::FaceVertex => ContactKind::FaceVertex,
            Kind::EdgeEdge => ContactKind::EdgeEdge,
        },
        feature_a,
        feature_b,
        entrance: match contact.entrance.kind() {
            Entrance::VertexFace => EntranceKind::VertexFace,
            Entrance::FaceVertex => EntranceKind::FaceVertex,
            Entrance::EdgeEdge => EntranceKind::EdgeEdge,
        },
        entrance_a,
        entrance_b,
        gap_sign: i32::from(contact.gap.as_i8()),
        gap,
    }
}
