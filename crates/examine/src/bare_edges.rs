//! Reflex edges on which another block lies without a contact: SPEC's rules give none there, whatever presses the blocks together.

use crate::overlaps::Overlaps;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use rayon::prelude::*;
use rockproof_model::block::{Point, face_normal};
use rockproof_model::decision::{Feature, Side};
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{Block, Contact, EdgeId, FaceId, Number, Scene, SceneBlock, ToleranceSet, Vec3, VertexId};
use rockproof_oracle::{Pair, PreparedBlock};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// A reflex edge on which another block lies, or which lies on an edge of another block, without a contact.
///
/// A vertex of a block on the edge p–q of another one could have a contact by v-f, v-e or v-v (SPEC section 4). For v-f it must project strictly inside a face, and the edge bounds both of its faces;
/// v-e needs a convex edge and v-v a convex vertex, and this edge and its ends are neither. Likewise an end of the edge that lies on an edge of the other block: it is no convex vertex, so there is
/// neither v-v nor v-e, and it projects onto the boundary of both faces at that edge. Edges make contacts with one another where both are convex.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BareEdge {
    /// The block that has the reflex edge.
    pub block: usize,
    /// The ends of the edge.
    pub edge: [VertexId; 2],
    /// The block that lies on it.
    pub other: usize,
}

impl BareEdge {
    /// What is wrong, without figures.
    pub const TITLE: &str = "a block lies on a reflex edge of another one, where SPEC's rules give no contact";
    /// Why there is none.
    pub const REASON: &str = "a vertex touches a face only strictly inside it, and of edges and vertices only convex ones: what presses the blocks together there is not borne";

    /// Which edge, and what lies on it.
    pub fn sentence(&self, scene: &Scene) -> String {
        let [p, q] = self.edge;
        let [block, other] = [self.block, self.other].map(|block| named(block, scene));
        format!("{other} lies on the reflex edge {p}-{q} of {block}, and SPEC's rules give no contact there")
    }

    /// What mends it.
    pub fn remedy(&self, scene: &Scene) -> String {
        format!("{} split along this edge into convex blocks", named(self.block, scene))
    }

    /// For programs.
    pub fn json(&self) -> Value {
        json!({ "block": self.block, "edge": self.edge, "other": self.other })
    }
}

fn named(block: usize, scene: &Scene) -> String {
    match scene.own_name(block) {
        Some(name) => format!("block {block} ({})", excerpt(name, EXCERPT_LENGTH)),
        None => format!("block {block}"),
    }
}

/// The reflex edges of a scene on which another block lies without a contact, in the order of pairs; `overlaps` names the neighbouring pairs. Lying on it means within `territory`, as a vertex then counts as on a
/// convex edge: such a vertex bears only where it has a contact on each of the two faces of the edge. Not named is what `is_borne_around` says. Compared exactly; pairs of convex blocks and pairs of fixed ones are not looked at.
/// Where `stop` is set meanwhile, those of the pairs looked at until then.
pub fn bare_edges(scene: &Scene, set: &ToleranceSet, overlaps: &Overlaps, stop: &AtomicBool) -> Vec<BareEdge> {
    of_pairs(&scene.blocks, set, overlaps.neighbours(), stop)
}

fn of_pairs(blocks: &[SceneBlock], set: &ToleranceSet, pairs: &[[usize; 2]], stop: &AtomicBool) -> Vec<BareEdge> {
    let may_be_bare = |pair: &&[usize; 2]| {
        pair.iter().any(|&block| !blocks[block].block.is_convex())
            && pair.iter().any(|&block| !blocks[block].body.is_fixed())
    };
    let pairs: Vec<[usize; 2]> = pairs.iter().filter(may_be_bare).copied().collect();
    let wanted: BTreeSet<usize> = pairs.iter().flatten().copied().collect();
    let shapes: BTreeMap<usize, NearShape<'_>> =
        wanted.into_iter().map(|block| (block, NearShape::of(&blocks[block].block))).collect();
    let territory = Territory { exact: set.territory.to_rational(), near: set.territory.approximate() };
    let pairs = pairs.into_par_iter().filter(|_| !stop.load(Ordering::Relaxed));
    pairs.flat_map_iter(|pair| of_pair(pair.map(|block| &shapes[&block]), set, &territory, pair)).collect()
}

/// A block in f64 for all of its pairs, and exactly prepared where it is asked for.
struct NearShape<'s> {
    block: &'s Block,
    points: Vec<[f64; 3]>,
    reflex: Vec<EdgeId>,
    bounds: NearBox,
    prepared: OnceLock<PreparedBlock>,
    exact: OnceLock<Vec<Vec3<BigRational>>>,
    /// Of each face, as far as asked for.
    normals: Vec<OnceLock<Vec3<BigRational>>>,
}

/// A box in f64.
#[derive(Clone, Copy)]
struct NearBox {
    low: [f64; 3],
    high: [f64; 3],
}

/// How far off counts as on, exactly and in f64.
struct Territory {
    exact: BigRational,
    near: f64,
}

impl NearShape<'_> {
    fn of(block: &Block) -> NearShape<'_> {
        let points: Vec<[f64; 3]> = block.vertices().iter().map(|v| v.components().map(Number::approximate)).collect();
        let reflex = block.topology().edge_ids().filter(|&edge| !block.edge_is_convex(edge)).collect();
        let normals = vec![OnceLock::new(); block.topology().faces().len()];
        let (prepared, exact) = (OnceLock::new(), OnceLock::new());
        NearShape { block, reflex, bounds: NearBox::of(&points), points, prepared, exact, normals }
    }

    fn at(&self, vertex: VertexId) -> &Point {
        &self.block.vertices()[vertex.index()]
    }

    fn edge_box(&self, edge: [VertexId; 2]) -> NearBox {
        NearBox::of(&edge.map(|end| self.points[end.index()]))
    }

    /// The vertices.
    fn exact(&self) -> &[Vec3<BigRational>] {
        self.exact.get_or_init(|| self.block.vertices().iter().map(|v| v.map(Number::to_rational)).collect())
    }

    fn normal(&self, face: FaceId) -> &Vec3<BigRational> {
        self.normals[face.index()].get_or_init(|| face_normal(self.exact(), self.block.topology().face(face)))
    }

    fn prepared(&self) -> &PreparedBlock {
        self.prepared.get_or_init(|| PreparedBlock::new(self.block))
    }
}

impl NearBox {
    fn of(points: &[[f64; 3]]) -> NearBox {
        let ends = |pick: fn(f64, f64) -> f64, from: f64| {
            points.iter().fold([from; 3], |ends, at| [0, 1, 2].map(|k| pick(ends[k], at[k])))
        };
        NearBox { low: ends(f64::min, f64::INFINITY), high: ends(f64::max, f64::NEG_INFINITY) }
    }

    /// Whether the boxes may be no further apart than a distance.
    fn may_be_within(&self, other: &NearBox, distance: f64) -> bool {
        // Roundings of these are a few parts in 2⁵³ of the coordinates.
        (0..3).all(|k| {
            let ends = [self.low[k], self.high[k], other.low[k], other.high[k]];
            let slack = distance + 1e-12 * (distance + ends.map(f64::abs).iter().sum::<f64>());
            !(self.low[k] > other.high[k] + slack || self.high[k] < other.low[k] - slack)
        })
    }
}

/// A vertex of one of two blocks at a reflex edge of the first or second of them.
struct AtEdge {
    bare: BareEdge,
    vertex: Feature,
    /// The faces of the reflex edge, where the vertex is one of the other block.
    faces: Option<[Feature; 2]>,
}

fn of_pair(
    shapes: [&NearShape<'_>; 2],
    set: &ToleranceSet,
    territory: &Territory,
    [a, b]: [usize; 2],
) -> Vec<BareEdge> {
    let mut at = at_edges(shapes, [a, b], [Side::A, Side::B], territory);
    at.extend(at_edges([shapes[1], shapes[0]], [b, a], [Side::B, Side::A], territory));
    if at.is_empty() {
        return Vec::new();
    }
    let contacts = Pair::new(shapes[0].prepared(), shapes[1].prepared()).classify(set).contacts;
    let mut planes = SeparatingPlanes { shapes, known: BTreeMap::new() };
    let mut is_borne = |one: &AtEdge| {
        let of_vertex = || contacts.iter().filter(|contact| contact.key.features().contains(&one.vertex));
        let on_face = |face: &Feature| of_vertex().any(|contact| contact.entrance.features().contains(face));
        let touches = one.faces.as_ref().map_or_else(|| of_vertex().next().is_some(), |both| both.iter().all(on_face));
        touches || is_borne_around(&mut planes, one.vertex, &contacts)
    };
    let mut bare: Vec<BareEdge> = at.into_iter().filter(|one| !is_borne(one)).map(|one| one.bare).collect();
    bare.dedup();
    bare
}

/// The vertices of the second of two blocks at reflex edges of the first, and the ends of such edges at edges of the second.
fn at_edges(
    [owner, second]: [&NearShape<'_>; 2],
    [block, other]: [usize; 2],
    [own_side, side]: [Side; 2],
    territory: &Territory,
) -> Vec<AtEdge> {
    let is_near = |one: &NearBox, bounds: &NearBox| one.may_be_within(bounds, territory.near);
    let of_edge = |edge: &EdgeId| owner.block.topology().edge(*edge);
    let with_box = |shape: &NearShape<'_>, ends: [VertexId; 2]| (ends, shape.edge_box(ends));
    let near = |shape: &NearShape<'_>, bounds: &NearBox, all: &mut dyn Iterator<Item = [VertexId; 2]>| {
        let all = all.map(|ends| with_box(shape, ends));
        all.filter(|(_, own)| is_near(own, bounds)).collect::<Vec<([VertexId; 2], NearBox)>>()
    };
    let reflex: Vec<(&EdgeId, NearBox)> = owner
        .reflex
        .iter()
        .map(|edge| (edge, owner.edge_box([of_edge(edge).p, of_edge(edge).q])))
        .filter(|(_, own)| is_near(own, &second.bounds))
        .collect();
    if reflex.is_empty() {
        return Vec::new();
    }
    let topology = second.block.topology();
    let vertices = near(second, &owner.bounds, &mut topology.vertex_ids().map(|vertex| [vertex; 2]));
    let edges = near(second, &owner.bounds, &mut topology.edges().iter().map(|edge| [edge.p, edge.q]));
    let mut found = Vec::new();
    for (id, bounds) in reflex {
        let edge = of_edge(id);
        let ends = [edge.p, edge.q];
        let bare = BareEdge { block, edge: ends, other };
        let faces = [edge.left, edge.right].map(|face| Feature::Face(own_side, face));
        let on_edge = ends.map(|end| owner.at(end));
        for &([vertex, _], own) in &vertices {
            if is_near(&own, &bounds) && is_within(second.at(vertex), &on_edge, &territory.exact) {
                found.push(AtEdge { bare: bare.clone(), vertex: Feature::Vertex(side, vertex), faces: Some(faces) });
            }
        }
        for end in ends {
            let (_, own) = with_box(owner, [end; 2]);
            let is_at = |(edge, bounds): &([VertexId; 2], NearBox)| {
                is_near(&own, bounds) && is_within(owner.at(end), &edge.map(|end| second.at(end)), &territory.exact)
            };
            if edges.iter().any(is_at) {
                found.push(AtEdge { bare: bare.clone(), vertex: Feature::Vertex(own_side, end), faces: None });
            }
        }
    }
    found
}

/// Which planes of faces have two blocks on different sides, each asked once.
struct SeparatingPlanes<'s> {
    shapes: [&'s NearShape<'s>; 2],
    /// Of the planes through the first corner of faces, by block and face.
    known: BTreeMap<(usize, FaceId), bool>,
}

impl SeparatingPlanes<'_> {
    /// Whether the plane through a vertex along a face of its block has all of the block on one side and all of the other one on
    /// the other side. Vertices in one plane have one answer.
    fn separates(&mut self, own: usize, face: FaceId, at: &Vec3<BigRational>) -> bool {
        let shapes = self.shapes;
        let normal = shapes[own].normal(face);
        let height = |point: &Vec3<BigRational>| normal.dot(&point.minus(at));
        let asked = || {
            shapes[own].exact().iter().all(|point| !height(point).is_positive())
                && shapes[1 - own].exact().iter().all(|point| !height(point).is_negative())
        };
        let first = shapes[own].block.topology().face(face)[0];
        if !height(&shapes[own].exact()[first.index()]).is_zero() {
            return asked();
        }
        *self.known.entry((own, face)).or_insert_with(asked)
    }
}

/// Whether a plane of a face at a vertex of one of two blocks has all of the one block on one side of it and all of the other one on the other side, and the vertex lies within the hull of
/// vertices in that plane that have contacts on a face in it. All that the blocks have in common then lies in the plane, so what presses them together is along its normal, and a force along it at the vertex is
/// the sum of such forces at the corners of that hull.
fn is_borne_around(planes: &mut SeparatingPlanes<'_>, vertex: Feature, contacts: &[Contact]) -> bool {
    let Feature::Vertex(side, vertex) = vertex else { return false };
    let own = usize::from(side == Side::B);
    let shapes = planes.shapes;
    let exact = shapes.map(NearShape::exact);
    let at = &exact[own][vertex.index()];
    let topology = |place: usize| shapes[place].block.topology();
    topology(own).vertex_faces(vertex).iter().any(|&face| {
        if !planes.separates(own, face, at) {
            return false;
        }
        let normal = shapes[own].normal(face);
        let height = |point: &Vec3<BigRational>| normal.dot(&point.minus(at));
        let place = |side: Side| usize::from(side == Side::B);
        let is_in_plane = |face: &Feature| match *face {
            Feature::Face(side, face) => topology(place(side))
                .face(face)
                .iter()
                .all(|corner| height(&exact[place(side)][corner.index()]).is_zero()),
            _ => false,
        };
        let touching = contacts.iter().filter(|contact| contact.entrance.features().iter().any(is_in_plane));
        let vertices = touching.flat_map(|contact| contact.key.features()).filter_map(|feature| match feature {
            Feature::Vertex(side, vertex) => Some(&exact[place(side)][vertex.index()]),
            _ => None,
        });
        let arms: Vec<Vec3<BigRational>> =
            vertices.filter(|point| height(point).is_zero()).map(|point| point.minus(at)).collect();
        surround(&arms, normal)
    })
}

/// Whether arms in a plane with this normal have no open half of the plane that holds all of them: their ends then have the point that they begin at in their hull.
fn surround(arms: &[Vec3<BigRational>], normal: &Vec3<BigRational>) -> bool {
    let is_first = |one: &Vec3<BigRational>| {
        arms.iter().all(|other| {
            let turn = one.cross(other).dot(normal);
            turn.is_positive() || (turn.is_zero() && one.dot(other).is_positive())
        })
    };
    // All in an open half have a first one, from which all others turn left by less than half a turn.
    !arms.is_empty() && !arms.iter().any(is_first)
}

/// Whether a point is no further from a stretch than a distance; exactly so far is.
fn is_within(point: &Point, [p, q]: &[&Point; 2], distance: &BigRational) -> bool {
    let [at, p, q]: [Vec3<BigRational>; 3] = [point, p, q].map(|at| at.map(Number::to_rational));
    let (along, from_p) = (q.minus(&p), at.minus(&p));
    let (foot, length_squared) = (along.dot(&from_p), along.norm_squared());
    let limit_squared = distance * distance;
    if !foot.is_positive() {
        from_p.norm_squared() <= limit_squared
    } else if foot >= length_squared {
        at.minus(&q).norm_squared() <= limit_squared
    } else {
        from_p.cross(&along).norm_squared() <= limit_squared * length_squared
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::scene::SceneFormat;
    use rockproof_model::{Precision, Preset};
    use std::path::Path;

    /// Prisms along y between two ends with an L for their outline, and boxes.
    fn scene(blocks: &str) -> Scene {
        Scene::parse(blocks, SceneFormat::Toml, Path::new("scene.toml")).expect("a scene")
    }

    const FACES: &str = "faces = [[0, 1, 2, 3, 4, 5], [11, 10, 9, 8, 7, 6], [0, 6, 7, 1], [1, 7, 8, 2], [2, 8, 9, 3], [3, 9, 10, 4], [4, 10, 11, 5], [5, 11, 6, 0]]\n";

    fn prism([from, to]: [&str; 2]) -> String {
        let outline = [[-1, -1], [4, -1], [4, 0], [0, 0], [0, 3], [-1, 3]];
        let ends = [from, to].map(|y| outline.map(|[x, z]| format!("[{x}, {y}, {z}]")).join(", ")).join(", ");
        format!("[[block]]\nvertices = [{ends}]\n{FACES}")
    }

    fn cube(low: [&str; 3], high: [&str; 3]) -> String {
        format!("[[block]]\nbox = {{ min = [{}], max = [{}] }}\n", low.join(", "), high.join(", "))
    }

    fn found(blocks: &[String], stop: bool) -> Vec<([u32; 2], usize)> {
        let scene = scene(&blocks.concat());
        let set = rockproof_model::preset::derive(Preset::Auto, &scene.shapes(), Precision::F64).expect("a set");
        let pairs: Vec<[usize; 2]> = (1..blocks.len()).flat_map(|b| (0..b).map(move |a| [a, b])).collect();
        let bare = of_pairs(&scene.blocks, &set, &pairs, &AtomicBool::new(stop));
        bare.into_iter().map(|bare| (bare.edge.map(|end| end.0), bare.block)).collect()
    }

    #[test]
    fn a_vertex_off_the_edge_by_less_than_territory_needs_both_faces() {
        let with = |x: &str, z: &str| found(&[prism(["-2", "3"]), cube([x, "0", z], ["1", "1", "1"])], false);
        let edge = vec![([3, 9], 0)];
        assert_eq!(with("0", "0"), edge);
        // A contact on one of both faces, or off both by little.
        assert_eq!((with("1e-6", "0"), with("0", "1e-6")), (edge.clone(), edge.clone()));
        assert_eq!((with("0.2", "0"), with("0", "0.2"), with("0.2", "0.2")), (vec![], vec![], vec![]));
        assert_eq!(found(&[prism(["-2", "3"]), cube(["0", "0", "0"], ["1", "1", "1"])], true), [], "stopped");
    }

    #[test]
    fn rows_of_one_outline_bear_at_the_corners_around() {
        assert_eq!(found(&[prism(["-2", "0"]), prism(["0", "1"]), prism(["1", "4"])], false), []);
        // Here the end of the reflex edge is a corner of the hull of all that is in common: a cube beyond the end, in the corner.
        let beyond = cube(["0", "3", "0"], ["1", "4", "1"]);
        assert_eq!(found(&[prism(["-2", "3"]), beyond], false), [([3, 9], 0)]);
    }

    #[test]
    fn arms_surround_where_no_open_half_holds_them() {
        let whole = |c: i32| BigRational::from_integer(c.into());
        let of = |arms: &[[i32; 2]]| {
            let arms: Vec<_> = arms.iter().map(|&[x, y]| Vec3::new(whole(x), whole(y), whole(0))).collect();
            surround(&arms, &Vec3::new(whole(0), whole(0), whole(-3)))
        };
        assert!(of(&[[1, 0], [-1, 1], [-1, -1]]) && of(&[[1, 2], [-2, -4]]) && of(&[[0, 0], [1, 0]]));
        assert!(!of(&[]) && !of(&[[1, 0]]) && !of(&[[1, 0], [0, 1], [1, 1]]) && !of(&[[2, 1], [1, 3], [-1, 1]]));
        assert!(of(&[[1, 0], [-1, 0], [0, 1]]), "on the side of a hull");
    }
}
