//! A finding to look at: both blocks, the contacts before and after the change, for plotly's 3-D traces.
//!
//! Coordinates are taken from the centre of both blocks, exactly, before they become the f32 of graphics cards: blocks far from the
//! origin would lose their shape otherwise. Everything decided here is for the eye only; the gaps told are the oracle's.

use earcut::Earcut;
use earcut::utils3d::project3d_to_2d;
use rockproof_differential::case_file::{Case, ContactRow};
use rockproof_model::decision::{Feature, Side};
use rockproof_model::{Block, Contact, Number, Point, Sign};
use rockproof_oracle::rational::Rational;
use rockproof_oracle::{Pair, PreparedBlock};
use serde_json::{Value, json};

pub(crate) type ViewPoint = [f64; 3];

/// A contact of a finding, and who has it.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewedContact {
    /// The contact.
    pub contact: Contact,
    /// Whether it is there before the change.
    pub before: bool,
    /// Whether it is there after the change.
    pub after: bool,
    /// The gap through its entrance between the blocks of the case, exactly, to the nearest f64 (m).
    pub gap_m: f64,
}

impl ViewedContact {
    /// `v-f 3/1 through v-f 3/1`.
    pub fn name(&self) -> String {
        let c = &self.contact;
        format!("{} through {}", c.key, c.entrance)
    }

    /// Who has it.
    pub fn side_name(&self) -> &'static str {
        match (self.before, self.after) {
            (true, true) => "both",
            (true, false) => "true",
            _ => "seen",
        }
    }
}

/// The contacts of a case: those before the change, then those that are new after it.
pub fn contacts(case: &Case) -> Vec<ViewedContact> {
    let list = |rows: &[ContactRow]| rows.iter().filter_map(ContactRow::contact).collect::<Vec<Contact>>();
    let (before, after) = (list(&case.about.expected), list(&case.about.found));
    let new = after.iter().filter(|c| !before.contains(c));
    let prepared = [PreparedBlock::new(&case.a), PreparedBlock::new(&case.b)];
    let pair = Pair::new(&prepared[0], &prepared[1]);
    before
        .iter()
        .chain(new)
        .filter(|contact| exists(case, contact))
        .map(|contact| {
            let gap = pair.gap(&contact.entrance);
            let size = gap.squared.sqrt_rounded().unwrap_or(f64::INFINITY);
            ViewedContact {
                contact: *contact,
                before: before.contains(contact),
                after: after.contains(contact),
                gap_m: if gap.sign == Sign::Negative { -size } else { size },
            }
        })
        .collect()
}

/// Whether a contact names features that the blocks have: files can say anything.
fn exists(case: &Case, contact: &Contact) -> bool {
    let has = |feature: Feature| feature.is_in(block(case, feature.side()).topology());
    contact.key.features().into_iter().chain(contact.entrance.features()).all(has)
}

fn block(case: &Case, side: Side) -> &Block {
    match side {
        Side::A => &case.a,
        Side::B => &case.b,
    }
}

/// The blocks of a case around their common centre.
struct BlockView<'c> {
    case: &'c Case,
    centre: Point,
    places: [Vec<ViewPoint>; 2],
}

impl<'c> BlockView<'c> {
    fn new(case: &'c Case) -> BlockView<'c> {
        let centre = centre(&[&case.a, &case.b]);
        let places = [places(&case.a, &centre), places(&case.b, &centre)];
        BlockView { case, centre, places }
    }

    fn places(&self, side: Side) -> &[ViewPoint] {
        &self.places[usize::from(side == Side::B)]
    }

    fn mesh(&self, side: Side, name: &str, color: &str) -> Value {
        let places = self.places(side);
        let [i, j, k] = triangles(block(self.case, side), places);
        json!({
            "type": "mesh3d", "name": name, "legendgroup": name, "showlegend": true, "hoverinfo": "skip",
            "x": axis(places, 0), "y": axis(places, 1), "z": axis(places, 2), "i": i, "j": j, "k": k,
            "color": color, "opacity": 0.35, "flatshading": true,
        })
    }

    fn edges(&self, side: Side, name: &str, color: &str) -> Value {
        let ends = edges(block(self.case, side), self.places(side));
        let mut trace = segments(&ends, color, 3.0);
        trace["name"] = name.into();
        trace["legendgroup"] = name.into();
        trace["showlegend"] = false.into();
        trace["hoverinfo"] = "skip".into();
        trace
    }

    /// The outline of a feature.
    fn outline(&self, feature: Feature) -> Vec<[ViewPoint; 2]> {
        let (Feature::Vertex(side, _) | Feature::Edge(side, _) | Feature::Face(side, _)) = feature;
        let (places, topology) = (self.places(side), block(self.case, side).topology());
        match feature {
            Feature::Vertex(_, v) => vec![[places[v.index()]; 2]],
            Feature::Edge(_, e) => {
                let edge = topology.edge(e);
                vec![[places[edge.p.index()], places[edge.q.index()]]]
            }
            Feature::Face(_, f) => {
                let face = topology.face(f);
                let next = face.iter().cycle().skip(1);
                face.iter().zip(next).map(|(&p, &q)| [places[p.index()], places[q.index()]]).collect()
            }
        }
    }

    /// Where the two features are nearest to one another.
    fn nearest(&self, [a, b]: [Feature; 2]) -> [ViewPoint; 2] {
        let (ends_a, ends_b) = (self.outline(a), self.outline(b));
        match (a, b) {
            (Feature::Face(..), Feature::Vertex(..)) => [onto_plane(ends_b[0][0], &ends_a), ends_b[0][0]],
            (Feature::Vertex(..), Feature::Face(..)) => [ends_a[0][0], onto_plane(ends_a[0][0], &ends_b)],
            _ => between_lines(ends_a[0], ends_b[0]),
        }
    }

    fn contact(&self, seen: &ViewedContact, number: usize) -> Vec<Value> {
        let features = seen.contact.key.features();
        let (color, word) = match seen.side_name() {
            "true" => ("$true", "true"),
            "seen" => ("$seen", "seen"),
            _ => ("$both", "in both"),
        };
        let name = format!("{word}: {}", seen.contact.key);
        let group = format!("contact {number}");
        let text = format!("{word}: {}, gap {:?} m", seen.name(), seen.gap_m);
        let outlines: Vec<[ViewPoint; 2]> = features.iter().flat_map(|&f| self.outline(f)).collect();
        let mut lines = segments(&outlines, color, 9.0);
        let [p, q] = self.nearest(features);
        let mut marks = segments(&[[p, q]], color, 5.0);
        marks["mode"] = "lines+markers".into();
        marks["marker"] =
            json!({ "color": color, "size": 6, "symbol": if word == "seen" { "diamond" } else { "circle" } });
        marks["name"] = name.into();
        for (trace, legend) in [(&mut lines, false), (&mut marks, true)] {
            trace["legendgroup"] = group.clone().into();
            trace["showlegend"] = legend.into();
            trace["hovertemplate"] = format!("{text}<extra></extra>").into();
        }
        vec![lines, marks]
    }
}

/// The middle of the box around some blocks.
pub(crate) fn centre(blocks: &[&Block]) -> Point {
    let middle = |axis: usize| {
        let along = || blocks.iter().flat_map(|b| b.vertices()).map(|v| v.components()[axis].approximate());
        let (low, high) = (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
        Number::from_f64(low / 2.0 + high / 2.0).unwrap_or(Number::ZERO)
    };
    Point::new(middle(0), middle(1), middle(2))
}

/// Where the vertices of a block are, from a centre.
pub(crate) fn places(block: &Block, centre: &Point) -> Vec<ViewPoint> {
    let offset = |v: &Point, axis: usize| v.components()[axis].plus(&centre.components()[axis].negated()).approximate();
    block.vertices().iter().map(|v| [offset(v, 0), offset(v, 1), offset(v, 2)]).collect()
}

/// The faces of a block as triangles: the first, second and third corners.
pub(crate) fn triangles(block: &Block, places: &[ViewPoint]) -> [Vec<u32>; 3] {
    let mut corners: [Vec<u32>; 3] = Default::default();
    let mut cutter = Earcut::new();
    for face in block.topology().faces() {
        let around: Vec<ViewPoint> = face.iter().map(|&v| places[v.index()]).collect();
        let mut flat = Vec::new();
        let mut triangles: Vec<u32> = Vec::new();
        if project3d_to_2d(&around, around.len(), &mut flat) {
            cutter.earcut(flat.iter().copied(), &[], &mut triangles);
        }
        for triangle in triangles.chunks_exact(3) {
            for (list, &corner) in corners.iter_mut().zip(triangle) {
                list.push(face[corner as usize].0);
            }
        }
    }
    corners
}

/// The ends of a block's edges.
pub(crate) fn edges(block: &Block, places: &[ViewPoint]) -> Vec<[ViewPoint; 2]> {
    block.topology().edges().iter().map(|e| [places[e.p.index()], places[e.q.index()]]).collect()
}

/// Coordinates for the eye: seven digits are more than the f32 of a graphics card hold.
pub(crate) fn round(traces: &mut [Value]) {
    for trace in traces {
        for axis in ["x", "y", "z"] {
            for value in trace.get_mut(axis).and_then(Value::as_array_mut).into_iter().flatten() {
                if let Some(number) = value.as_f64() {
                    *value = json!(format!("{number:.7e}").parse::<f64>().unwrap_or(number));
                }
            }
        }
    }
}

pub(crate) fn axis(places: &[ViewPoint], axis: usize) -> Vec<f64> {
    places.iter().map(|place| place[axis]).collect()
}

/// Separate pieces of line in one trace.
pub(crate) fn segments(ends: &[[ViewPoint; 2]], color: &str, width: f64) -> Value {
    let along = |axis: usize| -> Vec<Value> {
        ends.iter().flat_map(|[p, q]| [json!(p[axis]), json!(q[axis]), Value::Null]).collect()
    };
    json!({
        "type": "scatter3d", "mode": "lines", "x": along(0), "y": along(1), "z": along(2),
        "line": { "color": color, "width": width },
    })
}

fn minus(p: ViewPoint, q: ViewPoint) -> ViewPoint {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

fn dot(p: ViewPoint, q: ViewPoint) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

fn along(p: ViewPoint, d: ViewPoint, t: f64) -> ViewPoint {
    [p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]]
}

/// The foot of `point` on the plane of an outline.
fn onto_plane(point: ViewPoint, outline: &[[ViewPoint; 2]]) -> ViewPoint {
    let origin = outline[0][0];
    let mut normal = [0.0; 3];
    for [p, q] in outline {
        let (p, q) = (minus(*p, origin), minus(*q, origin));
        let cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        normal = along(normal, cross, 1.0);
    }
    let size = dot(normal, normal);
    if size > 0.0 { along(point, normal, -dot(minus(point, origin), normal) / size) } else { origin }
}

/// The points of two pieces of line where their lines are nearest, kept on the pieces. A point is a piece without length.
fn between_lines([p1, q1]: [ViewPoint; 2], [p2, q2]: [ViewPoint; 2]) -> [ViewPoint; 2] {
    let (d1, d2, r) = (minus(q1, p1), minus(q2, p2), minus(p1, p2));
    let (a, e, b, c, f) = (dot(d1, d1), dot(d2, d2), dot(d1, d2), dot(d1, r), dot(d2, r));
    let ratio = |n: f64, d: f64| if d > 0.0 { (n / d).clamp(0.0, 1.0) } else { 0.0 };
    let s = ratio(b * f - c * e, a * e - b * b);
    let t = ratio(b * s + f, e);
    let s = ratio(b * t - c, a);
    [along(p1, d1, s), along(p2, d2, t)]
}

/// What plotly draws for a case: the traces, and the point its axes count from (m).
pub fn traces(case: &Case, contacts: &[ViewedContact]) -> (Vec<Value>, [f64; 3]) {
    let stage = BlockView::new(case);
    let mut traces = Vec::new();
    for (side, name, color) in [(Side::A, "block A", "$a"), (Side::B, "block B", "$b")] {
        traces.push(stage.mesh(side, name, color));
        traces.push(stage.edges(side, name, color));
    }
    for (number, contact) in contacts.iter().enumerate() {
        traces.extend(stage.contact(contact, number));
    }
    (traces, stage.centre.components().map(Number::approximate))
}

#[cfg(test)]
mod tests {
    use super::{between_lines, onto_plane};

    #[test]
    fn nearest_points() {
        let x = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        let y = [[1.0, -1.0, 1.0], [1.0, 1.0, 1.0]];
        assert_eq!(between_lines(x, y), [[1.0, 0.0, 0.0], [1.0, 0.0, 1.0]]);
        let point = [[1.0, 3.0, 0.0]; 2];
        assert_eq!(between_lines(x, point), [[1.0, 0.0, 0.0], [1.0, 3.0, 0.0]]);
        assert_eq!(between_lines(point, x), [[1.0, 3.0, 0.0], [1.0, 0.0, 0.0]]);
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| [x, y, 2.0]);
        let outline = [[square[0], square[1]], [square[1], square[2]], [square[2], square[3]], [square[3], square[0]]];
        assert_eq!(onto_plane([0.25, 0.5, 7.0], &outline), [0.25, 0.5, 2.0]);
    }
}
