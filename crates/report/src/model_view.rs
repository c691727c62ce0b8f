//! A whole model to look at: its blocks in groups, each of a colour of its own, for plotly's 3-D traces.

use crate::view::{ViewPoint, axis, centre, edges, places, round, segments, triangles};
use rockproof_model::{Block, Number};
use serde_json::{Value, json};

/// Blocks that are shown alike.
#[derive(Clone, Debug)]
pub struct BlockGroup {
    /// What they have in common; in the legend.
    pub name: String,
    /// A colour of the page's theme, as in `$bad`.
    pub color: &'static str,
    /// From 0, which is not seen, to 1.
    pub opacity: f64,
    /// Their numbers in the model, each with what is said of it under the pointer.
    pub blocks: Vec<(usize, String)>,
}

/// What plotly draws for the blocks of a model, and the point its axes count from (m). Blocks of no group are not drawn.
pub fn traces(blocks: &[&Block], groups: &[BlockGroup]) -> (Vec<Value>, [f64; 3]) {
    let centre = centre(blocks);
    let at: Vec<Vec<ViewPoint>> = blocks.iter().map(|block| places(block, &centre)).collect();
    // The page fits a view to its meshes. So that it fits it to the whole model, each has the corners of the model's box among its
    // points, of which no triangle makes use.
    let corner = |fold: fn(f64, f64) -> f64, first: f64| -> ViewPoint {
        std::array::from_fn(|k| at.iter().flatten().map(|place| place[k]).fold(first, fold))
    };
    let corners = [corner(f64::min, f64::INFINITY), corner(f64::max, f64::NEG_INFINITY)];
    let mut traces: Vec<Value> = Vec::new();
    for group in groups.iter().filter(|group| !group.blocks.is_empty()) {
        let (mut points, mut texts) = (corners.to_vec(), vec![String::new(); 2]);
        let (mut faces, mut ends): ([Vec<u32>; 3], Vec<[ViewPoint; 2]>) = Default::default();
        for (number, text) in &group.blocks {
            let (block, places, first) = (blocks[*number], &at[*number], points.len() as u32);
            for (all, new) in faces.iter_mut().zip(triangles(block, places)) {
                all.extend(new.into_iter().map(|corner| first + corner));
            }
            ends.extend(edges(block, places));
            texts.extend(places.iter().map(|_| text.clone()));
            points.extend(places);
        }
        let [i, j, k] = faces;
        let name = format!("{} ({})", group.name, group.blocks.len());
        traces.push(json!({
            "type": "mesh3d", "name": name, "legendgroup": name, "showlegend": true,
            "hovertemplate": "%{text}<extra></extra>", "text": texts,
            "x": axis(&points, 0), "y": axis(&points, 1), "z": axis(&points, 2), "i": i, "j": j, "k": k,
            "color": group.color, "opacity": group.opacity, "flatshading": true,
        }));
        let mut lines = segments(&ends, group.color, 2.0);
        lines["legendgroup"] = name.into();
        lines["showlegend"] = false.into();
        lines["hoverinfo"] = "skip".into();
        traces.push(lines);
    }
    round(&mut traces);
    (traces, centre.components().map(Number::approximate))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::Vec3;

    #[test]
    fn every_mesh_spans_the_model_and_draws_its_own_blocks() {
        let corner =
            |x: i32, y: i32| Vec3::new(Number::from_integer(x), Number::from_integer(y), Number::from_integer(y));
        let block = |x: i32| Block::cuboid(&corner(x, 0), &corner(x + 1, 1)).expect("a cube");
        let blocks = [block(0), block(10), block(3)];
        let shapes: Vec<&Block> = blocks.iter().collect();
        let group = |name: &str, numbers: &[usize]| BlockGroup {
            name: name.to_owned(),
            color: "$a",
            opacity: 0.5,
            blocks: numbers.iter().map(|&number| (number, format!("block {number}"))).collect(),
        };
        let (traces, from) = traces(&shapes, &[group("sound", &[0, 1]), group("none", &[]), group("bad", &[2])]);
        assert_eq!(from, [5.5, 0.5, 0.5]);
        let meshes: Vec<&Value> = traces.iter().filter(|trace| trace["type"] == "mesh3d").collect();
        assert_eq!((traces.len(), meshes.len()), (4, 2));
        for (mesh, count) in meshes.iter().zip([2, 1]) {
            let xs: Vec<f64> = serde_json::from_value(mesh["x"].clone()).expect("numbers");
            assert_eq!((xs.len(), xs[0], xs[1]), (2 + 8 * count, -5.5, 5.5));
            let corners: Vec<usize> = serde_json::from_value(mesh["i"].clone()).expect("numbers");
            // Six faces of two triangles each; none has a corner of the model's box.
            assert!(corners.len() == 12 * count && corners.iter().all(|&corner| corner >= 2 && corner < xs.len()));
            assert_eq!(mesh["text"].as_array().map(Vec::len), Some(xs.len()));
        }
        assert_eq!(meshes[1]["text"][5], "block 2");
        assert_eq!(meshes[1]["name"], "bad (1)");
    }
}
