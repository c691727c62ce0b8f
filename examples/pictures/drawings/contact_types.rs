//! The four contact types, each as the oracle finds it.

use super::axonometric::{Camera, cross, dot, minus, normal_of, plus, scaled, unit, vertex};
use super::shapes::{Metres, number, parallelepiped, prism, pyramid};
use super::svg::{ACCENT, At, BLOCK_A, BLOCK_B, HEADING, PLAIN, SMALL, Svg};
use rockproof_model::{Block, Contact, ContactKey, ContactKind, EdgeId, Entrance, FaceId, Number, ToleranceSet};
use rockproof_oracle::{Gap, Pair, PreparedBlock};

const PANEL: At = (240.0, 318.0);
const TINT: &str = "#e78fb3";

struct Panel {
    heading: &'static str,
    a: Block,
    b: Block,
}

/// The picture.
pub(super) fn draw() -> String {
    let panels = panels();
    let width = PANEL.0 * panels.len() as f64;
    let mut svg = Svg::new(width, PANEL.1, "The four contact types of polyhedral blocks: v-v, v-e, v-f and e-e");
    for (k, panel) in panels.iter().enumerate() {
        draw_panel(&mut svg, panel, PANEL.0 * k as f64);
    }
    svg.finish()
}

/// Contacts up to a gap of half a metre; territories of a sixteenth.
pub(super) fn tolerances() -> ToleranceSet {
    ToleranceSet {
        search: number(0.5),
        territory: number(0.0625),
        penetration: number(0.0625),
        overlap_sine: number(0.046875),
        parallel_sine: number(0.046875),
        max_displacement: number(0.0625),
        max_rotation: number(0.0625),
        ..ToleranceSet::ZERO
    }
}

/// A block that stands on its vertex 0 at `tip`.
pub(super) fn standing_on_a_corner(tip: Metres) -> Block {
    parallelepiped(tip, [1.25, 0.25, 0.75], [-0.75, 1.0, 0.75], [-0.5, -1.25, 0.75])
}

/// A block whose topmost vertex is number 0, at `tip`.
pub(super) fn with_a_corner_on_top(tip: Metres) -> Block {
    pyramid(tip, [[1.25, -1.0, -1.125], [1.0, 1.25, -1.125], [-1.25, 1.0, -1.125], [-1.0, -1.25, -1.125]])
}

fn panels() -> [Panel; 4] {
    let ridge_below = prism([0.125, -1.5, 0.0], [0.0, 3.0, 0.0], [1.25, 0.0, -1.0], [-1.25, 0.0, -1.0]);
    let ridge_above = prism([-1.5, -0.125, 0.4375], [3.0, 0.25, 0.0], [0.0, 1.0, 1.0], [0.0, -1.0, 1.0]);
    let slab = parallelepiped([-1.25, -1.5, -0.75], [2.5, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 0.75]);
    [
        Panel {
            heading: "vertex to vertex",
            a: standing_on_a_corner([0.0625, 0.0, 0.4375]),
            b: with_a_corner_on_top([0.0; 3]),
        },
        Panel { heading: "vertex to edge", a: standing_on_a_corner([0.125, -0.25, 0.4375]), b: ridge_below.clone() },
        Panel { heading: "vertex to face", a: standing_on_a_corner([0.0, -0.25, 0.4375]), b: slab },
        Panel { heading: "edge to edge", a: ridge_above, b: ridge_below },
    ]
}

fn draw_panel(svg: &mut Svg, panel: &Panel, left: f64) {
    let (prepared_a, prepared_b) = (PreparedBlock::new(&panel.a), PreparedBlock::new(&panel.b));
    let pair = Pair::new(&prepared_a, &prepared_b);
    let contacts = pair.classify(&tolerances()).contacts;
    let [contact] = contacts.as_slice() else { panic!("{}: one contact is drawn, found {contacts:?}", panel.heading) };

    let camera = Camera::new([3.0, -5.0, 2.1], (left + PANEL.0 / 2.0 + 8.0, 186.0), 52.0);
    let touched = match contact.key {
        ContactKey::VertexFace(_, face) => Some((face, TINT)),
        _ => None,
    };
    let edges = touched_edges(contact);
    let block = |svg: &mut Svg, block: &Block, colour, tint, edge: Option<EdgeId>| {
        camera.block(svg, block, colour, tint);
        if let Some(edge) = edge {
            let ends = block.topology().edge(edge);
            svg.line(camera.at(vertex(block, ends.p)), camera.at(vertex(block, ends.q)), ACCENT, 3.0, None);
        }
    };
    // The entrance plane separates the blocks, so the one on the camera's side of it hides the other.
    let a_is_nearer = camera.sees(entrance_normal(&panel.a, &panel.b, &contact.entrance));
    for draws_a in [!a_is_nearer, a_is_nearer] {
        if draws_a {
            block(svg, &panel.a, BLOCK_A, None, edges[0]);
        } else {
            block(svg, &panel.b, BLOCK_B, touched, edges[1]);
        }
    }
    let [on_a, on_b] = contact_points(&panel.a, &panel.b, contact);
    svg.line(camera.at(on_a), camera.at(on_b), ACCENT, 1.6, Some("1 4"));
    svg.dot(camera.at(on_a), 5.0, ACCENT);
    svg.dot(camera.at(on_b), 5.0, ACCENT);
    for (name, block) in [("A", &panel.a), ("B", &panel.b)] {
        svg.text((left + 16.0, camera.at(centre(block)).1 + 5.0), HEADING, name);
    }

    let name = contact.kind().name();
    svg.text((left + 16.0, 28.0), HEADING, &format!("{name}   {}", panel.heading));
    svg.text((left + 16.0, PANEL.1 - 34.0), PLAIN, &described(contact));
    let gap = metres_of(&pair.gap(&contact.entrance));
    svg.text((left + 16.0, PANEL.1 - 16.0), SMALL, &format!("entrance {}, gap {gap}", plane(&contact.entrance)));
}

fn described(contact: &Contact) -> String {
    let [a, b] = match contact.kind() {
        ContactKind::VertexVertex => ["vertex", "vertex"],
        ContactKind::VertexEdge => ["vertex", "edge"],
        ContactKind::EdgeVertex => ["edge", "vertex"],
        ContactKind::VertexFace => ["vertex", "face"],
        ContactKind::FaceVertex => ["face", "vertex"],
        ContactKind::EdgeEdge => ["edge", "edge"],
    };
    let [number_a, number_b] = contact.key.numbers();
    format!("{a} {number_a} of A, {b} {number_b} of B")
}

/// The kind and features of an entrance, in few letters.
pub(super) fn plane(entrance: &Entrance) -> String {
    let [a, b] = entrance.numbers();
    format!("{} ({a}, {b})", entrance.kind())
}

/// A gap in metres, with its sign.
pub(super) fn metres_of(gap: &Gap) -> String {
    let size = Number::from_rational(gap.squared.clone()).approximate().sqrt();
    format!("{:+.3} m", f64::from(gap.sign.as_i8()) * size)
}

/// The edges of A and of B that a contact is on.
fn touched_edges(contact: &Contact) -> [Option<EdgeId>; 2] {
    match contact.key {
        ContactKey::VertexEdge(_, edge) => [None, Some(edge)],
        ContactKey::EdgeVertex(edge, _) => [Some(edge), None],
        ContactKey::EdgeEdge(edge_a, edge_b) => [Some(edge_a), Some(edge_b)],
        _ => [None, None],
    }
}

/// Where a contact is on each block.
pub(super) fn contact_points(a: &Block, b: &Block, contact: &Contact) -> [Metres; 2] {
    match contact.key {
        ContactKey::VertexVertex(v, w) => [vertex(a, v), vertex(b, w)],
        ContactKey::VertexEdge(v, e) => [vertex(a, v), foot_on_edge(vertex(a, v), b, e)],
        ContactKey::EdgeVertex(e, v) => [foot_on_edge(vertex(b, v), a, e), vertex(b, v)],
        ContactKey::VertexFace(v, f) => [vertex(a, v), foot_on_face(vertex(a, v), b, f)],
        ContactKey::FaceVertex(f, v) => [foot_on_face(vertex(b, v), a, f), vertex(b, v)],
        ContactKey::EdgeEdge(edge_a, edge_b) => {
            let ((p, d), (q, e)) = (edge(a, edge_a), edge(b, edge_b));
            let n = cross(d, e);
            let along = |other: Metres| dot(cross(minus(q, p), other), n) / dot(n, n);
            [plus(p, scaled(d, along(e))), plus(q, scaled(e, along(d)))]
        }
    }
}

fn edge(block: &Block, edge: EdgeId) -> (Metres, Metres) {
    let ends = block.topology().edge(edge);
    (vertex(block, ends.p), minus(vertex(block, ends.q), vertex(block, ends.p)))
}

fn foot_on_edge(point: Metres, block: &Block, number: EdgeId) -> Metres {
    let (p, d) = edge(block, number);
    plus(p, scaled(d, dot(minus(point, p), d) / dot(d, d)))
}

fn foot_on_face(point: Metres, block: &Block, face: FaceId) -> Metres {
    let n = unit(normal_of(block, face));
    let in_plane = vertex(block, block.topology().face(face)[0]);
    minus(point, scaled(n, dot(n, minus(point, in_plane))))
}

/// The normal of an entrance from B to A, for blocks that are apart.
pub(super) fn entrance_normal(a: &Block, b: &Block, entrance: &Entrance) -> Metres {
    match *entrance {
        Entrance::VertexFace(_, face) => normal_of(b, face),
        Entrance::FaceVertex(face, _) => scaled(normal_of(a, face), -1.0),
        Entrance::EdgeEdge(edge_a, edge_b) => {
            let ((p, d), (q, e)) = (edge(a, edge_a), edge(b, edge_b));
            let n = cross(d, e);
            if dot(n, minus(p, q)) < 0.0 { scaled(n, -1.0) } else { n }
        }
    }
}

fn centre(block: &Block) -> Metres {
    let count = block.vertices().len();
    scaled(block.topology().vertex_ids().map(|v| vertex(block, v)).fold([0.0; 3], plus), 1.0 / count as f64)
}
