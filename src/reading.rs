//! How a file should be read: which planarity its faces ask for, and which of its vertices to join.

use crate::input_file::ModelFile;
use rockproof_model::scene::{SceneFormat, SceneProblem};
use rockproof_model::text::{EXCERPT_LENGTH, excerpt, noun};
use rockproof_model::{BlockError, LoadOptions, Number, Scene, SceneError, TopologyError};

/// The planarities tried, mildest first; beyond the last a face is bent, not rounded.
const PLANARITIES: [&str; 6] = ["1e-8", "1e-7", "1e-6", "1e-5", "1e-4", "1e-3"];

/// Those beyond them, with which bent faces are read.
const OF_BENT_FACES: [&str; 2] = ["1e-2", "1e-1"];

/// The distances tried at which vertices are joined, in the file's unit, mildest first.
const WELDS: [&str; 9] = ["0", "1e-9", "1e-8", "1e-7", "1e-6", "1e-5", "1e-4", "1e-3", "1e-2"];

/// Files of more bytes are not read again to see what joining vertices does.
const WELDED_AGAIN: usize = 4 << 20;

/// Files of more blocks are not read again to see what another planarity does.
const READ_AGAIN: usize = 5000;

/// A factor of lengths.
pub(crate) fn factor(text: &str) -> Result<Number, String> {
    match Number::parse(text) {
        Ok(number) if number.is_negative() || number.is_zero() => Err("must be above 0".to_owned()),
        Ok(number) => Ok(number),
        Err(error) => Err(error.to_string()),
    }
}

/// Whether a block was refused only because a face is not planar.
pub(crate) fn is_bent(problem: &SceneError) -> bool {
    matches!(problem.problem, SceneProblem::Block { error: BlockError::NotPlanar { .. }, .. })
}

/// The mildest of some planarities that every face of the file is within, if one is.
pub(crate) fn planarity_that_reads(model: &ModelFile) -> Option<&'static str> {
    least_that_reads(model, &PLANARITIES)
}

/// The same beyond what rounding explains.
pub(crate) fn planarity_of_bent(model: &ModelFile) -> Option<&'static str> {
    least_that_reads(model, &OF_BENT_FACES)
}

fn least_that_reads(model: &ModelFile, planarities: &[&'static str]) -> Option<&'static str> {
    let reads = |text: &&&str| read(model, text).is_some_and(|(_, problems)| !problems.iter().any(is_bent));
    planarities.iter().find(reads).copied()
}

/// What the mildest planarity does that lets more faces of the scene become one, if one does: triangles of a mesh whose coordinates were
/// rounded.
pub(crate) fn planarity_that_merges(model: &ModelFile, scene: &Scene) -> Option<String> {
    if !model.format().is_mesh() || scene.blocks.len() > READ_AGAIN {
        return None;
    }
    let widest = PLANARITIES.last().and_then(|text| Number::parse(text).ok())?;
    // Of faces that were merged, the ones before may be nearer to a plane than the whole.
    if !scene.blocks.iter().any(|block| block.merged.faces > 0 || block.block.may_merge_within(&widest)) {
        return None;
    }
    let count = |scene: &Scene| -> [usize; 2] {
        let faces = scene.shapes().iter().map(|block| block.topology().faces().len()).sum();
        [faces, scene.shapes().iter().filter(|block| !block.is_convex()).count()]
    };
    let [faces, concave] = count(scene);
    let used = scene.blocks.iter().map(|block| block.planarity.approximate()).fold(0.0, f64::max);
    PLANARITIES.into_iter().filter(|text| text.parse::<f64>().is_ok_and(|planarity| planarity > used)).find_map(
        |text| {
            let (merged, _) = read(model, text).filter(|(_, problems)| problems.is_empty())?;
            let [fewer, bent] = count(&merged);
            (fewer < faces).then(|| {
                let blocks = noun(bent, "block", "blocks");
                let shapes = if bent == concave {
                    String::new()
                } else {
                    format!(", and {bent} {blocks} concave instead of {concave}")
                };
                format!(
                    "{faces} faces, of which some are nearly coplanar: with --planarity {text} they are {fewer}{shapes}"
                )
            })
        },
    )
}

fn read(model: &ModelFile, planarity: &str) -> Option<(Scene, Vec<SceneError>)> {
    let planarity = Number::parse(planarity).ok();
    model.survey_with(&LoadOptions { planarity, ..model.options().clone() }).ok()
}

/// Whether a block of a mesh was refused because its faces do not join: corners at one place may be vertices of their own.
pub(crate) fn is_apart(problem: &SceneError) -> bool {
    faces_do_not_join(problem) && SceneFormat::of_path(&problem.file).is_some_and(SceneFormat::is_mesh)
}

fn faces_do_not_join(problem: &SceneError) -> bool {
    let SceneProblem::Block { error, .. } = &problem.problem else { return false };
    match error {
        BlockError::RepeatedVertex { .. } => true,
        BlockError::Topology(error) => matches!(error, TopologyError::Open { .. } | TopologyError::TooFew { .. }),
        _ => false,
    }
}

/// As [`is_apart`], of a model whose name may say nothing of its format, or of a file that it names.
pub(crate) fn is_apart_in(model: &ModelFile, problem: &SceneError) -> bool {
    if problem.file == model.name() {
        faces_do_not_join(problem) && model.format().is_mesh()
    } else {
        is_apart(problem)
    }
}

/// The least distance of vertices joined, of some, with which the faces of every block join, if one is.
pub(crate) fn weld_that_joins(model: &ModelFile) -> Option<&'static str> {
    let is_short = model.length() <= WELDED_AGAIN;
    WELDS.into_iter().filter(|_| is_short).find(|text| {
        let weld = Number::parse(text).ok();
        let read = model.survey_with(&LoadOptions { weld, ..model.options().clone() });
        // A bent face is a problem of its own; any other says that what was joined makes no blocks.
        read.is_ok_and(|(_, problems)| problems.iter().all(is_bent))
    })
}

/// What joining vertices made of blocks, where more can be used without it.
pub(crate) fn weld_that_undoes(model: &ModelFile) -> Option<String> {
    let distance = model.options().weld.as_ref().filter(|_| model.length() <= WELDED_AGAIN)?;
    let read = |weld: Option<Number>| model.survey_with(&LoadOptions { weld, ..model.options().clone() }).ok();
    let joined = read(Some(distance.clone())).map_or(0, |(scene, _)| scene.blocks.len());
    let (scene, problems) = read(None)?;
    let (usable, all) = (scene.blocks.len(), scene.blocks.len() + problems.len());
    (usable > joined).then(|| {
        format!(
            "--weld {} made one vertex of all that are no further apart, in the file's unit of length, and of {all} {} {joined} can be used; without it {usable} can",
            excerpt(&distance.to_string(), EXCERPT_LENGTH),
            noun(all, "block", "blocks")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::factor;

    #[test]
    fn factors_are_positive() {
        assert!(factor("1/1000").is_ok() && factor("0").is_err() && factor("-1").is_err() && factor("x").is_err());
    }
}
