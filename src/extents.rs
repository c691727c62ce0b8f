//! How large a model is, whether its units look right, and which planarity its faces ask for.

use crate::input_file::ModelFile;
use anyhow::Context;
use num_traits::ToPrimitive;
use rockproof_model::scene::{SceneFormat, SceneProblem};
use rockproof_model::{Block, BlockError, BlockOptions, LoadOptions, Number, Scene, SceneError, TopologyError};

/// The planarities tried, mildest first; beyond the last a face is bent, not rounded.
const PLANARITIES: [&str; 6] = ["1e-8", "1e-7", "1e-6", "1e-5", "1e-4", "1e-3"];

/// The distances tried at which vertices are joined, in the file's unit, mildest first.
const WELDS: [&str; 9] = ["0", "1e-9", "1e-8", "1e-7", "1e-6", "1e-5", "1e-4", "1e-3", "1e-2"];

/// Files of more bytes are not read again to see what joining vertices does.
const WELDED_AGAIN: usize = 4 << 20;

/// Files of more blocks are not read again to see what another planarity does.
const READ_AGAIN: usize = 5000;

/// Blocks are between these sizes in metres (the cube root of their mean volume) unless the units are others.
const SIZES: [f64; 2] = [1e-3, 200.0];

/// The box of a scene and its shortest edge, in metres.
pub(crate) struct Extents {
    sides: [f64; 3],
    from: [f64; 3],
    shortest: f64,
    block: usize,
    /// The cube root of the mean volume.
    size: f64,
}

impl Extents {
    /// Of a scene that has blocks.
    pub(crate) fn of(scene: &Scene) -> Extents {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let (mut shortest, mut block, mut volume) = (f64::INFINITY, 0, 0.0);
        for (number, shape) in scene.shapes().into_iter().enumerate() {
            let points: Vec<[f64; 3]> =
                shape.vertices().iter().map(|v| v.components().map(Number::approximate)).collect();
            for point in &points {
                for axis in 0..3 {
                    low[axis] = low[axis].min(point[axis]);
                    high[axis] = high[axis].max(point[axis]);
                }
            }
            for edge in shape.topology().edges() {
                let [p, q] = [edge.p, edge.q].map(|end| points[end.index()]);
                let length = (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>().sqrt();
                if length < shortest {
                    (shortest, block) = (length, number);
                }
            }
            volume += shape.volume().to_f64().unwrap_or(f64::NAN);
        }
        let size = (volume / scene.blocks.len().max(1) as f64).cbrt();
        Extents { sides: [0, 1, 2].map(|axis| high[axis] - low[axis]), from: low, shortest, block, size }
    }

    /// Two lines of the table of blocks.
    pub(crate) fn lines(&self) -> String {
        let [x, y, z] = self.sides.map(short);
        let [a, b, c] = self.from.map(short);
        format!(
            "  extent    {x:>12} × {y} × {z} m, from ({a}, {b}, {c})\n  shortest  {:>12} m: an edge of block {}\n",
            short(self.shortest),
            self.block
        )
    }

    /// The sides of the box (m).
    pub(crate) fn sides(&self) -> [f64; 3] {
        self.sides
    }

    /// The lowest corner of the box (m).
    pub(crate) fn from(&self) -> [f64; 3] {
        self.from
    }

    /// The shortest edge (m), and the block that has it.
    pub(crate) fn shortest(&self) -> (f64, usize) {
        (self.shortest, self.block)
    }

    /// Why the units may be others than metres, if they look so.
    pub(crate) fn doubt(&self) -> Option<String> {
        let (what, factor) = (if self.size > SIZES[1] { "millimetres" } else { "kilometres" }, self.factor()?);
        Some(format!(
            "a mean block of {} m: lengths are metres here; if the file has {what}, `--scale {factor}` checks what it means, and `convert` writes it so",
            short(self.size)
        ))
    }

    /// What lengths should be multiplied by, if the units look as if they were others than metres.
    pub(crate) fn factor(&self) -> Option<&'static str> {
        match self.size {
            size if size > SIZES[1] => Some("1/1000"),
            size if size < SIZES[0] => Some("1000"),
            _ => None,
        }
    }
}

/// Four digits, as short as can be.
pub(crate) fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e6).contains(&size) => {
            let digits = (3 - size.log10().floor() as i32).max(0) as usize;
            let text = format!("{value:.digits$}");
            if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
        }
        _ => format!("{value:.3e}"),
    }
}

/// A scene with every length multiplied, exactly; by 1 it is left as it is. Scenes in TOML say more in metres than coordinates, and are refused.
pub(crate) fn scale(scene: &mut Scene, model: &ModelFile, factor: &Number) -> anyhow::Result<()> {
    if *factor == Number::from_integer(1) {
        return Ok(());
    }
    let file = model.name();
    anyhow::ensure!(
        model.format() != SceneFormat::Toml,
        "{}: --scale is for files of coordinates; a scene in TOML has other lengths in metres as well: scale what it was made from",
        file.display()
    );
    for (number, block) in scene.blocks.iter_mut().enumerate() {
        let vertices = block.block.vertices().iter().map(|v| v.map(|c| c.times(factor))).collect();
        let options = BlockOptions { planarity: block.planarity.clone() };
        let faces = block.block.topology().faces().to_vec();
        block.block = Block::new(vertices, faces, &options)
            .with_context(|| format!("{}: block {number} \"{}\", scaled", file.display(), block.name))?;
    }
    Ok(())
}

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
    PLANARITIES.into_iter().find(|text| read(model, text).is_some_and(|(_, problems)| !problems.iter().any(is_bent)))
}

/// What the mildest planarity does that lets more faces of the scene become one, if one does: triangles of a mesh whose coordinates were
/// rounded.
pub(crate) fn planarity_that_merges(model: &ModelFile, scene: &Scene) -> Option<String> {
    if !model.format().is_mesh() || scene.blocks.len() > READ_AGAIN {
        return None;
    }
    let count = |scene: &Scene| -> [usize; 2] {
        let faces = scene.shapes().iter().map(|block| block.topology().faces().len()).sum();
        [faces, scene.shapes().iter().filter(|block| !block.is_convex()).count()]
    };
    let [faces, concave] = count(scene);
    let used = scene.blocks.iter().map(|block| block.planarity.approximate()).fold(0.0, f64::max);
    PLANARITIES.into_iter().filter(|text| text.parse::<f64>().is_ok_and(|planarity| planarity > used)).find_map(|text| {
        let (merged, _) = read(model, text).filter(|(_, problems)| problems.is_empty())?;
        let [fewer, bent] = count(&merged);
        (fewer < faces).then(|| {
            format!(
                "{faces} faces, of which some are nearly coplanar: with --planarity {text} they are {fewer}, and {bent} blocks concave instead of {concave}"
            )
        })
    })
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
        read.is_ok_and(|(_, problems)| !problems.iter().any(|problem| is_apart_in(model, problem)))
    })
}

#[cfg(test)]
mod tests {
    use super::{factor, short};

    #[test]
    fn four_digits_are_enough() {
        assert_eq!(
            [0.0, 1.0, 2.30477, 1234.56, 0.0016, 123_456.0, 4e-5, 2e9].map(short),
            ["0", "1", "2.305", "1235", "0.0016", "123456", "4.000e-5", "2.000e9"]
        );
    }

    #[test]
    fn factors_are_positive() {
        assert!(factor("1/1000").is_ok() && factor("0").is_err() && factor("-1").is_err() && factor("x").is_err());
    }
}
