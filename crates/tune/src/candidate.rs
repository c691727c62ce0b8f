//! Tolerance sets as a few small numbers, so that they can be drawn and changed.

use rockproof_model::preset::{self, Preset, sine_of_degrees};
use rockproof_model::{Block, Criteria, Number, Precision, PresetError, ToleranceSet};
use rockproof_pairs::families::PairSampler;
use serde::{Deserialize, Serialize};

/// The lengths of a model that tolerance sets are made of (m).
#[derive(Clone, Copy, Debug)]
pub struct ModelLengths {
    /// ℓ
    shortest_edge: f64,
    /// H
    half_side: f64,
    /// R
    radius: f64,
    /// `max_displacement` of `auto`
    displacement: f64,
    /// L
    longest_edge: f64,
    /// M
    coordinate: f64,
    /// eps of the precision in use
    eps: f64,
}

impl ModelLengths {
    /// Measures the blocks.
    ///
    /// # Errors
    /// When `auto` cannot be derived from them.
    pub fn of(blocks: &[&Block], precision: Precision) -> Result<ModelLengths, PresetError> {
        let auto = preset::derive(Preset::Auto, blocks, precision)?;
        let [displacement, penetration, rotation] =
            [&auto.max_displacement, &auto.penetration, &auto.max_rotation].map(Number::approximate);
        let edges = |block: &Block, fold: fn(f64, f64) -> f64, first: f64| {
            let squared = |e: &rockproof_model::topology::Edge| {
                let [p, q] = [e.p, e.q].map(|v| block.vertices()[v.index()].map(Number::approximate));
                [q.x - p.x, q.y - p.y, q.z - p.z].iter().map(|c| c * c).sum::<f64>()
            };
            block.topology().edges().iter().map(squared).fold(first, fold)
        };
        let least = blocks.iter().map(|b| edges(b, f64::min, f64::INFINITY)).fold(f64::INFINITY, f64::min);
        let greatest = blocks.iter().map(|b| edges(b, f64::max, 0.0)).fold(0.0, f64::max);
        let (shortest_edge, longest_edge) = (least.sqrt(), greatest.sqrt());
        let coordinate = blocks.iter().flat_map(|b| b.coordinates()).map(|c| c.approximate().abs()).fold(0.0, f64::max);
        let eps = precision.epsilon();
        // `auto` has ω² = 2g/R and εo = 2¹⁰·eps·H.
        let (radius, half_side) = (2.0 * penetration / (rotation * rotation), auto.open.approximate() / (1024.0 * eps));
        Ok(ModelLengths { shortest_edge, half_side, radius, displacement, longest_edge, coordinate, eps })
    }
}

impl ModelLengths {
    /// A set with as little changed as the rules of SPEC section 3 ask for; `max_displacement` gives way to `search` and `penetration`.
    pub fn repaired(&self, set: &ToleranceSet) -> ToleranceSet {
        let mut repaired = set.clone();
        let (quarter, resolved) = (self.shortest_edge / 4.0, self.resolved_territory());
        if set.search.approximate() < resolved && resolved <= quarter {
            repaired.search = number(digits(resolved, true));
        }
        let [search, penetration] = [&repaired.search, &repaired.penetration].map(Number::approximate);
        lower(&mut repaired.max_displacement, quarter.min(search / 2.0).min(penetration));
        lower(&mut repaired.territory, quarter.min(search));
        if repaired.territory.approximate() < resolved {
            repaired.territory = number(digits(resolved, true));
        }
        lower(&mut repaired.max_rotation, (2.0 * penetration / self.radius).sqrt());
        if set.criteria == Criteria::Classic {
            lower(&mut repaired.parallel_sine, repaired.territory.approximate() / self.longest_edge);
            lower(&mut repaired.overlap_sine, penetration / self.longest_edge);
        }
        repaired
    }

    /// A set with what docs/rules_of_thumb.md proposes: the revised criteria, an overlap angle of a quarter of a degree, no parallel angle,
    /// and, if `territory`, twice the least territory that rounding does not decide.
    pub fn by_rules_of_thumb(&self, set: &ToleranceSet, territory: bool) -> ToleranceSet {
        let mut proposed = ToleranceSet {
            overlap_sine: number(sine_of_degrees(0.25)),
            parallel_sine: Number::ZERO,
            criteria: Criteria::Revised,
            ..set.clone()
        };
        if territory {
            let least = digits(2.0 * self.resolved_territory(), true);
            proposed.territory = number(least.min(BELOW * (self.shortest_edge / 4.0).min(set.search.approximate())));
        }
        proposed
    }

    /// The least territory that SPEC section 3 allows.
    fn resolved_territory(&self) -> f64 {
        256.0 * self.eps * self.coordinate
    }
}

/// Lowers a tolerance to a limit, to three digits below it; what is below stays as it is.
fn lower(tolerance: &mut Number, limit: f64) {
    if tolerance.approximate() > limit {
        *tolerance = number(digits(limit * BELOW, false));
    }
}

/// So little below 1 that no one minds, and more than an exact number and the f64 nearest to it are apart.
const BELOW: f64 = 1.0 - 1.0 / 1_099_511_627_776.0;

fn number(value: f64) -> Number {
    Number::from_f64(value).unwrap_or(Number::ZERO)
}

/// A tolerance set as places on scales of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "[i32; 9]", into = "[i32; 9]")]
pub struct SetParameters([i32; 9]);

/// A place that is not on its scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("place {place} is not on scale {scale} of a tolerance set")]
pub struct PlaceFault {
    scale: usize,
    place: i32,
}

impl TryFrom<[i32; 9]> for SetParameters {
    type Error = PlaceFault;

    fn try_from(places: [i32; 9]) -> Result<SetParameters, PlaceFault> {
        let off = (0..places.len()).find(|&k| !(FIRST[k]..=LAST[k]).contains(&places[k]));
        off.map_or(Ok(SetParameters(places)), |scale| Err(PlaceFault { scale, place: places[scale] }))
    }
}

impl From<SetParameters> for [i32; 9] {
    fn from(parameters: SetParameters) -> [i32; 9] {
        parameters.0
    }
}

/// The angles that are tried (degrees).
const ANGLES: [f64; 11] = [0.0, 0.125, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0];

/// ε in powers of two of eps; the first stands for 0.
const EQUAL: [i32; 8] = [0, 2, 4, 6, 8, 10, 14, 18];

/// The last place on each scale: `max_displacement` below a quarter of the shortest edge, `search` and `penetration` over it,
/// `territory` below its limit, both angles, ε, `max_rotation` below its limit, criteria.
const LAST: [i32; 9] = [40, 12, 12, 24, 10, 10, 7, 8, 1];

/// The first place on each scale: an overlap angle of 0 loses contacts (docs/rules_of_thumb.md), and what is not found cannot differ.
const FIRST: [i32; 9] = [0, 0, 0, 0, 1, 0, 0, 0, 0];

impl SetParameters {
    /// Anything.
    pub fn random(sampler: &mut PairSampler<'_>) -> SetParameters {
        SetParameters(std::array::from_fn(|k| sampler.between(FIRST[k].into(), LAST[k].into()) as i32))
    }

    /// The places, apart by spaces.
    pub fn text(self) -> String {
        self.0.map(|place| place.to_string()).join(" ")
    }

    /// One to three parameters changed by one to four places.
    #[must_use]
    pub fn mutated(&self, sampler: &mut PairSampler<'_>) -> SetParameters {
        let mut places = self.0;
        for _ in 0..sampler.between(1, 3) {
            let k = sampler.below(places.len() as u64) as usize;
            let by = sampler.between(1, 4) * sampler.sign();
            places[k] = (places[k] + by as i32).clamp(FIRST[k], LAST[k]);
        }
        SetParameters(places)
    }

    /// The place nearest to a set.
    pub fn nearest(set: &ToleranceSet, model: &ModelLengths) -> SetParameters {
        let [search, territory, penetration, displacement, rotation] =
            [&set.search, &set.territory, &set.penetration, &set.max_displacement, &set.max_rotation]
                .map(Number::approximate);
        let quarter = model.shortest_edge / 4.0;
        // The place whose power is the least times off. Zero is at the end of its scale.
        let place = |from: f64, to: f64, last: i32| {
            let off = |place: i32| {
                let share = from * quarter_power(place) / to;
                share.max(1.0 / share)
            };
            (0..=last).min_by(|&i, &j| off(i).total_cmp(&off(j))).filter(|_| from > 0.0 && to > 0.0).unwrap_or(last)
        };
        let angle = |sine: &Number| {
            let off = |degrees: f64| (sine_of_degrees(degrees) - sine.approximate()).abs();
            (0..ANGLES.len()).min_by(|&i, &j| off(ANGLES[i]).total_cmp(&off(ANGLES[j]))).unwrap_or(0) as i32
        };
        let equal = match set.equal.is_zero() {
            true => 0,
            false => {
                let off = |k: usize| {
                    let share = set.equal.approximate() / (model.eps * quarter_power(4 * EQUAL[k]));
                    share.max(1.0 / share)
                };
                (1..EQUAL.len()).min_by(|&i, &j| off(i).total_cmp(&off(j))).unwrap_or(0) as i32
            }
        };
        SetParameters([
            place(displacement, quarter, LAST[0]),
            place(2.0 * displacement, search, LAST[1]),
            place(displacement, penetration, LAST[2]),
            place(territory, quarter.min(search), LAST[3]),
            angle(&set.overlap_sine).max(FIRST[4]),
            angle(&set.parallel_sine),
            equal,
            place(rotation, (2.0 * penetration / model.radius).sqrt(), LAST[7]),
            i32::from(set.criteria == Criteria::Classic),
        ])
    }

    /// The set for a model: every value an f64 of three digits. Lengths: u from ℓ/4 down in steps of 2^¼ but not below a quarter of `auto`'s, s
    /// from 2u up, g from u up, r from its limit down.
    pub fn set(&self, model: &ModelLengths) -> ToleranceSet {
        let [u, s, g, r, overlap, parallel, equal, rotation, criteria] = self.0;
        let quarter = model.shortest_edge / 4.0;
        let displacement = digits((quarter * quarter_power(-u)).max(model.displacement / 4.0).min(quarter), false);
        let search = digits(2.0 * displacement * quarter_power(s), true);
        let penetration = digits(displacement * quarter_power(g), true);
        let equal = match EQUAL[equal as usize] {
            0 => 0.0,
            power => model.eps * quarter_power(4 * power),
        };
        let contact = digits(equal.max(model.eps) * model.half_side, true);
        let largest_rotation = (2.0 * penetration / model.radius).sqrt();
        ToleranceSet {
            search: number(search),
            territory: number(digits(quarter.min(search) * quarter_power(-r), false)),
            penetration: number(penetration),
            overlap_sine: number(sine_of_degrees(ANGLES[overlap as usize])),
            parallel_sine: number(sine_of_degrees(ANGLES[parallel as usize])),
            equal: number(equal),
            open: number(contact),
            close: number(contact),
            max_displacement: number(displacement),
            max_rotation: number(digits(largest_rotation * quarter_power(-rotation), false)),
            criteria: if criteria == 0 { Criteria::Revised } else { Criteria::Classic },
        }
    }
}

/// `2^(k/4)`, the same on every machine.
fn quarter_power(k: i32) -> f64 {
    const ROOTS: [f64; 4] = [1.0, 1.189_207_115_002_721, std::f64::consts::SQRT_2, 1.681_792_830_507_429];
    ROOTS[k.rem_euclid(4) as usize] * 2f64.powi(k.div_euclid(4))
}

/// Three digits, above `value` or below it: what people paste is short.
fn digits(value: f64, up: bool) -> f64 {
    let near: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if near == value || (near > value) == up {
        return near;
    }
    let exponent: i32 = format!("{value:.2e}").split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    let unit = format!("1e{}", exponent - 2).parse().unwrap_or(0.0);
    let moved = if up { near + unit } else { near - unit };
    format!("{moved:.2e}").parse().unwrap_or(moved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rockproof_model::tolerance_rules;

    #[test]
    fn three_digits_stay_on_their_side() {
        for value in [1.0, 0.123_456, 9.999, 1e-9, 0.062_5, 2.5e-7] {
            let (down, up) = (digits(value, false), digits(value, true));
            assert!(down <= value && value <= up && up - down <= 0.011 * value, "{down} {value} {up}");
        }
        assert_eq!((digits(9.999, true), digits(0.1, false)), (10.0, 0.1));
    }

    #[test]
    fn drawn_sets_keep_the_rules_between_lengths() {
        let whole = Number::from_integer;
        let corner = |x, y, z| rockproof_model::Vec3::new(whole(x), whole(y), whole(z));
        let block = Block::cuboid(&corner(0, 0, 0), &corner(1, 2, 3)).expect("a box");
        let model = ModelLengths::of(&[&block], Precision::F64).expect("lengths");
        assert!(
            (model.shortest_edge, model.half_side) == (1.0, 1.5) && (model.radius - 14f64.sqrt() / 2.0).abs() < 1e-4
        );
        let mut rng = ChaCha8Rng::from_seed([3; 32]);
        let mut sampler = PairSampler::with_style(&mut rng, rockproof_pairs::families::CoordinateStyle::Grid);
        for _ in 0..200 {
            let parameters = SetParameters::random(&mut sampler).mutated(&mut sampler);
            let broken = tolerance_rules::check(&parameters.set(&model), &[&block], Precision::F64);
            let near = SetParameters::nearest(&parameters.set(&model), &model);
            assert_eq!(SetParameters::nearest(&near.set(&model), &model), near, "{parameters:?}");
            // Only what angles have to do with lengths under the classic criteria is left to chance.
            let chance = |v: &tolerance_rules::Violation| {
                matches!(v.rule, tolerance_rules::Rule::ParallelEdges | tolerance_rules::Rule::Overlap)
            };
            assert!(broken.iter().all(chance), "{parameters:?}: {broken:?}");
        }
    }
}
