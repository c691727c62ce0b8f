//! Whether rounding has destroyed a feature of a block.

use num_rational::BigRational;
use rockproof_model::block::face_normal;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, Vec3, VertexId};

/// The first feature of a block that has no extent left: two vertices of an edge at one place, or a face without
/// area. Decided exactly; the ordinary block is cleared by a bound in f64.
pub fn collapsed_feature(block: &Block) -> Option<String> {
    let points = block.vertices();
    for (number, edge) in block.topology().edges().iter().enumerate() {
        if points[edge.p.index()] == points[edge.q.index()] {
            return Some(format!("edge {number} has no length"));
        }
    }
    let flat = |face: &Vec<VertexId>| !surely_has_area(block, face) && has_no_area(block, face);
    block.topology().faces().iter().position(flat).map(|number| format!("face {number} has no area"))
}

/// True only for a face that certainly has area: one component of its normal stands clear of all rounding. With
/// coordinates that are f64, a difference of two is off by 2⁻⁵³ of itself, a product of two such by less than 2⁻⁵⁰ of
/// itself, and the sum of n of them by less than n·2⁻⁴⁹ of the sum of their magnitudes.
fn surely_has_area(block: &Block, face: &[VertexId]) -> bool {
    let at = |k: usize| {
        let p = &block.vertices()[face[k].index()];
        Some([p.x.as_f64()?, p.y.as_f64()?, p.z.as_f64()?])
    };
    let Some(origin) = at(0) else { return false };
    let (mut normal, mut magnitude) = ([0.0f64; 3], [0.0f64; 3]);
    for k in 1..face.len() - 1 {
        let (Some(u), Some(v)) = (at(k), at(k + 1)) else { return false };
        let [u, v] = [u, v].map(|p| [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]]);
        for i in 0..3 {
            let (j, l) = ((i + 1) % 3, (i + 2) % 3);
            let (one, other) = (u[j] * v[l], u[l] * v[j]);
            normal[i] += one - other;
            magnitude[i] += one.abs() + other.abs();
        }
    }
    let share = face.len() as f64 * 2f64.powi(-48);
    // Products below this may have lost bits to underflow.
    let floor = 1e-280;
    (0..3).any(|i| normal[i].is_finite() && normal[i].abs() > share * magnitude[i] + floor)
}

fn has_no_area(block: &Block, face: &[VertexId]) -> bool {
    let points: Vec<Vec3<BigRational>> = block.vertices().iter().map(|v| v.map(|c| c.to_rational())).collect();
    face_normal(&points, face).components().iter().all(|c| c.sign().is_zero())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::{BlockOptions, Number, Point, Precision};

    fn tetrahedron(points: [[f64; 3]; 4]) -> Block {
        let vertex = |p: [f64; 3]| {
            let [x, y, z] = p.map(|c| Number::from_f64(c).expect("finite"));
            Point::new(x, y, z)
        };
        let faces = vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]];
        let options = BlockOptions { planarity: Number::ZERO };
        Block::new(points.map(vertex).to_vec(), faces, &options).expect("a tetrahedron")
    }

    #[test]
    fn tells_what_rounding_destroyed() {
        let plain = tetrahedron([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(collapsed_feature(&plain), None);
        let far = tetrahedron([[1.0, 0.0, 0.0], [1.0 + 1e-9, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(collapsed_feature(&far), None);
        let rounded = far.rounded(Precision::F32).expect("in range");
        assert_eq!(collapsed_feature(&rounded).as_deref(), Some("edge 0 has no length"));
        // Three corners of face 0 on a line once 1e-9 is rounded away beside 1.
        let flat = tetrahedron([[1.0, 0.0, 0.0], [2.0, 1.0, 0.0], [3.0, 2.0 + 1e-9, 0.0], [0.0, 0.0, 1.0]]);
        let rounded = flat.rounded(Precision::F32).expect("in range");
        assert_eq!(collapsed_feature(&flat), None);
        assert_eq!(collapsed_feature(&rounded).as_deref(), Some("face 0 has no area"));
    }

    #[test]
    fn a_tiny_block_is_no_collapsed_block() {
        let e = 1e-160;
        let tiny = tetrahedron([[0.0, 0.0, 0.0], [e, 0.0, 0.0], [0.0, e, 0.0], [0.0, 0.0, e]]);
        assert_eq!(collapsed_feature(&tiny), None);
    }
}
