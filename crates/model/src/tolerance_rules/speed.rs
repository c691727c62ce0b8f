//! Whether blocks that the scene sets in motion are stopped before they are deeper in one another than `penetration`: an estimate, as [`fall`](super::fall()) is of heights.
// Longer than 400 lines: the estimate, which pairs can meet, and the tests of both.

use super::column::{ColumnSource, dot, gravity};
use super::shape::Shape;
use super::six_digits;
use super::warning::{Warning, WarningKind};
use crate::number::Number;
use crate::scene::{Scene, SceneBlock};
use crate::simulation::{smallest_face, spin_energy};
use crate::tolerance::ToleranceSet;
use crate::vector::Vec3;
use std::collections::BTreeMap;

/// Faces times vertices of two blocks up to which they are looked at along the normals of their faces.
const MAX_PROJECTIONS: usize = 1 << 16;

/// Velocities that are looked at together, and such ranges of them.
const RANGE: usize = 32;

/// The block whose given motion would carry it deepest into another one, if that is deeper than `penetration`; of equally deep pairs the first. `None` where `dynamic` is 0: then every step ends at rest.
///
/// Two blocks of masses m and M that move with v relative to one another and spin have no more than E = ½·μ·v² + (energies of both spins) to give to a contact between them, with μ = m·M/(m + M), m where the other one is fixed.
/// Weight is borne by all n contacts of the smallest face of the upper one and presses them W/(n·p) deep, as in the rule on the stiffness; about that rest springs are linear, and one of them that takes all of E goes √(2E/p) deeper.
/// Pairs that never meet are left out, as far as [`Limits::may_meet`] knows.
///
/// Costs a few operations for each pair that could be deeper than the deepest found so far, and for each block with a motion as many for each velocity of the scene that could make one so, and for each thousand of the others.
pub(super) fn speed(set: &ToleranceSet, scene: &Scene, source: &ColumnSource<'_>) -> Option<Warning> {
    let allowed = set.penetration.approximate();
    if allowed <= 0.0 || scene.simulation.control.dynamic == Number::ZERO || !scene.blocks.iter().any(moves) {
        return None;
    }
    let pull = gravity(scene).map_or([0.0; 3], |(down, pull)| down.map(|d| d * pull));
    let limits = Limits { pull, penetration: allowed, search: set.search.approximate() };
    let all: Vec<Moving<'_>> = (0..scene.blocks.len()).map(|block| Moving::of(scene, source, block, pull)).collect();
    let groups = by_velocity(&all);
    let each: Vec<Several<'_>> = groups.iter().map(|(bounds, _)| Several::alike(bounds)).collect();
    let ranges: Vec<Several<'_>> = each.chunks(RANGE).map(Several::around).collect();
    let wide: Vec<Several<'_>> = ranges.chunks(RANGE).map(Several::around).collect();
    let mut deepest: Option<(usize, Depth)> = None;
    let mut least = allowed;
    for (place, one) in all.iter().enumerate().filter(|(place, _)| moves(&scene.blocks[*place])) {
        for ((wide, ranges), groups) in wide.iter().zip(ranges.chunks(RANGE)).zip(groups.chunks(RANGE * RANGE)) {
            if !wide.may_be_deeper(one, least) {
                continue;
            }
            for (range, groups) in ranges.iter().zip(groups.chunks(RANGE)) {
                if !range.may_be_deeper(one, least) {
                    continue;
                }
                for (all_of_it, members) in groups {
                    let most = one.depth(all_of_it, one.resting.max(all_of_it.resting));
                    // Only a depth above the deepest so far counts, and none of the group is as deep as `most`.
                    let is_out = |along: usize| limits.keep_apart(unit(along), [one, all_of_it], true);
                    if most.is_none_or(|most| most.depth <= least) || (0..3).any(is_out) {
                        continue;
                    }
                    for &other in members {
                        if other == place || (other < place && moves(&scene.blocks[other])) {
                            continue;
                        }
                        let with = &all[other];
                        let Some(depth) = one.depth(with, one.resting_on(with)) else { continue };
                        if depth.depth > least && limits.may_meet([one, with]) {
                            (deepest, least) = (Some((place, depth)), depth.depth);
                        }
                    }
                }
            }
        }
    }
    let (block, Depth { depth, energy, resting, stiffness }) = deepest?;
    // Of p·g ≥ W/n + √(2·p·E) the root √p.
    let root = ((2.0 * energy).sqrt() + (2.0 * energy + 4.0 * allowed * resting).sqrt()) / (2.0 * allowed);
    // A stiffness that is derived may fall with a larger `penetration`, which then mends nothing.
    let deeper = ToleranceSet { penetration: Number::from_f64(depth).unwrap_or(Number::ZERO), ..set.clone() };
    let softest = ColumnSource::of(&deeper, scene).contacts[block] / smallest_face(&scene.blocks[block].block) as f64;
    let is_mended = depth.is_finite() && softest >= all[block].stiffness && all[block].stiffness >= stiffness;
    let stiffness = format!("normal_stiffness ≥ {}", six_digits(root * root, true, false));
    let penetration = is_mended.then(|| format!("penetration ≥ {}", six_digits(depth, true, false)));
    let remedy = [Some(stiffness), penetration].into_iter().flatten().collect::<Vec<_>>().join(" or ");
    Some(Warning { kind: WarningKind::Speed, block: Some(block), found: depth, allowed, remedy })
}

fn moves(one: &SceneBlock) -> bool {
    !(one.body.is_fixed() || is_zero(&one.body.velocity) && is_zero(&one.body.spin))
}

fn is_zero(vector: &Vec3<Number>) -> bool {
    vector.components().into_iter().all(|part| *part == Number::ZERO)
}

/// A block as it moves when time begins, or bounds of several with one velocity.
struct Moving<'s> {
    velocity: [f64; 3],
    /// Whether it, or one of several, is not fixed.
    can_move: bool,
    /// The energy of its spin (J); `None` without.
    spin: Option<f64>,
    /// 1/kg, 0 of a fixed one.
    inverse_mass: f64,
    /// What each corner of its smallest face bears of its weight (N).
    resting: f64,
    /// The softest normal stiffness that it can meet (N/m); NaN of a fixed one.
    stiffness: f64,
    /// How high its middle is, times gravity (m²/s²).
    height: f64,
    /// Its box; of a spinning one that of the ball about its centroid which it stays in.
    low: [f64; 3],
    high: [f64; 3],
    /// `None` of several.
    shape: Option<&'s Shape<'s>>,
}

/// How deep a pair goes, and by what.
#[derive(Clone, Copy)]
struct Depth {
    depth: f64,
    energy: f64,
    resting: f64,
    stiffness: f64,
}

impl<'s> Moving<'s> {
    fn of(scene: &Scene, source: &'s ColumnSource<'_>, block: usize, pull: [f64; 3]) -> Moving<'s> {
        let one = &scene.blocks[block];
        let mass = source.masses[block].filter(|_| !one.body.is_fixed());
        let corners = smallest_face(&one.block) as f64;
        let shape = &source.shapes()[block];
        let points = &shape.points;
        let spins = mass.is_some() && !is_zero(&one.body.spin);
        let end = |pick: fn(f64, f64) -> f64, from: f64| {
            points.iter().fold([from; 3], |ends, at| [0, 1, 2].map(|k| pick(ends[k], at[k])))
        };
        let (mut low, mut high) = (end(f64::min, f64::INFINITY), end(f64::max, f64::NEG_INFINITY));
        let middle: [f64; 3] = [0, 1, 2].map(|k| f64::midpoint(low[k], high[k]));
        if spins {
            let centroid = one.block.centroid().map(|c| Number::from_rational(c.clone()).approximate());
            let centroid = [centroid.x, centroid.y, centroid.z];
            let far = |at: &[f64; 3]| (0..3).map(|k| (at[k] - centroid[k]).powi(2)).sum::<f64>().sqrt();
            let radius = points.iter().map(far).fold(0.0, f64::max);
            (low, high) = (centroid.map(|c| c - radius), centroid.map(|c| c + radius));
        }
        // Negative zeros are zeros.
        let velocity = one.body.velocity.components().map(|part| part.approximate() + 0.0);
        Moving {
            velocity: if mass.is_some() { velocity } else { [0.0; 3] },
            can_move: mass.is_some(),
            spin: mass.filter(|_| spins).map(|mass| spin_energy(&one.block, &one.body, mass)),
            inverse_mass: mass.map_or(0.0, f64::recip),
            resting: mass.map_or(0.0, |mass| mass * dot(pull, pull).sqrt() / corners),
            stiffness: mass.map_or(f64::NAN, |_| source.contacts[block] / corners),
            height: -dot(middle, pull),
            low,
            high,
            shape: Some(shape),
        }
    }

    /// What weight presses a contact of the two with (N): that of the upper one, if it can move.
    fn resting_on(&self, other: &Moving<'_>) -> f64 {
        match self.height.total_cmp(&other.height) {
            std::cmp::Ordering::Less => other.resting,
            std::cmp::Ordering::Equal => 0.0,
            std::cmp::Ordering::Greater => self.resting,
        }
    }

    /// How deep one contact of the two goes; `None` where neither moves relative to the other, and where nothing is known of the stiffness. Infinite where f64 does not hold it.
    fn depth(&self, other: &Moving<'_>, resting: f64) -> Option<Depth> {
        self.depth_at(self.relative_to(other), other, resting)
    }

    /// The same where they move so relative to one another.
    fn depth_at(&self, relative: [f64; 3], other: &Moving<'_>, resting: f64) -> Option<Depth> {
        let stiffness = self.stiffness.max(other.stiffness);
        let spins = self.spin.is_some() || other.spin.is_some();
        if stiffness.is_nan() || (relative == [0.0; 3] && !spins) {
            return None;
        }
        let [along, turning] = [
            if relative == [0.0; 3] {
                0.0
            } else {
                dot(relative, relative) / (self.inverse_mass + other.inverse_mass) / 2.0
            },
            self.spin.unwrap_or(0.0) + other.spin.unwrap_or(0.0),
        ];
        let known = |value: f64| if value.is_nan() { f64::INFINITY } else { value };
        let energy = known(along + turning);
        let depth = known(resting / stiffness + (2.0 * energy / stiffness).sqrt());
        Some(Depth { depth, energy, resting, stiffness })
    }

    fn relative_to(&self, other: &Moving<'_>) -> [f64; 3] {
        [0, 1, 2].map(|k| self.velocity[k] - other.velocity[k])
    }

    /// Where it begins and ends along a unit vector.
    fn ends(&self, along: [f64; 3]) -> [f64; 2] {
        if self.spin.is_some() {
            let (middle, radius) =
                ([0, 1, 2].map(|k| f64::midpoint(self.low[k], self.high[k])), (self.high[0] - self.low[0]) / 2.0);
            return [dot(middle, along) - radius, dot(middle, along) + radius];
        }
        self.shape
            .map_or(&[][..], |shape| &shape.points)
            .iter()
            .map(|&at| dot(at, along))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
    }
}

/// The blocks by their velocities, each group with bounds of all in it.
fn by_velocity<'s>(all: &[Moving<'s>]) -> Vec<(Moving<'s>, Vec<usize>)> {
    let mut places: BTreeMap<[u64; 3], Vec<usize>> = BTreeMap::new();
    for (place, one) in all.iter().enumerate() {
        places.entry(one.velocity.map(f64::to_bits)).or_default().push(place);
    }
    let group = |members: Vec<usize>| {
        let each: Vec<&Moving<'_>> = members.iter().map(|&place| &all[place]).collect();
        (bounds_of(&each), members)
    };
    places.into_values().map(group).collect()
}

/// Bounds of several blocks, with the velocity of the first.
fn bounds_of<'s>(all: &[&Moving<'s>]) -> Moving<'s> {
    let each = || all.iter().copied();
    let most = |of: fn(&Moving<'_>) -> f64| each().map(of).fold(f64::NEG_INFINITY, f64::max);
    let least = |of: fn(&Moving<'_>) -> f64| each().map(of).fold(f64::INFINITY, f64::min);
    let spin = each().filter_map(|one| one.spin).max_by(f64::total_cmp);
    // A fixed one has no stiffness of its own, so that of the other one of a pair is a bound.
    let has_fixed = each().any(|one| one.stiffness.is_nan());
    Moving {
        velocity: all[0].velocity,
        can_move: each().any(|one| one.can_move),
        spin,
        inverse_mass: least(|one| one.inverse_mass),
        resting: most(|one| one.resting),
        stiffness: if has_fixed { f64::NAN } else { least(|one| one.stiffness) },
        height: 0.0,
        low: [0, 1, 2].map(|k| each().map(|one| one.low[k]).fold(f64::INFINITY, f64::min)),
        high: [0, 1, 2].map(|k| each().map(|one| one.high[k]).fold(f64::NEG_INFINITY, f64::max)),
        shape: None,
    }
}

/// Blocks of several velocities.
struct Several<'s> {
    bounds: Moving<'s>,
    /// The least and the greatest of their velocities along each axis.
    velocities: [[f64; 3]; 2],
}

impl<'s> Several<'s> {
    /// Those of one velocity.
    fn alike(bounds: &Moving<'s>) -> Several<'s> {
        Several { bounds: bounds_of(&[bounds]), velocities: [bounds.velocity; 2] }
    }

    fn around(all: &[Several<'s>]) -> Several<'s> {
        let each: Vec<&Moving<'_>> = all.iter().map(|one| &one.bounds).collect();
        let ends = |end: usize, pick: fn(f64, f64) -> f64| {
            let velocities = all.iter().map(|one| one.velocities[end]);
            velocities.reduce(|a, b| [0, 1, 2].map(|k| pick(a[k], b[k]))).unwrap_or_default()
        };
        Several { bounds: bounds_of(&each), velocities: [ends(0, f64::min), ends(1, f64::max)] }
    }

    /// Whether one of them may go deeper in a block than `least`.
    fn may_be_deeper(&self, one: &Moving<'_>, least: f64) -> bool {
        let [low, high] = self.velocities;
        let relative = [0, 1, 2].map(|k| {
            let [from, to] = [one.velocity[k] - low[k], one.velocity[k] - high[k]].map(f64::abs);
            // A difference that f64 does not hold is beyond it.
            if from.is_nan() || to.is_nan() { f64::INFINITY } else { from.max(to) }
        });
        one.depth_at(relative, &self.bounds, one.resting.max(self.bounds.resting))
            .is_some_and(|most| most.depth > least)
    }
}

fn unit(along: usize) -> [f64; 3] {
    [0, 1, 2].map(|k| if k == along { 1.0 } else { 0.0 })
}

/// What decides whether two blocks meet.
struct Limits {
    /// Gravity (m/s²).
    pull: [f64; 3],
    penetration: f64,
    search: f64,
}

impl Limits {
    /// Whether two blocks may meet as they are moving when time begins: not where something keeps them apart along an axis, or along the normal of a face.
    fn may_meet(&self, pair: [&Moving<'_>; 2]) -> bool {
        if (0..3).any(|along| self.keep_apart(unit(along), pair, false)) {
            return false;
        }
        let shapes = || pair.into_iter().filter_map(|one| one.shape);
        let faces: usize = shapes().map(|shape| shape.faces.len()).sum();
        let points: usize = shapes().map(|shape| shape.points.len()).sum();
        let mut normals = shapes().flat_map(|shape| &shape.faces).map(|face| face.normal);
        faces * points > MAX_PROJECTIONS || !normals.any(|normal| self.keep_apart(normal, pair, false))
    }

    /// Whether two blocks are one behind the other along a unit vector, within `penetration`, and do not come closer: neither by their velocities, nor by gravity, which pulls what can move and is
    /// not yet on the other one (further off than `search`), or goes away and comes back. Along an axis boxes decide; of `bounds` of several blocks whatever gravity pulls may be off.
    fn keep_apart(&self, along: [f64; 3], [one, other]: [&Moving<'_>; 2], are_bounds: bool) -> bool {
        let axis = (0..3).find(|&axis| along == unit(axis));
        let ends = |one: &Moving<'_>| axis.map_or_else(|| one.ends(along), |axis| [one.low[axis], one.high[axis]]);
        let ([low, high], [other_low, other_high]) = (ends(one), ends(other));
        // From the one to the other one.
        let (gap, sign) =
            if other_low - high >= low - other_high { (other_low - high, 1.0) } else { (low - other_high, -1.0) };
        let relative = one.relative_to(other);
        let rounding = |vector: [f64; 3]| 1e-12 * (0..3).map(|k| (vector[k] * along[k]).abs()).sum::<f64>();
        let [closing, pull] = [relative, self.pull].map(|vector| sign * dot(vector, along));
        let [little, no_pull] = [relative, self.pull].map(rounding);
        if gap.is_nan() || gap < -self.penetration || !little.is_finite() || closing > little {
            return false;
        }
        let falls = (one.can_move && pull > no_pull) || (other.can_move && -pull > no_pull);
        !falls || !(are_bounds || closing < -little || gap > self.search)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Block, Motion};

    /// Cubes of 1 m and 1000 kg with these least corners and velocities, contacts of 10⁵ N/m, no gravity.
    fn cubes(all: &[([f64; 3], [f64; 3])]) -> Scene {
        let of = |at: [f64; 3]| Vec3::new(at[0], at[1], at[2]).map(|&c| Number::from_f64(c).unwrap());
        let mut scene = Scene::default();
        for (place, &(low, velocity)) in all.iter().enumerate() {
            let cube = Block::cuboid(&of(low), &of(low.map(|c| c + 1.0))).unwrap();
            let mut one = SceneBlock::new(format!("cube {place}"), cube);
            (one.body.velocity, one.body.motion) = (of(velocity), Motion::Rigid);
            scene.blocks.push(one);
        }
        scene.simulation.gravity = of([0.0; 3]);
        scene.simulation.materials[0].density = Number::from_integer(1000);
        scene
            .simulation
            .joints
            .all_mut()
            .for_each(|joint| joint.normal_stiffness = Some(Number::from_integer(100_000)));
        scene
    }

    fn set(penetration: f64) -> ToleranceSet {
        let [penetration, search] = [penetration, 0.25].map(|length| Number::from_f64(length).unwrap());
        ToleranceSet { penetration, search, ..ToleranceSet::ZERO }
    }

    fn found(scene: &Scene, penetration: f64) -> Option<Warning> {
        let set = set(penetration);
        speed(&set, scene, &ColumnSource::of(&set, scene))
    }

    /// To a millionth.
    fn depth(scene: &Scene) -> Option<f64> {
        found(scene, 1.0 / 1024.0).map(|warning| (warning.found * 1e6).round() / 1e6)
    }

    #[test]
    fn the_motion_of_two_blocks_relative_to_one_another_counts() {
        let pair = |one: f64, other: f64| cubes(&[([0.0; 3], [one, 0.0, 0.0]), ([2.0, 0.0, 0.0], [other, 0.0, 0.0])]);
        // ½·500 kg·(2 m/s)² on 10⁵ N/m: √(2·1000/10⁵); twice the energy of one alone.
        let meeting = depth(&pair(1.0, -1.0));
        assert_eq!(meeting, Some(0.141421));
        // Whoever watches.
        assert_eq!((depth(&pair(2.0, 0.0)), depth(&pair(9.0, 7.0))), (meeting, meeting));
        let mut fixed = pair(2.0, 5.0);
        fixed.blocks[1].body.motion = Motion::Fixed;
        assert_eq!(depth(&fixed), Some(0.2), "√(2·2000/10⁵): a fixed block does not move, whatever it is given");
        for (one, other) in [(0.0, 0.0), (3.0, 3.0), (-1.0, 1.0), (0.0, 5.0), (-5.0, 0.0)] {
            assert_eq!(depth(&pair(one, other)), None, "{one} {other}");
        }
        let found = found(&pair(1.0, -1.0), 0.125).unwrap();
        assert_eq!(
            (found.block, found.remedy.as_str()),
            (Some(0), "normal_stiffness ≥ 128001 or penetration ≥ 0.141422")
        );
    }

    #[test]
    fn a_heavy_block_that_creeps_gives_a_light_one_what_the_light_one_can_take() {
        let mut scene = cubes(&[([0.0; 3], [0.0; 3]), ([0.0, 0.0, -1000.0], [0.0, 0.0, 1.0])]);
        let corner = |at: [f64; 3]| Vec3::new(at[0], at[1], at[2]).map(|&c| Number::from_f64(c).unwrap());
        scene.blocks[1].block =
            Block::cuboid(&corner([-500.0, -500.0, -1000.0]), &corner([500.0, 500.0, 0.0])).unwrap();
        // 10¹² kg at 1 m/s have 5·10¹¹ J; towards a ton they count as ½·1000 kg·(1 m/s)².
        assert_eq!(depth(&scene), Some(0.1));
    }

    #[test]
    fn blocks_that_pass_or_slide_along_one_another_do_not_meet() {
        let one = |at: [f64; 3], velocity: [f64; 3]| depth(&cubes(&[([0.0; 3], [0.0; 3]), (at, velocity)]));
        assert_eq!(one([5.0, 3.0, 0.0], [-9.0, 0.0, 0.0]), None, "beside it");
        assert_eq!(one([0.0, 0.0, 1.0], [9.0, 0.0, 0.0]), None, "on it");
        assert_eq!(one([0.0, 0.0, 0.9995], [9.0, 0.0, 0.0]), None, "on it, deep by less than is allowed");
        assert_eq!(one([0.0, 0.0, 0.75], [2.0, 0.0, 0.0]), Some(0.141421), "in it");
        assert_eq!(one([5.0, 0.5, 0.0], [-2.0, 0.0, 0.0]), Some(0.141421), "against it");
        // On a slope, by the normal of a face: boxes overlap.
        let number = |c: i32| Number::from_integer(c);
        let prism = |flat: [[i32; 2]; 3]| {
            let ends = [0, 1].map(|y| flat.map(|[x, z]| Vec3::new(number(x), number(y), number(z))));
            let faces = vec![vec![0, 1, 2], vec![5, 4, 3], vec![0, 3, 4, 1], vec![1, 4, 5, 2], vec![2, 5, 3, 0]];
            Block::new(ends.concat(), faces, &Default::default()).unwrap()
        };
        let slope = |velocity: [f64; 3]| {
            let mut scene = cubes(&[([0.0; 3], [0.0; 3]), ([0.0; 3], velocity)]);
            scene.blocks[0].block = prism([[0, 0], [4, 0], [0, 4]]);
            scene.blocks[1].block = prism([[4, 4], [0, 4], [4, 0]]);
            depth(&scene)
        };
        assert_eq!((slope([3.0, 0.0, -3.0]), slope([3.0, 0.0, 3.0])), (None, None));
        assert!(slope([-3.0, 0.0, 2.0]).is_some());
    }

    #[test]
    fn what_goes_up_comes_down_and_what_spins_turns_within_its_reach() {
        let thrown = |gap: f64, velocity: [f64; 3], gravity: i32| {
            let mut scene = cubes(&[([0.0; 3], [0.0; 3]), ([0.0, 0.0, 1.0 + gap], velocity)]);
            scene.blocks[0].body.motion = Motion::Fixed;
            scene.simulation.gravity.z = Number::from_integer(-gravity);
            found(&scene, 0.125).map(|warning| warning.found)
        };
        let up = [0.0, 0.0, 9.0];
        assert_eq!((thrown(0.0, up, 0), thrown(0.0, up, 10).is_some()), (None, true));
        let along = [9.0, 0.0, 0.0];
        assert_eq!((thrown(0.0, along, 10), thrown(0.5, along, 10).is_some()), (None, true));
        let spinning = |away: f64| {
            let mut scene = cubes(&[([0.0; 3], [0.0; 3]), ([away, 0.0, 0.0], [0.0; 3])]);
            scene.blocks[0].body.spin.z = Number::from_integer(3);
            depth(&scene)
        };
        // ½·1000/6·9 J; the ball about a cube ends 0.366 m off its faces.
        assert_eq!((spinning(1.25), spinning(1.5)), (Some(0.122474), None));
    }

    #[test]
    fn weight_is_borne_by_all_contacts_and_energy_by_one() {
        let falling = |velocity: f64| {
            let mut scene = cubes(&[([0.0; 3], [0.0; 3]), ([0.0, 0.0, 1.0], [0.0, 0.0, velocity])]);
            scene.blocks[0].body.motion = Motion::Fixed;
            scene.simulation.gravity.z = Number::from_integer(-10);
            found(&scene, 0.03125).map(|warning| (warning.found * 1e6).round() / 1e6)
        };
        // 10 kN on four contacts are 2.5 cm deep, on one 10 cm; 3.125 cm are allowed.
        assert_eq!((falling(0.0), falling(-1e-9), falling(-0.0624)), (None, None, None));
        assert_eq!(falling(-0.1), Some(0.035));
    }

    #[test]
    fn speeds_beyond_f64_are_told() {
        let pair = |speed: f64| cubes(&[([0.0; 3], [speed, 0.0, 0.0]), ([2.0, 0.0, 0.0], [-speed, 0.0, 0.0])]);
        for speed in [1e160, 1e308] {
            let found = found(&pair(speed), 0.125).unwrap();
            assert_eq!((found.found, found.remedy.as_str()), (f64::INFINITY, "normal_stiffness ≥ (beyond f64)"));
        }
        let mut scene = pair(0.0);
        scene.blocks[1].body.spin.z = Number::from_f64(1e200).unwrap();
        scene.blocks[1].body.spin.x = Number::from_f64(-1e200).unwrap();
        scene.blocks[1].body.spin.y = Number::from_f64(1e200).unwrap();
        scene.blocks[0].body.velocity.x = Number::from_integer(1);
        assert_eq!(found(&scene, 0.125).map(|found| found.found), Some(f64::INFINITY));
        assert_eq!(found(&pair(0.0), 0.125), None);
    }

    #[test]
    fn of_many_blocks_the_deepest_pair_is_found() {
        // Three cubes apart and at rest before one that moves, then two that are faster towards one another.
        let still = [0.0; 3];
        let mut all: Vec<_> = (0..3).map(|k| ([0.0, 3.0 * f64::from(k), 0.0], still)).collect();
        all.extend([
            ([5.0, 6.0, 0.0], [-1.0, 0.0, 0.0]),
            ([0.0, 0.0, 9.0], [1.0, 0.0, 0.0]),
            ([4.0, 0.0, 9.0], [-2.0, 0.0, 0.0]),
        ]);
        let found = found(&cubes(&all), 0.03125).unwrap();
        assert_eq!((found.block, (found.found * 1e6).round()), (Some(4), 212_132.0));
    }

    #[test]
    fn of_many_velocities_the_deepest_pair_is_found() {
        // Cubes in a lattice far apart, each with a velocity of its own; towards one another most by two that are not next to one another in any order.
        let mut all: Vec<_> = (0..3000_u32)
            .map(|k| {
                let turned = f64::from(k * 7919 % 3000) / 3000.0;
                let at = [k % 15, k / 15 % 15, k / 225].map(|c| 3.0 * f64::from(c));
                (at, [turned, f64::from(k) / 6000.0, 0.25 - turned / 2.0])
            })
            .collect();
        (all[700].1, all[701].1) = ([4.0, 0.0, 0.0], [-3.0, 0.0, 0.0]);
        let deepest = |all: &[([f64; 3], [f64; 3])]| {
            let warning = found(&cubes(all), 0.015625).unwrap();
            (warning.block, (warning.found * 1e6).round())
        };
        // √(500·49/10⁵)
        assert_eq!(deepest(&all), (Some(700), 494_975.0));
        (all[700].1, all[701].1) = ([0.0; 3], [0.0; 3]);
        (all[3], all[2999]) = (([-40.0, -40.0, 0.0], [-3.0, 0.0, 0.0]), ([-50.0, -40.0, 0.0], [4.0, 0.0, 0.0]));
        assert_eq!(deepest(&all), (Some(3), 494_975.0));
    }
}
