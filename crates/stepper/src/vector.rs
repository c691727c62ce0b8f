//! Three-vectors of the stepper's scalar.

use crate::real::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A vector, or a point in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<R> {
    /// Component along x.
    pub x: R,
    /// Component along y.
    pub y: R,
    /// Component along z.
    pub z: R,
}

impl<R: Real> Vector<R> {
    /// The zero vector.
    pub const ZERO: Self = Vector { x: R::ZERO, y: R::ZERO, z: R::ZERO };

    /// The vector of three components.
    #[inline]
    pub fn new(x: R, y: R, z: R) -> Self {
        Vector { x, y, z }
    }

    /// The dot product.
    #[inline]
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The cross product `self × other`.
    #[inline]
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Vector::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// The length.
    #[inline]
    pub fn length(self) -> R {
        self.dot(self).sqrt()
    }

    /// The vector over its own length; NaN for a zero vector.
    #[inline]
    #[must_use]
    pub fn unit(self) -> Self {
        self / self.length()
    }

    /// Componentwise, the smaller of two.
    #[inline]
    #[must_use]
    pub fn smaller(self, other: Self) -> Self {
        Vector::new(self.x.smaller(other.x), self.y.smaller(other.y), self.z.smaller(other.z))
    }

    /// Componentwise, the larger of two.
    #[inline]
    #[must_use]
    pub fn larger(self, other: Self) -> Self {
        Vector::new(self.x.larger(other.x), self.y.larger(other.y), self.z.larger(other.z))
    }

    /// The components in order.
    #[inline]
    pub fn components(self) -> [R; 3] {
        [self.x, self.y, self.z]
    }

    /// Whether no component is infinite or NaN.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
}

impl<R: Real> Add for Vector<R> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Vector::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<R: Real> Sub for Vector<R> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Vector::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<R: Real> Neg for Vector<R> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Vector::new(-self.x, -self.y, -self.z)
    }
}

impl<R: Real> Mul<R> for Vector<R> {
    type Output = Self;
    #[inline]
    fn mul(self, factor: R) -> Self {
        Vector::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl<R: Real> Div<R> for Vector<R> {
    type Output = Self;
    #[inline]
    fn div(self, divisor: R) -> Self {
        Vector::new(self.x / divisor, self.y / divisor, self.z / divisor)
    }
}
