//! Where a campaign's tolerance sets come from: presets derived from each pair, sets given by the user, and sets of
//! few binary digits, with which ties survive in every number format.

use crate::directed::f64_view::{length, minus};
use crate::shapes::lattice_solid::number_of;
use rockproof_differential::subject::NamedSet;
use rockproof_model::number::{power_of_two, split_f64};
use rockproof_model::preset::{self, Preset};
use rockproof_model::{Block, Criteria, Number, Precision, ToleranceSet, ToleranceSpec};
use std::fmt;
use std::sync::Arc;

/// The sets known by name: the presets, which a user would take; five of few binary digits, with which ties survive in
/// every number format and which reach what the presets cannot: [`dyadic`] under either criteria, [`coarse`], [`bare`],
/// [`deep`]; and [`fractional`], whose ties no number format holds.
pub const NAMES: [&str; 9] =
    ["auto", "shi", "zero", "dyadic", "dyadic-classic", "dyadic-coarse", "dyadic-bare", "dyadic-deep", "fractional"];

type Derive = dyn Fn(&Block, &Block, Precision) -> Option<ToleranceSet> + Send + Sync;

/// A named way to a tolerance set for a pair of blocks.
#[derive(Clone)]
pub struct SetSource {
    name: Arc<str>,
    derive: Arc<Derive>,
}

impl fmt::Debug for SetSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("SetSource").field(&self.name).finish()
    }
}

impl SetSource {
    /// A source that derives a set from the pair, for engines of the given precision. It may decline.
    pub fn new(
        name: impl Into<Arc<str>>,
        derive: impl Fn(&Block, &Block, Precision) -> Option<ToleranceSet> + Send + Sync + 'static,
    ) -> SetSource {
        SetSource { name: name.into(), derive: Arc::new(derive) }
    }

    /// The same set for every pair.
    pub fn constant(name: impl Into<Arc<str>>, set: ToleranceSet) -> SetSource {
        SetSource::new(name, move |_, _, _| Some(set.clone()))
    }

    /// What a preset derives from the pair, whether or not the rules of SPEC section 3 hold there.
    pub fn preset(preset: Preset) -> SetSource {
        SetSource::new(preset.name(), move |a, b, precision| preset::derive(preset, &[a, b], precision).ok())
    }

    /// The set of [`dyadic`]: `dyadic` or `dyadic-classic`.
    pub fn dyadic(criteria: Criteria) -> SetSource {
        let name = if criteria == Criteria::Revised { "dyadic" } else { "dyadic-classic" };
        SetSource::new(name, move |a, b, _| Some(dyadic(a, b, criteria)))
    }

    /// The source of one of [`NAMES`], or of one with values changed: `auto@territory*1/2`, `shi@criteria=revised@overlap_angle=5`. After each `@` a
    /// tolerance is multiplied, or set as on the command line; numbers are exact.
    pub fn named(name: &str) -> Option<SetSource> {
        if let Some((base, changes)) = name.split_once('@') {
            let base = SetSource::named(base)?;
            let changes = changes.split('@').map(ToleranceOverride::parse).collect::<Option<Vec<_>>>()?;
            return Some(SetSource::new(name, move |a, b, precision| {
                let set = (base.derive)(a, b, precision)?;
                Some(changes.iter().fold(set, |set, change| change.apply(set)))
            }));
        }
        if let Some(preset) = Preset::from_name(name) {
            return Some(SetSource::preset(preset));
        }
        match name {
            "dyadic" => Some(SetSource::dyadic(Criteria::Revised)),
            "dyadic-classic" => Some(SetSource::dyadic(Criteria::Classic)),
            "dyadic-coarse" => Some(SetSource::new(name, |a, b, _| Some(coarse(a, b)))),
            "dyadic-bare" => Some(SetSource::new(name, |a, b, _| Some(bare(a, b)))),
            "dyadic-deep" => Some(SetSource::new(name, |a, b, _| Some(deep(a, b)))),
            "fractional" => Some(SetSource::new(name, |a, b, _| Some(fractional(a, b)))),
            _ => None,
        }
    }

    /// The source's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The sets for a pair. Where the source declines for f32, engines in f32 get the set for f64; `None` where it
    /// declines for f64 as well.
    pub fn derive(&self, a: &Block, b: &Block) -> Option<NamedSet> {
        let f64 = (self.derive)(a, b, Precision::F64)?;
        let f32 = (self.derive)(a, b, Precision::F32).unwrap_or_else(|| f64.clone());
        Some(NamedSet { name: self.name.clone(), f32, f64 })
    }
}

/// One change of a set.
enum ToleranceOverride {
    /// A tolerance multiplied.
    Times(&'static str, Number),
    /// A tolerance set to a value.
    Number(&'static str, Number),
    /// Other criteria.
    Criteria(Criteria),
}

impl ToleranceOverride {
    /// `NAME*FACTOR` or `NAME=VALUE`.
    fn parse(text: &str) -> Option<ToleranceOverride> {
        let mut spec = ToleranceSpec::empty();
        if let Some((name, factor)) = text.split_once('*') {
            spec.set_text(name, "0").ok()?;
            let factor = Number::parse(factor).ok().filter(|factor| !factor.is_negative())?;
            return spec.numbers().first().map(|(name, _)| ToleranceOverride::Times(name, factor));
        }
        spec.assign(text).ok()?;
        let number = spec.numbers().first().map(|(name, number)| ToleranceOverride::Number(name, number.clone()));
        number.or(spec.criteria().map(ToleranceOverride::Criteria))
    }

    fn apply(&self, mut set: ToleranceSet) -> ToleranceSet {
        match self {
            ToleranceOverride::Criteria(criteria) => set.criteria = *criteria,
            ToleranceOverride::Times(changed, by) | ToleranceOverride::Number(changed, by) => {
                for (name, number) in set.numbers_mut() {
                    if name == *changed {
                        *number =
                            if matches!(self, ToleranceOverride::Times(..)) { number.times(by) } else { by.clone() };
                    }
                }
            }
        }
        set
    }
}

/// A set like `auto`'s, of numbers with one or two binary digits: lengths are powers of two below those of `auto`,
/// both sines 3/64, ε 2⁻¹³.
pub fn dyadic(a: &Block, b: &Block, criteria: Criteria) -> ToleranceSet {
    let ((edge_a, side_a), (edge_b, side_b)) = (size(a), size(b));
    let half = side_a.max(side_b) / 2.0;
    let u = binary_below((edge_a.min(edge_b) / 16.0).min(half / 100.0));
    let equal = power_of_two(-13);
    let contact = number(equal * binary_below(half));
    ToleranceSet {
        search: number(2.0 * u),
        territory: number(u / 2.0),
        penetration: number(u),
        overlap_sine: number(3.0 / 64.0),
        parallel_sine: number(3.0 / 64.0),
        equal: number(equal),
        open: contact.clone(),
        close: contact,
        max_displacement: number(u),
        max_rotation: number(binary_below((u / half).sqrt())),
        criteria,
    }
}

/// [`dyadic`] with lengths as large as the shortest edge, beyond what the rules of SPEC section 3 allow: the territories
/// are bounded by λ·edge and λ·width, edges are nearly parallel by their length, and slabs may overlap right through.
pub fn coarse(a: &Block, b: &Block) -> ToleranceSet {
    let short = binary_below(size(a).0.min(size(b).0));
    ToleranceSet {
        search: number(2.0 * short),
        territory: number(short),
        penetration: number(2.0 * short),
        ..dyadic(a, b, Criteria::Revised)
    }
}

/// [`dyadic`] under the classic criteria with both sines and ε 0: aligned blocks tie at the angles themselves.
pub fn bare(a: &Block, b: &Block) -> ToleranceSet {
    let none = || Number::ZERO;
    ToleranceSet { overlap_sine: none(), parallel_sine: none(), equal: none(), ..dyadic(a, b, Criteria::Classic) }
}

/// [`dyadic`] with g > s, as the rules of SPEC section 3 allow: overlaps as deep as the shortest edge are recorded, and of
/// the two measures of a dip the angle decides.
pub fn deep(a: &Block, b: &Block) -> ToleranceSet {
    let short = binary_below(size(a).0.min(size(b).0));
    ToleranceSet { penetration: number(short), ..dyadic(a, b, Criteria::Revised) }
}

/// [`dyadic`] in thirds and tenths: s = 7/3 u, r = 2/3 u, g = 13/10 u, sines of 1/20 and 1/30, ε = 10⁻⁴.
pub fn fractional(a: &Block, b: &Block) -> ToleranceSet {
    let set = dyadic(a, b, Criteria::Revised);
    let share = |numerator: i128, denominator: i128| number_of(numerator, denominator, 0);
    let length = |numerator: i128, denominator: i128| set.max_displacement.times(&share(numerator, denominator));
    ToleranceSet {
        search: length(7, 3),
        territory: length(2, 3),
        penetration: length(13, 10),
        overlap_sine: share(1, 20),
        parallel_sine: share(1, 30),
        equal: share(1, 10_000),
        ..set
    }
}

/// A set with lengths and the overlap angle so large that of the measures of a dip the length alone decides: s and g at
/// least 16 and one times the shortest edge, overlap angle arcsin 63/64. Dips of few binary digits are rarely shallow
/// enough for other sets.
pub fn steep(set: &NamedSet, a: &Block, b: &Block) -> NamedSet {
    let short = binary_below(size(a).0.min(size(b).0));
    let widened = |set: &ToleranceSet| ToleranceSet {
        search: number(16.0 * short).max(set.search.clone()),
        penetration: number(short).max(set.penetration.clone()),
        overlap_sine: number(63.0 / 64.0),
        ..set.clone()
    };
    NamedSet { name: format!("{}-steep", set.name).into(), f32: widened(&set.f32), f64: widened(&set.f64) }
}

/// The block's shortest edge and longest box side (m).
pub fn size(block: &Block) -> (f64, f64) {
    let points: Vec<[f64; 3]> = block.vertices().iter().map(|v| v.components().map(|c| c.approximate())).collect();
    let edges = block.topology().edges().iter();
    let shortest = edges.map(|e| length(minus(points[e.q.index()], points[e.p.index()]))).fold(f64::INFINITY, f64::min);
    let side = |axis: usize| {
        let along = || points.iter().map(|p| p[axis]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    (shortest, (0..3).map(side).fold(0.0, f64::max))
}

pub(crate) fn number(value: f64) -> Number {
    Number::from_f64(value).unwrap_or(Number::ZERO)
}

/// The largest power of two that is at most `value`, which must be positive.
pub(crate) fn binary_below(value: f64) -> f64 {
    let (significand, exponent) = split_f64(value);
    power_of_two((exponent + 63 - significand.unsigned_abs().max(1).leading_zeros() as i32).clamp(-1000, 1000))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_has_a_source() {
        for name in NAMES {
            assert_eq!(SetSource::named(name).map(|s| s.name().to_owned()).as_deref(), Some(name));
        }
        assert!(SetSource::named("nothing").is_none());
    }

    #[test]
    fn deep_and_fractional_keep_the_order_of_lengths() {
        let whole = Number::from_integer;
        let block = Block::cuboid(
            &rockproof_model::Vec3::new(whole(0), whole(0), whole(0)),
            &rockproof_model::Vec3::new(whole(3), whole(1), whole(2)),
        )
        .unwrap();
        for (name, deeper) in [("dyadic-deep", true), ("fractional", false)] {
            let set = SetSource::named(name).unwrap().derive(&block, &block).unwrap().f64;
            let double = set.max_displacement.times(&whole(2));
            assert!(set.search >= double && set.penetration >= set.max_displacement, "{name}");
            assert!(set.territory <= set.search, "{name}");
            assert_eq!(set.penetration > set.search, deeper, "{name}");
            assert_eq!(set.search.as_f64().is_some(), deeper, "{name}");
        }
    }

    #[test]
    fn a_name_can_change_values() {
        let whole = Number::from_integer;
        let corner = |x| rockproof_model::Vec3::new(whole(x), whole(x), whole(x));
        let block = Block::cuboid(&corner(0), &corner(1)).unwrap();
        let derived = |name: &str| SetSource::named(name).unwrap().derive(&block, &block).unwrap();
        let (auto, changed) = (derived("auto").f64, derived("auto@territory*1/2@criteria=classic@overlap_angle=90"));
        assert_eq!(&*changed.name, "auto@territory*1/2@criteria=classic@overlap_angle=90");
        assert_eq!(changed.f64.territory.times(&whole(2)), auto.territory);
        assert_eq!((changed.f64.criteria, &changed.f64.overlap_sine), (Criteria::Classic, &whole(1)));
        assert_eq!(changed.f64.search, auto.search);
        for wrong in ["auto@", "auto@nothing=1", "auto@search", "nothing@search=1", "auto@search*-1", "auto@preset=shi"]
        {
            assert!(SetSource::named(wrong).is_none(), "{wrong}");
        }
    }

    #[test]
    fn binary_below_is_the_power_at_or_below() {
        for (value, below) in [(1.0, 1.0), (1.5, 1.0), (0.75, 0.5), (1023.0, 512.0), (2f64.powi(-70), 2f64.powi(-70))] {
            assert_eq!(binary_below(value), below);
        }
    }
}
