//! Joint materials: what two surfaces do to each other.

use crate::number::Number;
use crate::simulation::ratio;

/// tan φ of an angle in degrees, below 90, as SPEC section 1 stores it: an f64, and exact from then on; 1 for 45.
pub fn tangent_of_degrees(degrees: &Number) -> Number {
    let tangent = match degrees.approximate() {
        45.0 => 1.0,
        degrees => libm::tan(degrees * (std::f64::consts::PI / 180.0)),
    };
    Number::from_f64(tangent).unwrap_or(Number::ZERO)
}

/// The properties of contacts, by the joint materials of both surfaces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Joints {
    /// Names of the joint materials; never empty, and [`crate::simulation::Body::joint`] is a place in it.
    pub names: Vec<String>,
    /// Pairs with properties of their own.
    pub pairs: Vec<JointPair>,
    /// Properties of all other pairs.
    pub other: JointProperties,
}

impl Default for Joints {
    /// One joint material, `joint`, with the default properties.
    fn default() -> Joints {
        Joints { names: vec!["joint".to_string()], pairs: Vec::new(), other: JointProperties::default() }
    }
}

impl Joints {
    /// The properties of a contact between two surfaces, in either order.
    pub fn between(&self, one: usize, other: usize) -> &JointProperties {
        let wanted = (one.min(other), one.max(other));
        let found = self.pairs.iter().find(|pair| (pair.one.min(pair.other), pair.one.max(pair.other)) == wanted);
        found.map_or(&self.other, |pair| &pair.properties)
    }

    /// All properties, those of named pairs first.
    pub fn all(&self) -> impl Iterator<Item = &JointProperties> {
        self.pairs.iter().map(|pair| &pair.properties).chain(std::iter::once(&self.other))
    }

    /// The same, to change them.
    pub fn all_mut(&mut self) -> impl Iterator<Item = &mut JointProperties> {
        self.pairs.iter_mut().map(|pair| &mut pair.properties).chain(std::iter::once(&mut self.other))
    }
}

/// Two joint materials and what happens between them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JointPair {
    /// A place in [`Joints::names`].
    pub one: usize,
    /// A place in [`Joints::names`]; may be the same.
    pub other: usize,
    /// What happens between them.
    pub properties: JointProperties,
}

/// What happens at a contact.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JointProperties {
    /// tan φ, 0 or more.
    pub friction: Number,
    /// Cohesion in Pa, on the contact's share of the area in which two faces overlap.
    pub cohesion: Number,
    /// Tensile strength in Pa, on the same area.
    pub tension: Number,
    /// p_n in N/m, of one contact; `None` until [`crate::simulation::derive_stiffness`] has chosen it.
    pub normal_stiffness: Option<Number>,
    /// p_s over p_n.
    pub shear_ratio: Number,
}

impl Default for JointProperties {
    /// tan φ = 3/5 (31°), no cohesion, no tension, a derived stiffness, p_s = 2/5·p_n.
    fn default() -> JointProperties {
        JointProperties {
            friction: ratio(3, 5),
            cohesion: Number::ZERO,
            tension: Number::ZERO,
            normal_stiffness: None,
            shear_ratio: ratio(2, 5),
        }
    }
}
