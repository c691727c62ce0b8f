//! The float side: discontinuous deformation analysis as a production code writes it, generic over its scalar.
//!
//! [`contact`] is SPEC section 4 with unit normals, square roots and comparisons with tolerances. It runs in f32, in f64,
//! and in [`wide::Wide`], a scalar of 512 bits that keeps a bound on its own rounding; the last tells a defect of this
//! code from a difference that rounding made. Nothing here uses the exact oracle or its arithmetic.

pub mod contact;
mod double;
pub mod dynamics;
pub mod engine;
mod lazy_wide;
mod motion_interval;
pub mod real;
pub mod vector;
pub mod wide;

pub use contact::{
    ClassificationRequest, Collapsed, ComputedContact, PreparedBlock, Tolerances, classify, classify_traced,
    classify_with_kept,
};
pub use engine::{Classifier, EngineError, Stepper};
pub use real::Real;
pub use vector::Vector;
pub use wide::Wide;
