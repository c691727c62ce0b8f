//! The command to go on with after an answer.

use crate::assess::Examination;
use crate::cases::KeptCase;
use crate::naming::{Naming, quoted_path};
use crate::verdict::{NOT_DECIDED, SET};
use rockproof_differential::external::spec::quoted;
use rockproof_model::scene::SceneFormat;
use rockproof_model::{Precision, Rule};
use std::path::{Path, PathBuf};

/// The command for this answer; `units` where they are in doubt.
pub(crate) fn next_command(
    found: &Examination,
    cases: &[KeptCase],
    (naming, dir): (&Naming, &Path),
    (units, answer): (bool, &str),
) -> String {
    let (file, given) = (naming.shown(), &naming.tolerances);
    // Steps of a file that fixes nothing are made with its lowest blocks held; without that all of it falls.
    let blocks = &found.model.scene.blocks;
    let is_held = blocks.len() > 1 && blocks.iter().all(|block| !block.body.is_fixed());
    let hold = if is_held { " --hold-lowest" } else { "" };
    let out = if naming.is_usual_dir { String::new() } else { format!(" --out {}", quoted_path(dir)) };
    if units {
        // A scene in TOML takes no other factor than 1.
        if naming.read.contains("--scale") || found.model.format == Some(SceneFormat::Toml) {
            return naming.show_all();
        }
        let factor = found.model.extents.factor().unwrap_or("1");
        return format!("rockproof examine {file}{given} --scale {factor}{out} --overwrite");
    }
    let single = found.model.precision == Precision::F32;
    let (precision, engine) = if single { (" --precision f32", " --engine f32") } else { ("", "") };
    let shown = |path: &str| quoted_path(&dir.join(path));
    let lost = found.given.overlaps.worst_lost().filter(|_| answer == "not safe");
    if let Some(worst) = lost {
        return naming.show(worst.blocks);
    }
    if answer == NOT_DECIDED && (!found.given.may_see_all() || found.model.coarse.is_some()) {
        return format!("rockproof check {file}{given}{precision}");
    }
    if answer == "safe" || answer == NOT_DECIDED {
        return format!("rockproof simulate {file}{given}{hold}{engine} --steps 100 --audit");
    }
    if answer == "safe with another set" {
        let (set, out) = (shown(SET), quoted(&format!("{}-set", dir.display())));
        return format!("rockproof examine {file} --tolerances {set}{precision} --out {out}");
    }
    if found.local_origin.is_some() {
        return format!("rockproof convert {file} {} --origin local", quoted_path(&local_file(&found.model.file)));
    }
    if single && is_too_far_for_f32(found) {
        return format!("rockproof examine {file}{given} --precision f64{out} --overwrite");
    }
    if let Some(case) = cases.iter().find(|case| case.is_broken) {
        return format!("rockproof replay {}", shown(&case.file));
    }
    match found.given.steps.made() {
        Some(made) if found.given.steps.find_fault() => {
            let steps = made.asked;
            format!("rockproof simulate {file}{given}{hold}{engine} --steps {steps} --audit --contacts")
        }
        // The search is in f64 unless it is told otherwise.
        _ if single => format!("rockproof tune {file}{given} --engine stepper-f32"),
        _ => format!("rockproof tune {file}{given}"),
    }
}

/// The file beside a model for the same relative to a local origin.
fn local_file(model: &Path) -> PathBuf {
    // What came from stdin is called `<stdin>`.
    let stem = model.file_stem().unwrap_or_default().to_string_lossy();
    let name = format!("{}-local.toml", stem.trim_matches(['<', '>']));
    // A name that begins with a hyphen would be an option.
    let folder = if name.starts_with('-') { Path::new(".") } else { Path::new("") };
    model.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(folder).join(name)
}

/// Whether coordinates are so large for the shortest edge that no tolerances keep all rules in f32: no `territory` is above the roundings and within a quarter of it.
pub(crate) fn is_too_far_for_f32(found: &Examination) -> bool {
    let resolved = found.given.violations.iter().find(|violation| violation.rule == Rule::TerritoryResolved);
    let (shortest, _) = found.model.extents.shortest();
    found.model.precision == Precision::F32 && resolved.is_some_and(|broken| broken.allowed > shortest / 4.0)
}
