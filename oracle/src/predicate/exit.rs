//! Whether two entrances leave the same way.

use super::*;

/// The entrance's normal before σ, from the face outwards: B to A for v-f and (with σ) e-e, A to B for f-v.
fn entrance_normal<V: View>(view: &V, entrance: &Entrance) -> Vec3<V::T> {
    match *entrance {
        Entrance::VertexFace(_, face) => view.normal(Side::B, face),
        Entrance::FaceVertex(face, _) => view.normal(Side::A, face),
        Entrance::EdgeEdge(edge_a, edge_b) => across(view, edge_a, edge_b),
    }
}

/// `n₁·n₂` of two entrances, before σ and before f-v normals are turned from B to A.
pub(crate) struct NormalsAgree {
    pub(crate) first: Entrance,
    pub(crate) second: Entrance,
}

impl Polynomial for NormalsAgree {
    const FIRST_SLOT: usize = after::<LargerGap>();
    const VARIANTS: usize = 9;
    const DEGREE: usize = 4;
    const WITHIN_BLOCKS: bool = true;
    fn variant(&self) -> usize {
        kind_of(&self.first) * 3 + kind_of(&self.second)
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        entrance_normal(view, &self.first).dot(&entrance_normal(view, &self.second))
    }
}

/// `so²|n₁|²|n₂|² − |n₁ × n₂|²`: at least zero where two normals are within the overlap angle.
pub(crate) struct NormalsWithin {
    pub(crate) first: Entrance,
    pub(crate) second: Entrance,
}

impl Polynomial for NormalsWithin {
    const FIRST_SLOT: usize = after::<NormalsAgree>();
    const VARIANTS: usize = 9;
    const DEGREE: usize = 8;
    const WITHIN_BLOCKS: bool = true;
    const DENOMINATOR: Denominator = Denominator::OneSquared;
    fn variant(&self) -> usize {
        kind_of(&self.first) * 3 + kind_of(&self.second)
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        let (n1, n2) = (entrance_normal(view, &self.first), entrance_normal(view, &self.second));
        let scales = view.scales();
        let allowed = scales.overlap.squared().times(&n1.norm_squared()).times(&n2.norm_squared());
        allowed.minus(&scales.one.squared().times(&n1.cross(&n2).norm_squared()))
    }
}
