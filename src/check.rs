//! `check`: are the blocks blocks, and do the tolerances keep the rules?

use crate::doubts::{THIN, tell_of_tolerances};
use crate::exit::{ExitStatus, Outcome, print, print_error, print_note};
use crate::input::{FormatArgs, ReadArgs, ToleranceArgs, model_help, precision};
use crate::input_file::{InputFile, ModelFile};
use crate::progress::overlaps;
use crate::reading::{
    is_apart_in, is_bent, planarity_of_bent, planarity_that_merges, planarity_that_reads, weld_that_joins,
};
use anyhow::Context;
use rockproof_examine::{
    BareEdge, CheckError, CheckedModel, Naming, Overlaps, StoredEnergy, bare_edges, in_seven_digits,
    unexplained_energy, violation_json, violations_text,
};
use rockproof_model::text::noun;
use rockproof_model::tolerance_rules::{self, Fall, Rule, Thin, Warning};
use rockproof_model::{Number, Precision, Scene, ToleranceSet};
use rockproof_oracle::audit::{Overlap, OverlapSeverity, OverlapVisibility};
use std::fmt::Write;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Problems told one by one.
const MAX_PROBLEMS: usize = 20;

/// Of problems that are all of one sort so many.
const MAX_ALIKE: usize = 3;

/// Check the blocks of a file, and the tolerances for them
///
/// Reads every block and says of each invalid block what is wrong with it; compares the tolerances exactly with the rules that make them
/// safe for these blocks, and says what satisfies each rule that is violated; warns where a block that falls as far as the model is high
/// would end deeper than `penetration`; and finds exactly which blocks overlap and whether contacts see it.
///
/// Exits 0 when all is well, 1 when a rule is violated or contacts cannot hold an overlap, 2 when the file or a block cannot be used.
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
}

impl Check {
    pub(crate) fn run(&self) -> Outcome {
        let model = self.model.checked(self.precision)?;
        if !self.format.is_json() {
            print(&table(&model))?;
        }
        model.notes.iter().for_each(|note| print_note(note));
        let overlaps = overlaps(&model.scene, &model.set, None);
        let stored = unexplained_energy(&model.scene, &model.set, &overlaps);
        let warnings = || {
            let (falls, thin) = (model.fall.iter().map(warning_of_fall), model.thin.iter().map(warning_of_thin));
            falls.chain(thin).chain(model.warnings.iter().map(warning)).collect::<String>()
        };
        let stored_text = || warning_of_energy(&stored, &model.scene);
        let bare = bare_edges(&model.scene, &model.set, &overlaps, &AtomicBool::new(false));
        let bare_text = || warning_of_bare_edges(&bare, &model.scene);
        let unseen = || territory_that_sees(&overlaps, &model).unwrap_or_default();
        let rest = || warnings() + &stored_text() + &bare_text() + &overlaps.report(&model.scene) + &unseen();
        self.format.print(rest, || {
            let mut document = model.json();
            document["touch_nothing"] = overlaps.lonely().into();
            document["rules_violated"] = model.violations.iter().map(violation_json).collect();
            document["overlaps"] = overlaps.json();
            document["reflex_edges"] = bare.iter().map(BareEdge::json).collect();
            document["unexplained_energy"] = stored.iter().map(StoredEnergy::json).collect();
            document
        })?;
        overlaps.lonely_sentence(&model.scene).into_iter().for_each(|lonely| print_note(&lonely));
        let sound = model.violations.is_empty() && overlaps.lost() == 0;
        Ok(if sound { ExitStatus::Passed } else { ExitStatus::CheckFailed })
    }
}

impl ModelArgs {
    /// The files that are read.
    pub(crate) fn inputs(&self) -> impl Iterator<Item = &Path> {
        [self.file.path()].into_iter().chain(self.tolerances.file())
    }

    /// How commands name the model, of which results are in `dir`, the usual one or another.
    pub(crate) fn naming(&self, dir: &Path, is_usual_dir: bool) -> Naming {
        Naming {
            file: self.file.shown(),
            read: self.read.shown(),
            tolerances: self.tolerances.shown(),
            units_are_meant: self.read.options().scale == Some(Number::from_integer(1)),
            dir: Some(dir.to_path_buf()),
            is_usual_dir,
        }
    }

    /// Reads the model and compares its tolerances with the rules. Blocks that cannot be used are told one by one.
    ///
    /// # Errors
    /// When a block or a tolerance cannot be used.
    pub(crate) fn checked(&self, precision: Precision) -> anyhow::Result<CheckedModel> {
        let file = ModelFile::read(&self.file, &self.read)?;
        let scene = self.scene(&file)?;
        let spec = self.tolerances.spec(scene.tolerances.as_ref())?;
        let place = || self.tolerances.place(self.file.path());
        let set = spec.derive(&scene.shapes(), precision).with_context(place)?;
        tell_of_tolerances(&scene.shapes(), &set);
        let path = self.file.path().to_path_buf();
        let checked = CheckedModel::new((path, Some(file.format())), scene, (spec, set), precision);
        let mut model = checked.map_err(|error| match error {
            CheckError::Block { .. } | CheckError::Size { .. } => {
                anyhow::Error::new(error).context(self.file.path().display().to_string())
            }
            CheckError::Tolerance { .. } => anyhow::Error::new(error).context(place()),
        })?;
        if file.holds_f32() {
            let scale = file.options().scale.as_ref().map_or(1.0, Number::approximate);
            model.coarse = model.extents.coarse_f32(scale);
            model.notes.extend(model.coarse.clone());
        }
        if file.options().scale.is_none() {
            model.merging = planarity_that_merges(&file, &model.scene);
            model.notes.extend(model.merging.clone());
        }
        Ok(model)
    }

    fn scene(&self, file: &ModelFile) -> anyhow::Result<Scene> {
        let (scene, problems) = file.survey()?;
        if !problems.is_empty() {
            // Faces that are not planar are alike in all blocks, and one option is about them all.
            let bent = problems.iter().all(is_bent);
            let most = if bent { MAX_ALIKE } else { MAX_PROBLEMS };
            for problem in problems.iter().take(most) {
                print_error(&problem.to_string());
            }
            if let Some(more) = problems.len().checked_sub(most).filter(|more| *more > 0) {
                print_note(&format!("and {more} more{}", if bent { " of this sort" } else { "" }));
            }
            if bent {
                let cut = "these faces are bent, not rounded: cut them into triangles";
                print_note(&match planarity_that_reads(file) {
                    Some(planarity) => format!("every face is within --planarity {planarity}"),
                    None => planarity_of_bent(file).map_or(cut.to_owned(), |planarity| {
                        format!(
                            "{cut}, or take them for planar with --planarity {planarity}, which joins faces of all blocks that are as near to one plane"
                        )
                    }),
                });
            }
            let apart = problems.iter().any(|problem| is_apart_in(file, problem));
            if apart && let Some(distance) = weld_that_joins(file) {
                print_note(&format!("with --weld {distance} the faces of every block join"));
            }
            let all = scene.blocks.len() + problems.len();
            anyhow::bail!("{}: {} of {all} blocks cannot be used", file.name().display(), problems.len());
        }
        Ok(scene)
    }
}

/// Blocks, tolerances and rules.
fn table(model: &CheckedModel) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_blocks(&mut out, model);
    let _ = write_tolerances(&mut out, model);
    out + "\n" + &violations_text(&model.violations)
}

/// A volume (m³) below which it is printed with an exponent.
const LEAST_WITH_POINT: f64 = 1e-3;

fn write_blocks(out: &mut String, model: &CheckedModel) -> std::fmt::Result {
    let blocks = &model.scene.blocks;
    let count = model.counts();
    writeln!(out, "{}", model.file.display())?;
    writeln!(out, "  blocks    {:>12}", blocks.len())?;
    writeln!(out, "  fixed     {:>12}", count.fixed)?;
    writeln!(out, "  concave   {:>12}", count.concave)?;
    writeln!(out, "  vertices  {:>12}", count.vertices)?;
    writeln!(out, "  edges     {:>12}", count.edges)?;
    writeln!(out, "  faces     {:>12}", count.faces)?;
    // Of a model of a millimetre no digit would be left after the point.
    match count.volume {
        volume if volume > 0.0 && volume < LEAST_WITH_POINT => writeln!(out, "  volume    {volume:>12.5e} m³")?,
        volume => writeln!(out, "  volume    {volume:>12.6} m³")?,
    }
    write!(out, "{}", model.extents.lines())?;
    let [faces, vertices] = count.merged;
    if faces + vertices > 0 {
        let changed = blocks.iter().filter(|b| b.merged != Default::default()).count();
        let [faces_in, dropped, blocks] =
            [(faces, "face", "faces"), (vertices, "vertex", "vertices"), (changed, "block", "blocks")]
                .map(|(count, one, many)| noun(count, one, many));
        writeln!(
            out,
            "  merged    {faces:>12} coplanar {faces_in}, {vertices} {dropped} dropped, in {changed} {blocks}"
        )?;
    }
    let have = noun(count.inexact, "block has", "blocks have");
    writeln!(out, "  inexact   {:>12} {have} coordinates that {} rounds", count.inexact, model.precision)
}

fn write_tolerances(out: &mut String, model: &CheckedModel) -> std::fmt::Result {
    let (spec, set) = (&model.spec, &model.set);
    let preset = spec.preset().map_or("no preset", |p| p.name());
    writeln!(out, "\ntolerances ({preset}, {})", model.precision)?;
    let source = |is_given| if is_given { "  given" } else { "" };
    for (name, number) in set.numbers() {
        let source = source(spec.numbers().iter().any(|(given, _)| *given == name));
        writeln!(out, "  {name:<17} {:>13.6e}{source}", number.approximate())?;
    }
    writeln!(out, "  {:<17} {:>13}{}", "criteria", set.criteria.name(), source(spec.criteria().is_some()))
}

/// A fall that is not stopped within `penetration`, in the form of a violated rule. It is no violation: whether anything falls so
/// far, rules do not know.
fn warning_of_fall(fall: &Fall) -> String {
    let Fall { block, remedy, .. } = fall;
    let [weight, height, stiffness, depth, allowed] =
        [fall.weight, fall.height, fall.stiffness, fall.depth, fall.allowed].map(in_seven_digits);
    let needed = if fall.needed.is_finite() { in_seven_digits(fall.needed) } else { "none that f64 holds".to_owned() };
    let remedy = if remedy.is_empty() { "nothing that f64 holds" } else { remedy };
    format!(
        "\nwarning: a fall may end deeper than penetration\n  (fall onto one corner from the height of the model) ≤ penetration\n\
        \x20   found      {depth}, allowed {allowed}, by block {block} of {weight} N falling {height} m\n\
        \x20   because    the contact takes p·d²/2 = W·(height + d): normal_stiffness is {stiffness}, needed is {needed}\n\
        \x20   satisfied  by {remedy}\n"
    )
}

/// What violates no rule and yet lets blocks pass through one another, in the same form.
fn warning(warning: &Warning) -> String {
    let Warning { kind, block, found, allowed, remedy } = warning;
    let [found, allowed] = [*found, *allowed].map(in_seven_digits);
    let by = block.map_or(String::new(), |block| format!(", by block {block}"));
    format!(
        "\nwarning: {}\n  {}\n    found      {found}, allowed {allowed}{by}\n    because    {}\n    satisfied  by {remedy}\n",
        kind.title(),
        kind.formula(),
        kind.reason()
    )
}

/// Springs that store more than weights explain: the worst pair, in the same form.
fn warning_of_energy(stored: &[StoredEnergy], scene: &Scene) -> String {
    let Some(worst) = stored.first() else { return String::new() };
    let pairs = noun(stored.len(), "pair", "pairs");
    let (title, sentence, remedy) = (StoredEnergy::TITLE, worst.sentence(scene), StoredEnergy::remedy(scene));
    format!(
        "\nwarning: {title}\n  (energy of the springs between two blocks) ≤ F·min(penetration, 2F/p + s) + (energy of their motion)\n\
        \x20   found      {} {pairs}; the worst: {sentence}\n\
        \x20   because    of stiffness p, contacts that share the force F which presses the blocks together store no more than 2F²/p, even where it is laid on them suddenly, and no more than F·penetration where none is deeper; F·s lifts a block by s, a hundredth of its smallest side\n\
        \x20   satisfied  by {remedy}\n",
        stored.len()
    )
}

/// Reflex edges on which blocks lie without a contact: the first, in the same form.
fn warning_of_bare_edges(bare: &[BareEdge], scene: &Scene) -> String {
    let Some(first) = bare.first() else { return String::new() };
    let (count, edges) = (bare.len(), noun(bare.len(), "edge", "edges"));
    let (title, sentence, reason, remedy) =
        (BareEdge::TITLE, first.sentence(scene), BareEdge::REASON, first.remedy(scene));
    format!(
        "\nwarning: {title}\n  (reflex edges on which another block lies without a contact) = 0\n\
        \x20   found      {count} {edges}; the first: {sentence}\n\
        \x20   because    {reason}\n\
        \x20   satisfied  by {remedy}\n"
    )
}

/// A block that `penetration` is more than half as thick as, in the same form.
fn warning_of_thin(thin: &Thin) -> String {
    let Thin { block, thickness, penetration, remedy } = thin;
    format!(
        "\nwarning: {THIN}\n  penetration ≤ (least thickness of a block)/2\n\
        \x20   found      {penetration:.6e}, allowed {:.6e}, by block {block}, {thickness:.6e} m thick\n\
        \x20   because    no point within it is deeper than that, and the nearest way out may be through the face behind\n\
        \x20   satisfied  by {remedy}\n",
        thickness / 2.0
    )
}

/// Unseen overlaps of which at most so many are looked at again.
const MAX_LOOKED_AT_AGAIN: usize = 1000;

/// A territory with which contacts see overlaps that they do not: at boundaries that lie on one another a deeper overlap is beyond it. Nothing
/// where no pair is seen then, or rules forbid it.
fn territory_that_sees(overlaps: &Overlaps, model: &CheckedModel) -> Option<String> {
    let CheckedModel { scene, set, precision, .. } = model;
    let territory = set.territory.approximate();
    let is_meant = |overlap: &Overlap| overlap.sight == OverlapVisibility::Unseen && !overlap.is_deeper_than_g;
    let unseen = overlaps.all().filter(|(overlap, severity)| *severity == OverlapSeverity::Lost && is_meant(overlap));
    let depths = unseen.filter_map(|(overlap, _)| Some((overlap.blocks, overlap.penetration.depth_m()?)));
    let deeper: Vec<([usize; 2], f64)> =
        depths.filter(|(_, depth)| *depth > territory).take(MAX_LOOKED_AT_AGAIN).collect();
    if deeper.is_empty() {
        return None;
    }
    let deepest = deeper.iter().map(|(_, depth)| *depth).fold(0.0, f64::max);
    // A little wider, in four digits.
    let wider: f64 = format!("{:.3e}", 1.01 * deepest).parse().ok()?;
    let wider_set = ToleranceSet { territory: Number::parse(&wider.to_string()).ok()?, ..set.clone() };
    let forbidden = [Rule::TerritoryInSearch, Rule::TerritoryOnEdge];
    let violations = tolerance_rules::check(&wider_set, &scene.shapes(), *precision);
    if violations.iter().any(|violation| forbidden.contains(&violation.rule)) {
        return None;
    }
    let pairs: Vec<(usize, usize)> = deeper.iter().map(|([a, b], _)| (*a, *b)).collect();
    let seen = pairs.len() - self::overlaps(scene, &wider_set, Some(&pairs)).lost();
    let (pairs, overlap) = (noun(seen, "pair", "pairs"), noun(seen, "overlaps", "overlap"));
    (seen > 0).then(|| {
        format!(
            "  {seen} {pairs} {overlap} deeper than territory ({territory} m), and at boundaries contacts do not see that; they do with --set territory={wider}\n"
        )
    })
}
