//! The lines of the answer about what may go wrong later than a few steps show.

use crate::assess::{Examination, plural};
use crate::extents::short;
use crate::stored_energy::StoredEnergy;
use crate::verdict::{Line, line};
use rockproof_model::tolerance_rules::Warning;
use rockproof_report::verdict::Severity;

/// All of them.
pub(crate) fn warning_lines(found: &Examination) -> impl Iterator<Item = Line> {
    let of_set = found.given.warnings.iter().map(tolerances_or_load);
    fall(found).into_iter().chain(thin(found)).chain(stored(found)).chain(bare_edges(found)).chain(of_set)
}

fn fall(found: &Examination) -> Option<Line> {
    let fall = found.model.fall.as_ref()?;
    let [depth, allowed, height] = [fall.depth, fall.allowed, fall.height].map(short);
    let text = format!(
        "block {}, falling {height} m, would end {depth} m deep, and penetration is {allowed} m: use {}",
        fall.block, fall.remedy
    );
    Some(line("fall", Severity::Fair, text))
}

fn thin(found: &Examination) -> Option<Line> {
    let thin = found.given.thin.as_ref()?;
    let [penetration, thickness] = [thin.penetration, thin.thickness].map(short);
    let text = format!(
        "block {} is {thickness} m thick and penetration is {penetration} m: no overlap within it is too deep, so \"held\" says nothing of it: {}",
        thin.block, thin.remedy
    );
    Some(line("thickness", Severity::Fair, text))
}

fn stored(found: &Examination) -> Option<Line> {
    let all = &found.given.stored;
    let worst = all.first()?;
    let more = match all.len() - 1 {
        0 => String::new(),
        count => format!(" (the worst of {})", plural(count + 1, "pair", "pairs")),
    };
    let text =
        format!("{}{more}: use {}", worst.sentence(&found.model.scene), StoredEnergy::remedy(&found.model.scene));
    Some(line("energy", Severity::Fair, text))
}

fn bare_edges(found: &Examination) -> Option<Line> {
    let all = &found.given.bare_edges;
    let (first, scene) = (all.first()?, &found.model.scene);
    let more = match all.len() - 1 {
        0 => String::new(),
        count => format!(" (the first of {})", plural(count + 1, "such edge", "such edges")),
    };
    Some(line("reflex", Severity::Fair, format!("{}{more}: {}", first.sentence(scene), first.remedy(scene))))
}

fn tolerances_or_load(warning: &Warning) -> Line {
    let by = warning.block.map_or(String::new(), |block| format!(" (block {block})"));
    let ([found, allowed], kind) = ([warning.found, warning.allowed].map(short), warning.kind);
    let text = format!("{}: found {found}, allowed {allowed}{by}: use {}", kind.title(), warning.remedy);
    line(kind.name(), Severity::Fair, text)
}
