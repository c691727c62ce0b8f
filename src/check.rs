//! `check`: are the blocks blocks, and do the tolerances keep the rules?

use crate::exit::{Outcome, Verdict, print, print_error, print_note};
use crate::extents::{
    self, Extents, factor, is_apart_in, is_bent, planarity_that_merges, planarity_that_reads, weld_that_joins,
};
use crate::input::{FormatArgs, ReadArgs, ToleranceArgs, model_help, precision};
use crate::input_file::{InputFile, ModelFile};
use crate::overlaps::overlaps;
use anyhow::Context;
use rockproof_model::rules::Fall;
use rockproof_model::{Number, Precision, Scene, SceneBlock, ToleranceSet, ToleranceSpec, Violation, rules};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::path::PathBuf;

/// Problems told one by one.
const MOST_PROBLEMS: usize = 20;

/// Of problems that are all of one sort so many.
const MOST_ALIKE: usize = 3;

/// Check the blocks of a file, and the tolerances for them
///
/// Reads every block and says what is wrong with each that is none; then compares the tolerances with the rules that
/// make them safe for these blocks, exactly, and says what would satisfy each rule that is not met; warns where a block that falls
/// as far as the model is high would not be stopped within `penetration`; and looks for blocks that overlap, exactly, with what the
/// contacts see of it.
///
/// Exits 0 when all is well, 1 when a rule is violated or blocks overlap deeper than contacts see, 2 when the file or a block cannot be used.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  rockproof check slope.dda --tolerances shi --set search=1/20 --precision f32")]
pub(crate) struct Check {
    #[command(flatten)]
    model: ModelArgs,

    /// Precision that the rules and presets are for: f32 or f64
    #[arg(long, default_value = "f64", value_parser = precision)]
    precision: Precision,

    #[command(flatten)]
    format: FormatArgs,
}

/// A block file, and the tolerances that it is looked at with.
#[derive(clap::Args)]
pub(crate) struct ModelArgs {
    #[arg(help = model_help(), value_hint = clap::ValueHint::FilePath)]
    pub(crate) file: InputFile,

    #[command(flatten)]
    pub(crate) read: ReadArgs,

    #[command(flatten)]
    pub(crate) tolerances: ToleranceArgs,

    /// Multiply every length first: 1/1000 for a file in millimetres
    #[arg(long, value_name = "FACTOR", value_parser = factor, allow_negative_numbers = true)]
    pub(crate) scale: Option<Number>,
}

/// A model that could be read, with what the rules say of its tolerances.
pub(crate) struct CheckedModel {
    pub(crate) file: PathBuf,
    pub(crate) scene: Scene,
    pub(crate) spec: ToleranceSpec,
    pub(crate) set: ToleranceSet,
    pub(crate) precision: Precision,
    pub(crate) extents: Extents,
    pub(crate) violations: Vec<Violation>,
    /// A fall that is not stopped within `penetration`.
    pub(crate) fall: Option<Fall>,
    /// What may be meant otherwise than it is written: units, triangles of a mesh.
    pub(crate) notes: Vec<String>,
}

impl Check {
    pub(crate) fn run(&self) -> Outcome {
        let model = self.model.checked(self.precision)?;
        if !self.format.is_json() {
            print(&model.table())?;
        }
        model.notes.iter().for_each(|note| print_note(note));
        let overlaps = overlaps(&model.scene.shapes(), &model.set, None);
        let rest = || model.fall.as_ref().map(warning).unwrap_or_default() + &overlaps.report();
        self.format.print(rest, || {
            let mut document = model.json();
            document["rules_violated"] = model.violations.iter().map(violation_json).collect();
            document["overlaps"] = overlaps.json();
            document
        })?;
        let sound = model.violations.is_empty() && overlaps.lost() == 0;
        Ok(if sound { Verdict::Passed } else { Verdict::CheckFailed })
    }
}

impl ModelArgs {
    /// The file and how it is read, as they stand on a command line.
    pub(crate) fn shown(&self) -> String {
        self.file.shown() + &self.read.shown()
    }

    /// The factor that lengths are multiplied by, where that changes them.
    pub(crate) fn scaled(&self) -> Option<&Number> {
        self.scale.as_ref().filter(|scale| **scale != Number::from_integer(1))
    }

    /// The command that shows a pair of blocks, or where lengths are multiplied, which only `check` does beside `convert`, the model.
    pub(crate) fn show(&self, [a, b]: [usize; 2]) -> String {
        match self.scaled() {
            None => format!("rockproof classify {}{} --pair {a},{b}", self.shown(), self.tolerances.shown()),
            Some(_) => self.show_all(),
        }
    }

    /// The command that shows the model.
    pub(crate) fn show_all(&self) -> String {
        let scale = self.scaled().map_or(String::new(), |scale| format!(" --scale {scale}"));
        format!("rockproof check {}{}{scale}", self.shown(), self.tolerances.shown())
    }

    /// Reads the model and compares its tolerances with the rules. Blocks that cannot be used are told one by one.
    ///
    /// # Errors
    /// When a block or a tolerance cannot be used.
    pub(crate) fn checked(&self, precision: Precision) -> anyhow::Result<CheckedModel> {
        let file = ModelFile::read(&self.file, &self.read)?;
        let scene = self.scene(&file)?;
        let spec = self.tolerances.spec(scene.tolerances.as_ref())?;
        let set = spec.derive(&scene.shapes(), precision).with_context(|| self.tolerances.place(self.file.path()))?;
        self.check_range(&scene, &set, precision)?;
        let violations = rules::check_scene(&set, &scene, precision);
        let extents = Extents::of(&scene);
        let mut notes: Vec<String> = extents.doubt().into_iter().collect();
        if self.scale.is_none() {
            notes.extend(planarity_that_merges(&file, &scene));
        }
        let fall = rules::fall(&set, &scene);
        let file = self.file.path().to_path_buf();
        Ok(CheckedModel { file, scene, spec, set, precision, extents, violations, fall, notes })
    }

    fn scene(&self, file: &ModelFile) -> anyhow::Result<Scene> {
        let (mut scene, problems) = file.survey()?;
        if !problems.is_empty() {
            // Faces that are not planar are alike in all blocks, and one option is about them all.
            let bent = problems.iter().all(is_bent);
            let most = if bent { MOST_ALIKE } else { MOST_PROBLEMS };
            for problem in problems.iter().take(most) {
                print_error(&problem.to_string());
            }
            if let Some(more) = problems.len().checked_sub(most).filter(|more| *more > 0) {
                print_note(&format!("and {more} more{}", if bent { " of this sort" } else { "" }));
            }
            if bent && let Some(planarity) = planarity_that_reads(file) {
                print_note(&format!("every face is within --planarity {planarity}"));
            }
            let apart = problems.iter().any(|problem| is_apart_in(file, problem));
            if apart && let Some(distance) = weld_that_joins(file) {
                print_note(&format!("with --weld {distance} the faces of every block join"));
            }
            let all = scene.blocks.len() + problems.len();
            anyhow::bail!("{}: {} of {all} blocks cannot be used", file.name().display(), problems.len());
        }
        if let Some(scale) = &self.scale {
            extents::scale(&mut scene, file, scale)?;
        }
        Ok(scene)
    }

    /// A value whose rounding overflows is an error (SPEC section 1).
    fn check_range(&self, scene: &Scene, set: &ToleranceSet, precision: Precision) -> anyhow::Result<()> {
        for (number, block) in scene.blocks.iter().enumerate() {
            if block.block.rounded(precision).is_none() {
                let (file, name) = (self.file.path().display(), &block.name);
                anyhow::bail!("{file}: block {number} \"{name}\": a coordinate overflows when rounded to {precision}");
            }
        }
        match set.rounded(precision) {
            Ok(_) => Ok(()),
            Err(name) => {
                let place = self.tolerances.place(self.file.path());
                anyhow::bail!("{place}: tolerance `{name}` overflows when rounded to {precision}")
            }
        }
    }
}

impl CheckedModel {
    /// Blocks, tolerances and notes for programs.
    pub(crate) fn json(&self) -> Value {
        let count = self.counts();
        let (shortest, block) = self.extents.shortest();
        let fall = self.fall.as_ref().map(|fall| {
            json!({
                "block": fall.block, "weight_n": fall.weight, "height_m": fall.height, "stiffness_n_per_m": fall.stiffness,
                "needed_n_per_m": fall.needed, "depth_m": fall.depth, "allowed_m": fall.allowed, "remedy": fall.remedy,
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
            "notes": self.notes,
        })
    }

    fn counts(&self) -> BlockCounts {
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

    fn table(&self) -> String {
        let mut out = String::new();
        // Writing to a String cannot fail.
        let _ = self.write_blocks(&mut out);
        let _ = self.write_tolerances(&mut out);
        let _ = write_violations(&mut out, &self.violations);
        out
    }

    fn write_blocks(&self, out: &mut String) -> std::fmt::Result {
        let blocks = &self.scene.blocks;
        let count = self.counts();
        writeln!(out, "{}", self.file.display())?;
        writeln!(out, "  blocks    {:>12}", blocks.len())?;
        writeln!(out, "  fixed     {:>12}", count.fixed)?;
        writeln!(out, "  concave   {:>12}", count.concave)?;
        writeln!(out, "  vertices  {:>12}", count.vertices)?;
        writeln!(out, "  edges     {:>12}", count.edges)?;
        writeln!(out, "  faces     {:>12}", count.faces)?;
        writeln!(out, "  volume    {:>12.6} m³", count.volume)?;
        write!(out, "{}", self.extents.lines())?;
        let [faces, vertices] = count.merged;
        if faces + vertices > 0 {
            let changed = blocks.iter().filter(|b| b.merged != Default::default()).count();
            writeln!(out, "  merged    {faces:>12} coplanar faces, {vertices} vertices dropped, in {changed} blocks")?;
        }
        writeln!(out, "  inexact   {:>12} blocks have coordinates that {} rounds", count.inexact, self.precision)
    }

    fn write_tolerances(&self, out: &mut String) -> std::fmt::Result {
        let (spec, set) = (&self.spec, &self.set);
        let preset = spec.preset().map_or("no preset", |p| p.name());
        writeln!(out, "\ntolerances ({preset}, {})", self.precision)?;
        for (name, number) in set.numbers() {
            let source = if spec.numbers().iter().any(|(given, _)| *given == name) { "  given" } else { "" };
            writeln!(out, "  {name:<17} {:>13.6e}{source}", number.approximate())?;
        }
        writeln!(out, "  {:<17} {:>13}", "criteria", set.criteria.name())
    }
}

/// What the blocks of a model come to.
struct BlockCounts {
    fixed: usize,
    concave: usize,
    vertices: usize,
    edges: usize,
    faces: usize,
    /// Coplanar faces that became one with others, and vertices that were dropped with them.
    merged: [usize; 2],
    /// Blocks with coordinates that the precision rounds.
    inexact: usize,
    /// In m³.
    volume: f64,
}

/// A set for programs: lengths in m, angles as sines or in rad, each the nearest f64.
pub(crate) fn tolerances_json(set: &ToleranceSet) -> Value {
    let numbers = set.numbers().into_iter().map(|(name, value)| (name.to_owned(), value.approximate().into()));
    let mut all: Map<String, Value> = numbers.collect();
    all.insert("criteria".to_owned(), set.criteria.name().into());
    all.into()
}

/// A violated rule for programs.
pub(crate) fn violation_json(violation: &Violation) -> Value {
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
pub(crate) fn violations_text(violations: &[Violation]) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_violations(&mut out, violations);
    out.trim_start().to_owned()
}

/// A fall that is not stopped within `penetration`, in the form of a violated rule. It is no violation: whether anything falls so
/// far, rules do not know.
fn warning(fall: &Fall) -> String {
    let Fall { block, weight, height, stiffness, needed, depth, allowed, remedy } = fall;
    format!(
        "\nwarning: a fall may end deeper than penetration\n  (fall onto one corner from the height of the model) ≤ penetration\n\
        \x20   found      {depth:.6e}, allowed {allowed:.6e}, by block {block} of {weight:.6e} N falling {height:.6e} m\n\
        \x20   because    the contact takes p·d²/2 = W·(height + d): normal_stiffness is {stiffness:.6e}, needed is {needed:.6e}\n\
        \x20   satisfied  by {remedy}\n"
    )
}

fn write_violations(out: &mut String, violations: &[Violation]) -> std::fmt::Result {
    if violations.is_empty() {
        return writeln!(out, "\nrules: all met");
    }
    writeln!(out, "\nrules: {} violated", violations.len())?;
    for violation in violations {
        writeln!(out, "  {}", violation.rule.formula())?;
        write!(out, "    found      {:.6e}, allowed {:.6e}", violation.found, violation.allowed)?;
        match violation.place {
            Some(place) => writeln!(out, ", by {place}")?,
            None => writeln!(out)?,
        }
        writeln!(out, "    because    {}", violation.rule.reason())?;
        writeln!(out, "    satisfied  by {}", violation.remedy)?;
    }
    Ok(())
}
