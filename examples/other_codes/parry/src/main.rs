//! parry3d behind Rockproof's line protocol: what `query::contact` says about two convex polyhedra.
//!
//!     rockproof campaign --engine-command "parry-f32:f32=rockproof-parry f32" --engine-command "parry-f64=rockproof-parry f64"
//!
//! Shapes are built by `ConvexPolyhedron::from_convex_mesh` from the faces as fans of triangles, where it refuses by
//! `from_convex_hull` from the vertices. Poses are identities: coordinates are those of the question. `dist` is taken by its sign:
//! positive apart, zero touching, negative overlapping. `normal2` points out of B, so A leaves B along it.

use serde_json::{Value, json};
use std::io::{BufRead, Write};

type Failure = Box<dyn std::error::Error>;

/// A block of a question.
struct Solid {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Solid {
    fn read(value: &Value) -> Result<Solid, Failure> {
        let vertices = serde_json::from_value(value["vertices"].clone())?;
        let faces: Vec<Vec<u32>> = serde_json::from_value(value["faces"].clone())?;
        let fan = |face: &Vec<u32>| face[1..].windows(2).map(|two| [face[0], two[0], two[1]]).collect::<Vec<_>>();
        Ok(Solid { vertices, triangles: faces.iter().flat_map(fan).collect() })
    }
}

/// What a code says about a pair.
#[derive(Debug, PartialEq)]
struct Said {
    /// The signed distance; `None` where the code says that there is no contact at any distance.
    gap_m: Option<f64>,
    /// The direction in which A leaves B.
    normal: Option<[f64; 3]>,
}

impl Said {
    fn written(&self) -> Value {
        let state = match self.gap_m {
            Some(gap) if gap < 0.0 => "overlapping",
            Some(0.0) => "touching",
            _ => "apart",
        };
        let mut answer = json!({ "state": state });
        if let Some(gap) = self.gap_m {
            answer["gap_m"] = json!(gap);
        }
        if let Some(normal) = self.normal {
            answer["normal"] = json!(normal);
        }
        answer
    }
}

/// The same code for both precisions: parry has a crate for each.
macro_rules! adapter {
    ($name:ident, $parry:ident, $real:ty) => {
        mod $name {
            use super::{Failure, Said, Solid};
            use $parry::math::{Pose, Vector};
            use $parry::query::contact;
            use $parry::shape::ConvexPolyhedron;

            fn shape(solid: &Solid) -> Result<ConvexPolyhedron, Failure> {
                // The question's numbers are those of this precision, so nothing is rounded here.
                let points = solid.vertices.iter().map(|v| Vector::new(v[0] as $real, v[1] as $real, v[2] as $real));
                let points: Vec<Vector> = points.collect();
                ConvexPolyhedron::from_convex_mesh(points.clone(), &solid.triangles)
                    .or_else(|| ConvexPolyhedron::from_convex_hull(&points))
                    .ok_or_else(|| "neither from_convex_mesh nor from_convex_hull makes a shape of it".into())
            }

            #[allow(clippy::unnecessary_cast, reason = "f32 needs it, f64 does not")]
            pub fn say(a: &Solid, b: &Solid) -> Result<Said, Failure> {
                let here = Pose::identity();
                let found =
                    contact(&here, &shape(a)?, &here, &shape(b)?, <$real>::MAX).map_err(|why| why.to_string())?;
                let wide = |v: Vector| [v.x as f64, v.y as f64, v.z as f64];
                Ok(match found {
                    Some(contact) => Said { gap_m: Some(contact.dist as f64), normal: Some(wide(contact.normal2)) },
                    None => Said { gap_m: None, normal: None },
                })
            }
        }
    };
}

adapter!(single, parry3d, f32);
adapter!(double, parry3d_f64, f64);

fn answer(precision: &str, question: &Value) -> Result<Value, Failure> {
    if [&question["a"], &question["b"]].iter().any(|block| block["reflex"] != json!([])) {
        return Err("a block is concave".into());
    }
    let (a, b) = (Solid::read(&question["a"])?, Solid::read(&question["b"])?);
    let said = if precision == "f32" { single::say(&a, &b)? } else { double::say(&a, &b)? };
    Ok(said.written())
}

fn main() -> Result<(), Failure> {
    let precision = std::env::args().nth(1).unwrap_or_default();
    if !["f32", "f64"].contains(&precision.as_str()) {
        return Err("usage: rockproof-parry f32|f64".into());
    }
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let question: Value = serde_json::from_str(&line?)?;
        let mut said = answer(&precision, &question).unwrap_or_else(|why| json!({ "unsupported": why.to_string() }));
        said["id"] = question["id"].clone();
        writeln!(out, "{said}")?;
        out.flush()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    //! Cases worked out by hand, so that a finding is not the adapter's: which way normals point, what signs mean.

    use super::*;

    fn cuboid(min: [f64; 3], max: [f64; 3]) -> Solid {
        let vertices = (0..8).map(|n| [0, 1, 2].map(|axis| if n >> axis & 1 == 0 { min[axis] } else { max[axis] }));
        let faces =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]].map(|f| f.to_vec());
        let block = json!({ "vertices": vertices.collect::<Vec<_>>(), "faces": faces });
        Solid::read(&block).unwrap()
    }

    fn cube(x: f64, y: f64, z: f64) -> Solid {
        cuboid([x, y, z], [x + 1.0, y + 1.0, z + 1.0])
    }

    fn both(a: &Solid, b: &Solid) -> [Said; 2] {
        [single::say(a, b).unwrap(), double::say(a, b).unwrap()]
    }

    fn near(said: &Said, gap: f64, normal: [f64; 3]) {
        assert!((said.gap_m.unwrap() - gap).abs() < 1e-5, "{said:?}");
        let found = said.normal.unwrap();
        assert!((0..3).all(|axis| (found[axis] - normal[axis]).abs() < 1e-4), "{said:?}");
    }

    #[test]
    fn a_cube_above_another() {
        let below = cube(0.0, 0.0, 0.0);
        for said in both(&cube(0.25, 0.375, 1.5), &below) {
            near(&said, 0.5, [0.0, 0.0, 1.0]);
            assert_eq!(said.written()["state"], "apart");
        }
        for said in both(&cube(0.25, 0.375, 0.75), &below) {
            near(&said, -0.25, [0.0, 0.0, 1.0]);
            assert_eq!(said.written()["state"], "overlapping");
        }
        for said in both(&below, &cube(0.25, 0.375, 0.75)) {
            near(&said, -0.25, [0.0, 0.0, -1.0]);
        }
    }

    #[test]
    fn corners_and_edges_apart() {
        let unit = cube(0.0, 0.0, 0.0);
        for said in both(&cube(3.0, 3.0, 2.0), &unit) {
            near(&said, 3.0, [2.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0]);
        }
        for said in both(&cube(0.25, 4.0, 5.0), &unit) {
            near(&said, 5.0, [0.0, 0.6, 0.8]);
        }
    }

    #[test]
    fn zero_is_touching_and_nothing_is_apart() {
        assert_eq!(Said { gap_m: Some(0.0), normal: None }.written(), json!({ "state": "touching", "gap_m": 0.0 }));
        assert_eq!(Said { gap_m: None, normal: None }.written(), json!({ "state": "apart" }));
    }

    #[test]
    fn answers_keep_what_they_must() {
        let concave = json!({ "a": { "reflex": [[0, 1]] }, "b": { "reflex": [] } });
        assert_eq!(answer("f32", &concave).unwrap_err().to_string(), "a block is concave");
    }
}
