//! What blocks and contacts are made of, in the stepper's precision.

use crate::dynamics::setup::{SetupError, near};
use crate::real::Real;
use rockproof_model::Number;
use rockproof_model::simulation::{JointProperties, Material};

/// An isotropic elastic material: Hooke's law with two numbers for the normal and one for the shear strains.
#[derive(Clone, Copy, Debug)]
pub(super) struct Elastic<R> {
    /// ρ in kg/m³.
    pub(super) density: R,
    /// Stress along a strain of the same axis: E(1−ν)/((1+ν)(1−2ν)), in Pa.
    along: R,
    /// Stress across it: Eν/((1+ν)(1−2ν)), in Pa.
    across: R,
    /// Shear modulus E/(2(1+ν)) in Pa.
    shear: R,
    young: R,
    poisson: R,
}

impl<R: Real> Elastic<R> {
    pub(super) fn new(material: &Material) -> Result<Elastic<R>, SetupError> {
        let density = near("density", &material.density)?;
        let young: R = near("young", &material.young)?;
        let poisson: R = near("poisson", &material.poisson)?;
        let (one, two) = (R::from_f64(1.0), R::from_f64(2.0));
        let scale = young / ((one + poisson) * (one - two * poisson));
        let shear = young / (two * (one + poisson));
        let across = scale * poisson;
        Ok(Elastic { density, along: scale * (one - poisson), across, shear, young, poisson })
    }

    /// The stiffness of strain `i` of six against strain `k`, in Pa.
    pub(super) fn stiffness(&self, i: usize, k: usize) -> R {
        match (i < 3, k < 3, i == k) {
            (true, true, true) => self.along,
            (true, true, false) => self.across,
            (false, false, true) => self.shear,
            _ => R::ZERO,
        }
    }

    /// The stress of six strains, in Pa.
    pub(super) fn stress(&self, strain: &[R]) -> [R; 6] {
        std::array::from_fn(|i| {
            (0..6).fold(R::ZERO, |sum, k| match (i < 3) == (k < 3) && (i < 3 || i == k) {
                true => sum + self.stiffness(i, k) * strain[k],
                false => sum,
            })
        })
    }

    /// Elastic energy per volume of a stress, in J/m³: ½ σᵀE⁻¹σ.
    pub(super) fn energy(&self, stress: &[R; 6]) -> R {
        let [x, y, z, yz, zx, xy] = *stress;
        let (half, two) = (R::from_f64(0.5), R::from_f64(2.0));
        let normal = x * x + y * y + z * z - two * self.poisson * (x * y + y * z + z * x);
        half * (normal / self.young + (yz * yz + zx * zx + xy * xy) / self.shear)
    }
}

/// What happens between two surfaces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joint<R> {
    /// tan φ.
    pub(super) friction: R,
    /// In Pa.
    pub(super) cohesion: R,
    /// In Pa.
    pub(super) tension: R,
    /// p_n in N/m.
    pub(super) normal: R,
    /// p_s in N/m.
    pub(super) shear: R,
}

/// What each contact needs of its joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointSprings<R> {
    /// tan φ.
    pub(super) friction: R,
    /// p_n in N/m.
    pub(super) normal: R,
    /// p_s in N/m.
    pub(super) shear: R,
}

impl<R: Real> Joint<R> {
    pub(super) fn springs(&self) -> JointSprings<R> {
        let Joint { friction, normal, shear, .. } = *self;
        JointSprings { friction, normal, shear }
    }

    pub(super) fn new(properties: &JointProperties) -> Result<Joint<R>, SetupError> {
        let stiffness = properties.normal_stiffness.as_ref().ok_or(SetupError::NoStiffness)?;
        let shear = Number::from_rational(stiffness.to_rational() * properties.shear_ratio.to_rational());
        Ok(Joint {
            friction: near("friction", &properties.friction)?,
            cohesion: near("cohesion", &properties.cohesion)?,
            tension: near("tension", &properties.tension)?,
            normal: near("normal_stiffness", stiffness)?,
            shear: near("shear_stiffness", &shear)?,
        })
    }

    /// Whether the area of a contact matters.
    pub(super) fn needs_area(&self) -> bool {
        R::ZERO.below(self.cohesion) || R::ZERO.below(self.tension)
    }
}
