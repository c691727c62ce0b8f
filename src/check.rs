//! `check`: are the blocks blocks, and do the tolerances keep the rules?

use crate::exit::{Outcome, Verdict, print, print_error, print_note};
use crate::extents::{self, Extents, factor, is_bent, planarity_that_merges, planarity_that_reads};
use crate::input::{ReadArgs, ToleranceArgs, precision};
use crate::overlaps::overlaps;
use anyhow::Context;
use rockproof_model::rules::Fall;
use rockproof_model::{Number, Precision, Scene, ToleranceSet, ToleranceSpec, Violation, rules};
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
    /// Blocks: .toml, .dda, .obj, .vtk, or .txt and .voro for voro++
    file: PathBuf,

    #[command(flatten)]
    read: ReadArgs,

    #[command(flatten)]
    tolerances: ToleranceArgs,

    /// Multiply every length first: 1/1000 for a file in millimetres
    #[arg(long, value_name = "FACTOR", value_parser = factor, allow_negative_numbers = true)]
    scale: Option<Number>,

    /// Precision that the rules and presets are for: f32 or f64
    #[arg(long, default_value = "f64", value_parser = precision)]
    precision: Precision,
}

impl Check {
    pub(crate) fn run(&self) -> Outcome {
        let (mut scene, problems) = Scene::survey(&self.file, &self.read.options())?;
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
            if let Some(planarity) = planarity_that_reads(&self.file).filter(|_| bent) {
                print_note(&format!("every face is within --planarity {planarity}"));
            }
            let all = scene.blocks.len() + problems.len();
            anyhow::bail!("{}: {} of {all} blocks cannot be used", self.file.display(), problems.len());
        }
        if let Some(scale) = &self.scale {
            extents::scale(&mut scene, &self.file, scale)?;
        }
        let spec = self.tolerances.spec(scene.tolerances.as_ref())?;
        let shapes = scene.shapes();
        let set = spec.derive(&shapes, self.precision).with_context(|| self.tolerances.place(&self.file))?;
        self.check_range(&scene, &set)?;
        let violations = rules::check_scene(&set, &scene, self.precision);
        print(&self.table(&scene, &spec, &set, &violations))?;
        Extents::of(&scene).doubt().into_iter().for_each(|doubt| print_note(&doubt));
        if self.scale.is_none() {
            planarity_that_merges(&self.file, &scene).into_iter().for_each(|merges| print_note(&merges));
        }
        if let Some(fall) = rules::fall(&set, &scene) {
            print(&warning(&fall))?;
        }
        let overlaps = overlaps(&shapes, &set, None);
        print(&overlaps.report())?;
        let sound = violations.is_empty() && overlaps.lost() == 0;
        Ok(if sound { Verdict::Passed } else { Verdict::CheckFailed })
    }

    /// A value whose rounding overflows is an error (SPEC section 1).
    fn check_range(&self, scene: &Scene, set: &ToleranceSet) -> anyhow::Result<()> {
        for (number, block) in scene.blocks.iter().enumerate() {
            if block.block.rounded(self.precision).is_none() {
                let (file, name, precision) = (self.file.display(), &block.name, self.precision);
                anyhow::bail!("{file}: block {number} \"{name}\": a coordinate overflows when rounded to {precision}");
            }
        }
        match set.rounded(self.precision) {
            Ok(_) => Ok(()),
            Err(name) => {
                let (place, precision) = (self.tolerances.place(&self.file), self.precision);
                anyhow::bail!("{place}: tolerance `{name}` overflows when rounded to {precision}")
            }
        }
    }

    fn table(&self, scene: &Scene, spec: &ToleranceSpec, set: &ToleranceSet, violations: &[Violation]) -> String {
        let mut out = String::new();
        // Writing to a String cannot fail.
        let _ = self.write_blocks(&mut out, scene);
        let _ = self.write_tolerances(&mut out, spec, set);
        let _ = write_violations(&mut out, violations);
        out
    }

    fn write_blocks(&self, out: &mut String, scene: &Scene) -> std::fmt::Result {
        let blocks = &scene.blocks;
        let total = |count: fn(&rockproof_model::SceneBlock) -> usize| blocks.iter().map(count).sum::<usize>();
        let volume = blocks.iter().map(|b| b.block.volume()).sum();
        writeln!(out, "{}", self.file.display())?;
        writeln!(out, "  blocks    {:>12}", blocks.len())?;
        writeln!(out, "  fixed     {:>12}", total(|b| usize::from(b.body.is_fixed())))?;
        writeln!(out, "  concave   {:>12}", total(|b| usize::from(!b.block.is_convex())))?;
        writeln!(out, "  vertices  {:>12}", total(|b| b.block.vertices().len()))?;
        writeln!(out, "  edges     {:>12}", total(|b| b.block.topology().edges().len()))?;
        writeln!(out, "  faces     {:>12}", total(|b| b.block.topology().faces().len()))?;
        writeln!(out, "  volume    {:>12.6} m³", Number::from_rational(volume).approximate())?;
        write!(out, "{}", Extents::of(scene).lines())?;
        let (faces, vertices) = (total(|b| b.merged.faces), total(|b| b.merged.vertices));
        if faces + vertices > 0 {
            let changed = blocks.iter().filter(|b| b.merged != Default::default()).count();
            writeln!(out, "  merged    {faces:>12} coplanar faces, {vertices} vertices dropped, in {changed} blocks")?;
        }
        let inexact = blocks.iter().filter(|b| !b.block.is_exact_in(self.precision)).count();
        writeln!(out, "  inexact   {inexact:>12} blocks have coordinates that {} rounds", self.precision)
    }

    fn write_tolerances(&self, out: &mut String, spec: &ToleranceSpec, set: &ToleranceSet) -> std::fmt::Result {
        let preset = spec.preset().map_or("no preset", |p| p.name());
        writeln!(out, "\ntolerances ({preset}, {})", self.precision)?;
        for (name, number) in set.numbers() {
            let source = if spec.numbers().iter().any(|(given, _)| *given == name) { "  given" } else { "" };
            writeln!(out, "  {name:<17} {:>13.6e}{source}", number.approximate())?;
        }
        writeln!(out, "  {:<17} {:>13}", "criteria", set.criteria.name())
    }
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
