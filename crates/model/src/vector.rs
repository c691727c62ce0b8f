//! Three-vectors over any [`Ring`].
//!
//! Everything is inlined by force: a predicate evaluated in f64 costs some ten operations, and a call each for its dot
//! and cross products would double that.

use crate::ring::Ring;

/// A vector or point of three components.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Vec3<T> {
    /// Component along x.
    pub x: T,
    /// Component along y.
    pub y: T,
    /// Component along z.
    pub z: T,
}

impl<T> Vec3<T> {
    /// The vector of three components.
    #[inline]
    pub fn new(x: T, y: T, z: T) -> Self {
        Vec3 { x, y, z }
    }

    /// The three components in order.
    #[inline]
    pub fn components(&self) -> [&T; 3] {
        [&self.x, &self.y, &self.z]
    }

    /// The vector with `f` applied to each component.
    #[inline]
    pub fn map<U>(&self, mut f: impl FnMut(&T) -> U) -> Vec3<U> {
        Vec3 { x: f(&self.x), y: f(&self.y), z: f(&self.z) }
    }
}

impl<T: Ring> Vec3<T> {
    /// The zero vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Vec3::new(T::from_i32(0), T::from_i32(0), T::from_i32(0))
    }

    /// `self + other`.
    #[inline(always)]
    pub fn plus(&self, other: &Self) -> Self {
        Vec3::new(self.x.plus(&other.x), self.y.plus(&other.y), self.z.plus(&other.z))
    }

    /// `self − other`.
    #[inline(always)]
    pub fn minus(&self, other: &Self) -> Self {
        Vec3::new(self.x.minus(&other.x), self.y.minus(&other.y), self.z.minus(&other.z))
    }

    /// `−self`.
    #[inline(always)]
    pub fn negated(&self) -> Self {
        self.map(T::negated)
    }

    /// `factor · self`.
    #[inline(always)]
    pub fn scaled(&self, factor: &T) -> Self {
        self.map(|c| c.times(factor))
    }

    /// The dot product.
    #[inline(always)]
    pub fn dot(&self, other: &Self) -> T {
        self.x.times(&other.x).plus(&self.y.times(&other.y)).plus(&self.z.times(&other.z))
    }

    /// The cross product `self × other`.
    #[inline(always)]
    pub fn cross(&self, other: &Self) -> Self {
        Vec3::new(
            self.y.times(&other.z).minus(&self.z.times(&other.y)),
            self.z.times(&other.x).minus(&self.x.times(&other.z)),
            self.x.times(&other.y).minus(&self.y.times(&other.x)),
        )
    }

    /// The squared length `|self|²`.
    #[inline(always)]
    pub fn norm_squared(&self) -> T {
        self.x.squared().plus(&self.y.squared()).plus(&self.z.squared())
    }
}
