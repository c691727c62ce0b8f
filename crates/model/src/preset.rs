//! Tolerance sets derived from the blocks they are for (SPEC section 3, "Presets").
//!
//! Lengths are measured in f64 with correctly rounded operations only, and sines come from the `libm` crate, so every
//! machine derives the same set. Each value is an f64 and from then on exact.

use crate::block::Block;
use crate::number::{Number, Precision};
use crate::tolerance::{Criteria, ToleranceSet};
use crate::tolerance_rules::{self, Violation};
use num_traits::ToPrimitive;

crate::named_enum! {
    /// A way to derive a tolerance set from blocks.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Preset: from_name, Display {
        /// A set that meets every rule of [`tolerance_rules`], with the revised criteria.
        Auto = "auto",
        /// Shi's customary choices, in shares of half the model's height, with the classic criteria.
        Shi = "shi",
        /// As `Auto`, with the angles, the territory and `equal` at 0.
        Zero = "zero",
    }
}

/// Why no tolerance set can be derived.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PresetError {
    /// No blocks to measure.
    #[error("preset \"{preset}\" needs blocks to measure, and there are none")]
    NoBlocks {
        /// The preset.
        preset: Preset,
    },
    /// A value that f64 cannot hold: the blocks are too large or too small.
    #[error("preset \"{preset}\" gives no usable value of `{name}`: {value:e}")]
    OutOfRange {
        /// The preset.
        preset: Preset,
        /// The tolerance.
        name: &'static str,
        /// The value derived.
        value: f64,
    },
    /// `auto` breaks its own rules on these blocks.
    #[error("preset \"auto\" cannot meet the rules for these blocks: {}", list(violations))]
    Rules {
        /// Every rule that is not met.
        violations: Vec<Violation>,
    },
}

fn list(violations: &[Violation]) -> String {
    violations.iter().map(|v| v.to_string()).collect::<Vec<_>>().join("; ")
}

/// The sine of an angle in degrees, as SPEC section 1 stores it.
pub fn sine_of_degrees(degrees: f64) -> f64 {
    if degrees == 90.0 { 1.0 } else { libm::sin(degrees * (std::f64::consts::PI / 180.0)) }
}

/// The set of a preset for these blocks, whether or not it meets the rules. Costs some microseconds for two small
/// blocks.
///
/// SPEC gives `shi` no `max_rotation`; it gets the one of `auto`.
///
/// # Errors
/// When there are no blocks, or a value leaves the range of f64.
pub fn derive(preset: Preset, blocks: &[&Block], precision: Precision) -> Result<ToleranceSet, PresetError> {
    let lengths = ModelLengths::of(blocks).ok_or(PresetError::NoBlocks { preset })?;
    let values = match preset {
        Preset::Auto => PresetValues::auto(&lengths, precision),
        Preset::Shi => PresetValues::shi(&lengths),
        Preset::Zero => {
            let auto = PresetValues::auto(&lengths, precision);
            PresetValues { territory: 0.0, overlap_sine: 0.0, parallel_sine: 0.0, equal: 0.0, ..auto }
        }
    };
    values.into_set(preset, &lengths)
}

/// As [`derive()`], and for `auto` the rules hold.
///
/// # Errors
/// As [`derive()`]; and when `auto` cannot meet a rule, with the rules it violates.
pub fn derive_checked(preset: Preset, blocks: &[&Block], precision: Precision) -> Result<ToleranceSet, PresetError> {
    let set = derive(preset, blocks, precision)?;
    if preset == Preset::Auto {
        let violations = tolerance_rules::check(&set, blocks, precision);
        if !violations.is_empty() {
            return Err(PresetError::Rules { violations });
        }
    }
    Ok(set)
}

/// The lengths of a model from which presets are made, in metres.
struct ModelLengths {
    /// ℓ
    shortest_edge: f64,
    /// H
    half_side: f64,
    /// w0
    half_height: f64,
    /// R
    radius: f64,
}

impl ModelLengths {
    fn of(blocks: &[&Block]) -> Option<ModelLengths> {
        let first = blocks.first()?.bounds();
        let (mut min, mut max) = (first.min, first.max);
        for block in &blocks[1..] {
            let bounds = block.bounds();
            min.x = min.x.min(bounds.min.x);
            min.y = min.y.min(bounds.min.y);
            min.z = min.z.min(bounds.min.z);
            max.x = max.x.max(bounds.max.x);
            max.y = max.y.max(bounds.max.y);
            max.z = max.z.max(bounds.max.z);
        }
        let [x, y, z] = [difference(max.x, min.x), difference(max.y, min.y), difference(max.z, min.z)];
        Some(ModelLengths {
            shortest_edge: blocks.iter().map(|b| shortest_edge(b)).fold(f64::INFINITY, f64::min),
            half_side: x.max(y).max(z) / 2.0,
            half_height: z / 2.0,
            radius: blocks.iter().map(|b| radius(b)).fold(0.0, f64::max),
        })
    }
}

/// `a − b` within 2^−20 of itself, however much cancels.
fn difference(a: &Number, b: &Number) -> f64 {
    let (near_a, near_b) = (a.approximate(), b.approximate());
    let near = near_a - near_b;
    let is_close = a.as_f64().is_some() && b.as_f64().is_some()
        || near.abs() > (near_a.abs() + near_b.abs()) * (1.0 / f64::from(1 << 30));
    if is_close { near } else { a.plus(&b.negated()).approximate() }
}

fn shortest_edge(block: &Block) -> f64 {
    let squared = |edge: &crate::topology::Edge| {
        let [p, q] = [edge.p, edge.q].map(|v| &block.vertices()[v.index()]);
        length([difference(&p.x, &q.x), difference(&p.y, &q.y), difference(&p.z, &q.z)])
    };
    block.topology().edges().iter().map(squared).fold(f64::INFINITY, f64::min)
}

/// Scaled, so that squares neither underflow nor overflow.
fn length(d: [f64; 3]) -> f64 {
    let scale = d.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    if scale == 0.0 || !scale.is_finite() {
        return scale;
    }
    let [x, y, z] = d.map(|c| c / scale);
    (x * x + y * y + z * z).sqrt() * scale
}

/// Largest distance of a vertex from the centroid, well within 1e-6 of itself.
fn radius(block: &Block) -> f64 {
    let origin = &block.vertices()[0];
    let points: Vec<[f64; 3]> = block
        .vertices()
        .iter()
        .map(|v| [difference(&v.x, &origin.x), difference(&v.y, &origin.y), difference(&v.z, &origin.z)])
        .collect();
    let size = points.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
    let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| c / size)).collect();
    let centroid = near_centroid(block, &points).unwrap_or_else(|| exact_centroid(block, size));
    let distance = |p: &[f64; 3]| length([p[0] - centroid[0], p[1] - centroid[1], p[2] - centroid[2]]);
    points.iter().map(distance).fold(0.0, f64::max) * size
}

/// The centroid in f64, or `None` when the volume cancels so far that it would be poor.
fn near_centroid(block: &Block, points: &[[f64; 3]]) -> Option<[f64; 3]> {
    let (mut volume, mut magnitude, mut sum) = (0.0, 0.0, [0.0; 3]);
    for face in block.topology().faces() {
        let a = points[face[0].index()];
        for pair in face[1..].windows(2) {
            let [b, c] = [points[pair[0].index()], points[pair[1].index()]];
            let terms = [
                a[0] * (b[1] * c[2] - b[2] * c[1]),
                a[1] * (b[2] * c[0] - b[0] * c[2]),
                a[2] * (b[0] * c[1] - b[1] * c[0]),
            ];
            let six_volumes = terms[0] + terms[1] + terms[2];
            volume += six_volumes;
            magnitude += a[0].abs() * (b[1] * c[2]).abs().max((b[2] * c[1]).abs())
                + a[1].abs() * (b[2] * c[0]).abs().max((b[0] * c[2]).abs())
                + a[2].abs() * (b[0] * c[1]).abs().max((b[1] * c[0]).abs());
            for axis in 0..3 {
                sum[axis] += six_volumes * (a[axis] + b[axis] + c[axis]);
            }
        }
    }
    (volume > magnitude * 1e-6).then(|| sum.map(|s| s / (4.0 * volume)))
}

fn exact_centroid(block: &Block, size: f64) -> [f64; 3] {
    let centroid = block.centroid();
    let origin = &block.vertices()[0];
    let along = |c: &num_rational::BigRational, o: &Number| (c - o.to_rational()).to_f64().unwrap_or(0.0) / size;
    [along(&centroid.x, &origin.x), along(&centroid.y, &origin.y), along(&centroid.z, &origin.z)]
}

/// A set in f64, `max_rotation` apart.
struct PresetValues {
    search: f64,
    territory: f64,
    penetration: f64,
    overlap_sine: f64,
    parallel_sine: f64,
    equal: f64,
    open: f64,
    close: f64,
    max_displacement: f64,
    criteria: Criteria,
}

const THREE_DEGREES: f64 = 3.0;

impl PresetValues {
    fn auto(lengths: &ModelLengths, precision: Precision) -> PresetValues {
        let displacement = (lengths.shortest_edge / 16.0).min(lengths.half_side / 100.0);
        let search = 2.5 * displacement;
        let equal = 1024.0 * precision.epsilon();
        PresetValues {
            search,
            territory: (lengths.shortest_edge / 8.0).min(search / 4.0),
            penetration: displacement,
            overlap_sine: sine_of_degrees(THREE_DEGREES),
            parallel_sine: sine_of_degrees(THREE_DEGREES),
            equal,
            open: equal * lengths.half_side,
            close: equal * lengths.half_side,
            max_displacement: displacement,
            criteria: Criteria::Revised,
        }
    }

    fn shi(lengths: &ModelLengths) -> PresetValues {
        let height = lengths.half_height;
        let displacement = 0.01 * height;
        let search = 2.5 * displacement;
        PresetValues {
            search,
            territory: search,
            penetration: (0.3 * search).max(0.0012 * height),
            overlap_sine: sine_of_degrees(THREE_DEGREES),
            parallel_sine: sine_of_degrees(THREE_DEGREES),
            equal: 0.0,
            open: 2e-7 * height,
            close: 2e-4 * height,
            max_displacement: displacement,
            criteria: Criteria::Classic,
        }
    }

    fn into_set(self, preset: Preset, lengths: &ModelLengths) -> Result<ToleranceSet, PresetError> {
        // ω = sqrt(2g/R), rounded down by far more than the radius may be off.
        let rotation = (2.0 * self.penetration / lengths.radius).sqrt() * (1.0 - 1.0 / f64::from(1 << 18));
        let exact = |name: &'static str, value: f64| {
            Number::from_f64(value).map_err(|_| PresetError::OutOfRange { preset, name, value })
        };
        let length = |name: &'static str, value: f64| match value > 0.0 {
            true => exact(name, value),
            false => Err(PresetError::OutOfRange { preset, name, value }),
        };
        Ok(ToleranceSet {
            search: length("search", self.search)?,
            territory: exact("territory", self.territory)?,
            penetration: length("penetration", self.penetration)?,
            overlap_sine: exact("overlap_sine", self.overlap_sine)?,
            parallel_sine: exact("parallel_sine", self.parallel_sine)?,
            equal: exact("equal", self.equal)?,
            open: exact("open", self.open)?,
            close: exact("close", self.close)?,
            max_displacement: length("max_displacement", self.max_displacement)?,
            max_rotation: exact("max_rotation", rotation)?,
            criteria: self.criteria,
        })
    }
}
