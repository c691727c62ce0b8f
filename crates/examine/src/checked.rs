//! A model that could be read, with what the rules say of its tolerances.

use crate::extents::Extents;
use crate::unused_laws::unused_laws;
use rockproof_model::block::LARGEST_COORDINATE;
use rockproof_model::scene::SceneFormat;
use rockproof_model::simulation::{Body, Motion};
use rockproof_model::text::noun;
use rockproof_model::tolerance_rules::{self, BEYOND_F64, Fall, Thin, Warning};
use rockproof_model::{Number, Precision, Scene, SceneBlock, ToleranceSet, ToleranceSpec, Vec3, Violation};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::PathBuf;

/// A model and the tolerances that it is looked at with.
#[derive(Clone, Debug)]
pub struct CheckedModel {
    /// The file, as messages and results name it.
    pub file: PathBuf,
    /// The format it was read as, where it was read from a file.
    pub format: Option<SceneFormat>,
    /// What was read.
    pub scene: Scene,
    /// The tolerances asked for.
    pub spec: ToleranceSpec,
    /// The complete set for these blocks.
    pub set: ToleranceSet,
    /// The precision that the rules, the presets and the verdict are for.
    pub precision: Precision,
    /// How large it is.
    pub extents: Extents,
    /// The rules that are not met.
    pub violations: Vec<Violation>,
    /// A fall that is not stopped within `penetration`.
    pub fall: Option<Fall>,
    /// A block that `penetration` is more than half as thick as.
    pub thin: Option<Thin>,
    /// What violates no rule and yet lets blocks pass through one another.
    pub warnings: Vec<Warning>,
    /// What may be meant otherwise than it is written: units, triangles of a mesh.
    pub notes: Vec<String>,
    /// What a planarity would merge of a mesh whose coordinates were rounded, where whoever read it knows.
    pub merging: Option<String>,
    /// Why the file's f32 do not tell how its blocks lie, where whoever read it knows that it has f32 ([`Extents::coarse_f32`]).
    pub coarse: Option<String>,
}

/// A value whose rounding overflows (SPEC section 1), or of which too much is calculated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CheckError {
    /// A coordinate of a block.
    #[error("block {number} \"{name}\": a coordinate overflows when rounded to {precision}")]
    Block {
        /// The block's number.
        number: usize,
        /// Its name.
        name: String,
        /// The precision.
        precision: Precision,
    },
    /// A block so large, or so far off, that what is calculated of it overflows.
    #[error(
        "block {number} \"{name}\": a coordinate of {coordinate:e} m; beyond {:e} m weights and energies overflow f64",
        LARGEST_COORDINATE
    )]
    Size {
        /// The block's number.
        number: usize,
        /// Its name.
        name: String,
        /// The coordinate (m).
        coordinate: f64,
    },
    /// A tolerance.
    #[error("tolerance `{name}` overflows when rounded to {precision}")]
    Tolerance {
        /// Its name.
        name: &'static str,
        /// The precision.
        precision: Precision,
    },
}

/// Refuses blocks so large, or so far off, that weights and energies overflow.
///
/// # Errors
/// [`CheckError::Size`] with the first coordinate beyond [`LARGEST_COORDINATE`].
pub fn refuse_too_large(scene: &Scene) -> Result<(), CheckError> {
    for (number, block) in scene.blocks.iter().enumerate() {
        let mut coordinates = block.block.coordinates().map(Number::approximate);
        if let Some(coordinate) = coordinates.find(|c| c.abs() > LARGEST_COORDINATE) {
            return Err(CheckError::Size { number, name: block.name.clone(), coordinate });
        }
    }
    Ok(())
}

impl CheckedModel {
    /// Compares the tolerances of a scene with the rules. The file is named as in messages and results, with the format it was read as.
    ///
    /// # Errors
    /// Where a coordinate or a tolerance overflows in the precision.
    pub fn new(
        (file, format): (PathBuf, Option<SceneFormat>),
        scene: Scene,
        (spec, set): (ToleranceSpec, ToleranceSet),
        precision: Precision,
    ) -> Result<CheckedModel, CheckError> {
        for (number, block) in scene.blocks.iter().enumerate() {
            if block.block.rounded(precision).is_none() {
                return Err(CheckError::Block { number, name: block.name.clone(), precision });
            }
        }
        refuse_too_large(&scene)?;
        set.rounded(precision).map_err(|name| CheckError::Tolerance { name, precision })?;
        let (violations, (fall, (thin, extents))) = rayon::join(
            || tolerance_rules::check_scene(&set, &scene, precision),
            || {
                let fall = || tolerance_rules::fall(&set, &scene);
                rayon::join(fall, || (tolerance_rules::thin(&set, &scene.shapes()), Extents::of(&scene)))
            },
        );
        let warnings = tolerance_rules::warnings(&set, &scene);
        let notes = extents
            .unit_warning(format)
            .into_iter()
            .chain(ignored_of_fixed(&scene))
            .chain(ignored_of_rigid(&scene))
            .chain(unused_laws(&scene))
            .collect();
        Ok(CheckedModel {
            file,
            format,
            scene,
            spec,
            set,
            precision,
            extents,
            violations,
            fall,
            thin,
            warnings,
            notes,
            merging: None,
            coarse: None,
        })
    }

    /// Blocks, tolerances and notes for programs.
    pub fn json(&self) -> Value {
        let count = self.counts();
        let (shortest, block) = self.extents.shortest();
        let fall = self.fall.as_ref().map(|fall| {
            json!({
                "block": fall.block, "weight_n": fall.weight, "height_m": fall.height, "stiffness_n_per_m": fall.stiffness,
                "needed_n_per_m": fall.needed, "depth_m": fall.depth, "allowed_m": fall.allowed, "remedy": fall.remedy,
            })
        });
        let thin = self.thin.as_ref().map(|thin| {
            json!({
                "block": thin.block, "thickness_m": thin.thickness, "penetration_m": thin.penetration, "remedy": thin.remedy,
            })
        });
        json!({
            "file": self.file.display().to_string(),
            "precision": self.precision.to_string(),
            "blocks": self.scene.blocks.len(),
            "fixed": count.fixed,
            "concave": count.concave,
            "vertices": count.vertices,
            "edges": count.edges,
            "faces": count.faces,
            "merged_faces": count.merged[0],
            "dropped_vertices": count.merged[1],
            "inexact_blocks": count.inexact,
            "volume_m3": count.volume,
            "sides_m": self.extents.sides(),
            "from_m": self.extents.from(),
            "shortest_edge_m": shortest,
            "shortest_edge_block": block,
            "preset": self.spec.preset().map(|preset| preset.name()),
            "tolerances": tolerances_json(&self.set),
            "fall": fall,
            "thin": thin,
            "warnings": self.warnings.iter().map(warning_json).collect::<Vec<_>>(),
            "notes": self.notes,
        })
    }

    /// What its blocks come to.
    pub fn counts(&self) -> BlockCounts {
        let blocks = &self.scene.blocks;
        let total = |count: fn(&SceneBlock) -> usize| blocks.iter().map(count).sum::<usize>();
        BlockCounts {
            fixed: total(|b| usize::from(b.body.is_fixed())),
            concave: total(|b| usize::from(!b.block.is_convex())),
            vertices: total(|b| b.block.vertices().len()),
            edges: total(|b| b.block.topology().edges().len()),
            faces: total(|b| b.block.topology().faces().len()),
            merged: [total(|b| b.merged.faces), total(|b| b.merged.vertices)],
            inexact: blocks.iter().filter(|b| !b.block.is_exact_in(self.precision)).count(),
            volume: Number::from_rational(blocks.iter().map(|b| b.block.volume()).sum()).approximate(),
        }
    }
}

/// What a scene says of blocks that are fixed and that means nothing for them; `None` where it says nothing.
pub fn ignored_of_fixed(scene: &Scene) -> Option<String> {
    const MAX_NAMED: usize = 3;
    let is_zero = |vector: &Vec3<Number>| vector.components().into_iter().all(|part| part.cmp(&Number::ZERO).is_eq());
    let is_loaded = |number: usize| scene.simulation.loads.iter().any(|load| load.block == number);
    let is_held = |number: usize| scene.simulation.fixed_points.iter().any(|point| point.block == number);
    let of_block = |(number, block): (usize, &SceneBlock)| {
        let Body { velocity, spin, stress, .. } = &block.body;
        let given = [
            ("velocity", !is_zero(velocity)),
            ("spin", !is_zero(spin)),
            ("load", is_loaded(number)),
            ("fixed point", is_held(number)),
            ("stress", stress.iter().any(|part| !part.is_zero())),
        ];
        let given: Vec<&str> = given.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| name).collect();
        (block.body.is_fixed() && !given.is_empty()).then(|| format!("{} of block {number}", given.join(", ")))
    };
    let all: Vec<String> = scene.blocks.iter().enumerate().filter_map(of_block).collect();
    let more = all.len().saturating_sub(MAX_NAMED);
    let more = if more > 0 { format!(" and of {more} more") } else { String::new() };
    let named = all.iter().take(MAX_NAMED).map(String::as_str).collect::<Vec<_>>().join("; ");
    (!all.is_empty()).then(|| format!("ignored, since fixed blocks never move: {named}{more}"))
}

/// The initial stress that a scene gives to rigid blocks, which have none; `None` where it gives none.
pub fn ignored_of_rigid(scene: &Scene) -> Option<String> {
    const MAX_NAMED: usize = 5;
    let blocks = scene.blocks.iter().enumerate();
    let is_stressed = |body: &Body| body.motion == Motion::Rigid && body.stress.iter().any(|part| !part.is_zero());
    let all: Vec<String> =
        blocks.filter(|(_, block)| is_stressed(&block.body)).map(|(number, _)| number.to_string()).collect();
    let more = all.len().saturating_sub(MAX_NAMED);
    let more = if more > 0 { format!(" and of {more} more") } else { String::new() };
    let (noun, named) = (noun(all.len() as u64, "block", "blocks"), all[..all.len().min(MAX_NAMED)].join(", "));
    (!all.is_empty()).then(|| format!("ignored, since rigid blocks have no strain: stress of {noun} {named}{more}"))
}

/// What the blocks of a model come to.
#[derive(Clone, Copy, Debug)]
pub struct BlockCounts {
    /// Blocks that do not move.
    pub fixed: usize,
    /// Blocks that are not convex.
    pub concave: usize,
    /// Vertices of all blocks.
    pub vertices: usize,
    /// Edges of all blocks.
    pub edges: usize,
    /// Faces of all blocks.
    pub faces: usize,
    /// Coplanar faces that became one with others, and vertices that were dropped with them.
    pub merged: [usize; 2],
    /// Blocks with coordinates that the precision rounds.
    pub inexact: usize,
    /// In m³.
    pub volume: f64,
}

/// A set for programs: lengths in m, angles as sines or in rad, each the nearest f64.
pub fn tolerances_json(set: &ToleranceSet) -> Value {
    let numbers = set.numbers().into_iter().map(|(name, value)| (name.to_owned(), value.approximate().into()));
    let mut all: Map<String, Value> = numbers.collect();
    all.insert("criteria".to_owned(), set.criteria.name().into());
    all.into()
}

/// A warning for programs.
pub(crate) fn warning_json(warning: &Warning) -> Value {
    json!({
        "about": warning.kind.name(),
        "rule": warning.kind.formula(),
        "found": warning.found,
        "allowed": warning.allowed,
        "block": warning.block,
        "reason": warning.kind.reason(),
        "remedy": warning.remedy,
    })
}

/// A violated rule for programs.
pub fn violation_json(violation: &Violation) -> Value {
    json!({
        "rule": violation.rule.formula(),
        "found": violation.found,
        "allowed": violation.allowed,
        "block": violation.place.map(|place| place.block),
        "edge": violation.place.and_then(|place| place.edge).map(|(p, q)| [p, q]),
        "reason": violation.rule.reason(),
        "remedy": violation.remedy,
    })
}

/// The rules that are not met, each with its reason and what would satisfy it.
pub fn violations_text(violations: &[Violation]) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_violations(&mut out, violations);
    out.trim_start().to_owned()
}

/// A number in seven digits, or that f64 does not hold it.
pub fn in_seven_digits(value: f64) -> String {
    if value.is_finite() { format!("{value:.6e}") } else { BEYOND_F64.to_owned() }
}

fn write_violations(out: &mut String, violations: &[Violation]) -> std::fmt::Result {
    if violations.is_empty() {
        return writeln!(out, "\nrules: all met");
    }
    writeln!(out, "\nrules: {} violated", violations.len())?;
    for violation in violations {
        writeln!(out, "  {}", violation.rule.formula())?;
        let [found, allowed] = [violation.found, violation.allowed].map(in_seven_digits);
        write!(out, "    found      {found}, allowed {allowed}")?;
        match violation.place {
            Some(place) => writeln!(out, ", by {place}")?,
            None => writeln!(out)?,
        }
        writeln!(out, "    because    {}", violation.rule.reason())?;
        writeln!(out, "    satisfied  by {}", violation.remedy)?;
    }
    Ok(())
}
