//! What a block moves with.

use super::Body;
use crate::block::Block;
use crate::number::Number;
use crate::topology::VertexId;
use crate::vector::Vec3;

/// What a block of this mass (kg) moves and turns with in its scene (J): ½·m·v² + ½·ω·J·ω, in f64.
pub fn motion_energy(block: &Block, body: &Body, mass: f64) -> f64 {
    let velocity = near(&body.velocity);
    mass / 2.0 * dot(velocity, velocity) + spin_energy(block, body, mass)
}

/// What a block of this mass (kg) turns with (J): ½·ω·J·ω, in f64.
pub(crate) fn spin_energy(block: &Block, body: &Body, mass: f64) -> f64 {
    let spin = near(&body.spin);
    let centroid = near(&block.centroid().map(|c| Number::from_rational(c.clone())));
    // ∫|ω × x|² over the tetrahedra of the centroid and each triangle of the surface: of a quadratic form q, V/20·(Σ q(corner) + q(Σ corners)).
    let (mut volume, mut integral) = (0.0, 0.0);
    let arm = |vertex: &VertexId| -> [f64; 3] {
        let at = near(&block.vertices()[vertex.index()]);
        std::array::from_fn(|k| at[k] - centroid[k])
    };
    for face in block.topology().faces() {
        let corners: Vec<[f64; 3]> = face.iter().map(arm).collect();
        for pair in corners[1..].windows(2) {
            let triangle = [corners[0], pair[0], pair[1]];
            let part = dot(triangle[0], cross(triangle[1], triangle[2])) / 6.0;
            let square = |x: [f64; 3]| dot(cross(spin, x), cross(spin, x));
            let sum = triangle.into_iter().fold([0.0; 3], |sum, at| std::array::from_fn(|k| sum[k] + at[k]));
            integral += part / 20.0 * (triangle.map(square).iter().sum::<f64>() + square(sum));
            volume += part;
        }
    }
    mass / 2.0 * (integral / volume)
}

fn near(vector: &Vec3<Number>) -> [f64; 3] {
    vector.components().map(Number::approximate)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
