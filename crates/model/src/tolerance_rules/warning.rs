//! Warnings beside the rules of SPEC section 3: tolerances of modes that keep contacts from closing or opening or let them pull, and weights and loads that contacts or blocks cannot bear.

use super::RequiredValue;
use super::column::ColumnSource;
use super::hanging::hanging;
use super::load::load;
use super::pressing::{left_out, worst};
use super::properties::{density, friction};
use super::pull::pull;
use super::speed::speed;
use super::strain::strain;
use crate::number::Number;
use crate::scene::Scene;
use crate::tolerance::ToleranceSet;
use std::cmp::Ordering;

/// What a warning is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WarningKind {
    /// `close` is more than `penetration`.
    Close,
    /// `open` is more than `search`.
    Open,
    /// `equal` is 1 or more.
    Equal,
    /// Closed contacts may pull a block as much as it weighs before they open.
    Pull,
    /// A block at rest would sink under the blocks above it or under loads deeper than `penetration`.
    Load,
    /// Loads press along more directions of faces than were looked along.
    Loads,
    /// A deformable block would be strained by more than a hundredth by what it bears, or by its initial stress.
    Strain,
    /// A block that the scene sets in motion would be stopped deeper than `penetration`.
    Speed,
    /// A block's fixed points alone hold it, and it would move by more than half of its smallest side before they do.
    Hanging,
    /// A friction of more than 5.
    Friction,
    /// A density outside 100 to 10,000 kg/m³.
    Density,
}

impl WarningKind {
    /// The name in files and lines.
    pub fn name(self) -> &'static str {
        match self {
            WarningKind::Close => "close",
            WarningKind::Open => "open",
            WarningKind::Equal => "equal",
            WarningKind::Pull => "pull",
            WarningKind::Load => "load",
            WarningKind::Loads => "loads",
            WarningKind::Strain => "strain",
            WarningKind::Speed => "speed",
            WarningKind::Hanging => "hanging",
            WarningKind::Friction => "friction",
            WarningKind::Density => "density",
        }
    }

    /// What goes wrong.
    pub fn title(self) -> &'static str {
        match self {
            WarningKind::Close => "open contacts may never close",
            WarningKind::Open => "closed contacts may be lost before they open",
            WarningKind::Equal => "contacts may keep their mode however far blocks move",
            WarningKind::Pull => {
                "a block may hang or stick, since closed contacts pull as much as it weighs before they open"
            }
            WarningKind::Load => "a block may sink deeper than penetration under the blocks above it or under loads",
            WarningKind::Loads => "what loads press along faces was not looked at everywhere: there is too much of it",
            WarningKind::Strain => "a block may be squashed by its weight, by loads or by its initial stress",
            WarningKind::Speed => "a block that moves when time begins may be stopped only deeper than penetration",
            WarningKind::Hanging => "a block may fall, since its fixed points alone hold it and are too soft",
            WarningKind::Friction => "friction may be an angle: it is tan φ, and no rock has so much",
            WarningKind::Density => "a density may be in another unit: it is in kg/m³, and no rock has this one",
        }
    }

    /// What would be right.
    pub fn formula(self) -> &'static str {
        match self {
            WarningKind::Close => "close ≤ penetration",
            WarningKind::Open => "open ≤ search",
            WarningKind::Equal => "equal < 1",
            WarningKind::Pull => "normal_stiffness·(corners of its smallest face)·open < (weight of a block)",
            WarningKind::Load => {
                "(weight of a block, of those above it, and loads)/(normal_stiffness·corners of its smallest face) ≤ penetration"
            }
            WarningKind::Loads => "(directions of faces along which loads may press) ≤ (those looked along)",
            WarningKind::Strain => {
                "(weight of a block, of those above it, and loads)/(young·area of its plan) ≤ 1/100, and (strain of the initial stress) ≤ 1/100"
            }
            WarningKind::Speed => "(depth at which one contact stops the given motion of two blocks) ≤ penetration",
            WarningKind::Hanging => {
                "(weight of a block, of those above it, and loads)/(stiffness of its fixed points) ≤ (smallest side of the block)/2"
            }
            WarningKind::Friction => "friction ≤ 5",
            WarningKind::Density => "100 ≤ density ≤ 10,000 (kg/m³)",
        }
    }

    /// Why.
    pub fn reason(self) -> &'static str {
        match self {
            WarningKind::Close => {
                "an overlap deeper than penetration is no longer seen as a contact, and none is closed before it is deeper than close"
            }
            WarningKind::Open => {
                "a gap wider than search is no longer seen as a contact, and none is opened before it is wider than open"
            }
            WarningKind::Equal => "a contact's mode stays where its gap is no larger than equal times the gap before",
            WarningKind::Pull => {
                "a closed contact opens where its gap is wider than open, and its normal spring pulls until then; `auto` has a far smaller open in f64 than in f32"
            }
            WarningKind::Load => {
                "a block on its smallest face bears what stands above it, here each block above by the share of its plan that is over this one; a load presses along gravity, and on faces that something stands against; the depth is the static one, and a load that is laid on suddenly goes twice as deep"
            }
            WarningKind::Loads => {
                "with many loads on blocks whose faces lie in many directions the estimate would take too long; in directions left out a block may sink deeper than penetration"
            }
            WarningKind::Strain => {
                "strains are taken for small, and rock breaks long before: young is in Pa, so 50 GPa are 50e9"
            }
            WarningKind::Speed => {
                "d = W/(n·p) + √(2E/p), with p the normal stiffness, E the energy of the motion relative to the other block and of spins, and W the weight of the upper block, on the n corners of its smallest face; where contacts share E none is as deep"
            }
            WarningKind::Hanging => {
                "no other block stands against the force, so it is borne by springs of fixed points alone"
            }
            WarningKind::Friction => {
                "the friction of rock is below 2 (63°); 30° are `friction_angle = 30`, or friction = 0.577"
            }
            WarningKind::Density => {
                "rock has 1,500 to 3,500 kg/m³; in g/cm³, t/m³ or kN/m³ the same density is a far smaller number"
            }
        }
    }
}

/// Something that violates no rule of SPEC section 3 and yet lets blocks pass through one another. Of modes, numbers are within some ulps of the exact ones; of loads they are an estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// What it is about.
    pub kind: WarningKind,
    /// The block it is about, if it is one.
    pub block: Option<usize>,
    /// The left side of its formula.
    pub found: f64,
    /// The right side.
    pub allowed: f64,
    /// What would mend it.
    pub remedy: String,
}

/// The warnings of a set for a scene, in the order of [`WarningKind`]. Those of modes are compared exactly, **equal to a limit is within
/// it, but for `equal`, whose limit is not allowed**; loads are estimated.
pub fn warnings(set: &ToleranceSet, scene: &Scene) -> Vec<Warning> {
    let no_more = |kind: WarningKind, value: &Number, limit: &Number| {
        (value > limit).then(|| Warning {
            kind,
            block: None,
            found: value.approximate(),
            allowed: limit.approximate(),
            remedy: RequiredValue::OrLess(limit.to_rational()).text(kind.name()),
        })
    };
    let one = Number::from_integer(1);
    let equal = (set.equal.cmp(&one) != Ordering::Less).then(|| Warning {
        kind: WarningKind::Equal,
        block: None,
        found: set.equal.approximate(),
        allowed: 1.0,
        remedy: WarningKind::Equal.formula().to_owned(),
    });
    let modes = [
        no_more(WarningKind::Close, &set.close, &set.penetration),
        no_more(WarningKind::Open, &set.open, &set.search),
        equal,
    ];
    let source = ColumnSource::of(set, scene);
    let worst = worst(&source, set, scene);
    let borne = [
        load(set, scene, worst.sunk.as_ref()),
        left_out(&worst.effort),
        strain(scene, worst.squashed),
        speed(set, scene, &source),
    ];
    let pulled = [pull(set, scene, &source)];
    let given = [hanging(set, scene, &source), friction(scene), density(scene)];
    modes.into_iter().chain(pulled).chain(borne).chain(given).flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_warned_of_beyond_their_limits() {
        let n = |text: &str| Number::parse(text).unwrap();
        let set = |name: &str, value: &str| {
            let mut set = ToleranceSet { search: n("1/8"), penetration: n("1/16"), ..ToleranceSet::ZERO };
            let (_, number) = set.numbers_mut().into_iter().find(|(field, _)| *field == name).unwrap();
            *number = n(value);
            set
        };
        let kinds = |name, value| {
            let found = warnings(&set(name, value), &Scene::default());
            found.into_iter().map(|warning| warning.kind).collect::<Vec<_>>()
        };
        // At a limit a contact still closes, or opens; equal to 1 no mode ever changes back.
        assert_eq!((kinds("close", "1/16"), kinds("open", "1/8")), (vec![], vec![]));
        assert_eq!(kinds("close", "0.0625000000000000001"), [WarningKind::Close]);
        assert_eq!(kinds("open", "0.1250000000000000001"), [WarningKind::Open]);
        assert_eq!((kinds("equal", "0.9999999999999999999"), kinds("equal", "1")), (vec![], vec![WarningKind::Equal]));
    }
}
