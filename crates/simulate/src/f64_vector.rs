//! Points and directions of a state in f64, for what is told of a run: no step is made with them.

use rockproof_model::VertexId;
use rockproof_stepper::{Real, Vector};

/// A point (m) or a direction.
pub type Point = [f64; 3];

/// The nearest f64 of a vector of the stepper.
pub fn point<R: Real>(v: Vector<R>) -> Point {
    v.components().map(R::to_f64)
}

/// a + b.
pub fn plus(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] + b[k])
}

/// a − b.
pub fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] - b[k])
}

/// The cross product a × b.
pub fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The dot product a·b.
pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The length |a|.
pub fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// Twice the area vector of a face, outwards (m²), with its vertices where `at` says: the sum over the fan from the first of them, as N of SPEC section 2.
///
/// # Panics
/// When the face has no vertex.
pub fn face_normal(face: &[VertexId], at: impl Fn(VertexId) -> Point) -> Point {
    let first = at(face[0]);
    let arms: Vec<Point> = face[1..].iter().map(|&vertex| minus(at(vertex), first)).collect();
    arms.windows(2).map(|pair| cross(pair[0], pair[1])).fold([0.0; 3], plus)
}
