//! Territories of the vertices and edges of a sliver, under the classic and the revised criteria.
//!
//! Each cell shows what the oracle calls the contact of a needle's tip that stands there, just above the face; the outlines
//! are the radii the stepper calculates with.

use super::shapes::{Metres, block, metres, number};
use super::svg::{At, GREY, HEADING, INK, PLAIN, SMALL, Svg};
use rockproof_model::{Block, ContactKind, Criteria, ToleranceSet, VertexId};
use rockproof_oracle::{Pair, PreparedBlock as OracleSolid};
use rockproof_stepper::contact::{ContactRules, SpecRules};
use rockproof_stepper::{PreparedBlock, Tolerances};

/// The sliver's upper face, counter-clockwise, at z = 0.
const OUTLINE: [[f64; 2]; 3] = [[0.0, 0.0], [4.0, 0.0], [4.0, 0.5]];
/// The part of the plane that is shown: least and greatest coordinates.
const SHOWN: [[f64; 2]; 2] = [[-0.4375, -0.4375], [4.4375, 0.9375]];
/// Side of a cell in metres.
const CELL: f64 = 0.03125;
/// Pixels per metre.
const SCALE: f64 = 152.0;
const MARGIN: At = (20.0, 46.0);
const LEGEND: f64 = 40.0;

const KINDS: [(ContactKind, &str, &str); 3] = [
    (ContactKind::VertexVertex, "#e9a3bd", "v-v: belongs to a vertex"),
    (ContactKind::VertexEdge, "#f0d48a", "v-e: belongs to an edge"),
    (ContactKind::VertexFace, "#a9cfa4", "v-f: belongs to the face"),
];

/// The picture.
pub(super) fn draw() -> String {
    let panel = (SHOWN[1][1] - SHOWN[0][1]) * SCALE + MARGIN.1;
    let width = (SHOWN[1][0] - SHOWN[0][0]) * SCALE + 2.0 * MARGIN.0;
    let mut svg = Svg::new(
        width,
        2.0 * panel + LEGEND,
        "Territories on a sliver face under the classic and the revised criteria",
    );
    let classic = "classic: radius s = 0.3 m everywhere; nothing is left of the face";
    let revised = "revised: r = 0.25 m, at most ¼ of the shortest edge or of the face's width there";
    draw_panel(&mut svg, &tolerances(Criteria::Classic), classic, 0.0);
    draw_panel(&mut svg, &tolerances(Criteria::Revised), revised, panel);
    for (k, (_, colour, meaning)) in KINDS.iter().enumerate() {
        let at = (MARGIN.0 + 200.0 * k as f64, 2.0 * panel + 12.0);
        svg.rectangle(at, (14.0, 14.0), colour);
        svg.text((at.0 + 20.0, at.1 + 12.0), PLAIN, meaning);
    }
    svg.text((MARGIN.0 + 600.0, 2.0 * panel + 24.0), SMALL, "seen from above");
    svg.finish()
}

fn tolerances(criteria: Criteria) -> ToleranceSet {
    ToleranceSet {
        search: number(0.3),
        territory: number(0.25),
        penetration: number(0.0625),
        overlap_sine: number(0.046875),
        parallel_sine: number(0.046875),
        max_displacement: number(0.0625),
        max_rotation: number(0.0625),
        criteria,
        ..ToleranceSet::ZERO
    }
}

fn sliver() -> Block {
    let [a, b, c] = OUTLINE;
    let vertices: Vec<Metres> = [0.0, -1.0].into_iter().flat_map(|z| [a, b, c].map(|[x, y]| [x, y, z])).collect();
    block(&vertices, &[&[0, 1, 2], &[5, 4, 3], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]])
}

/// A needle with its tip, vertex 0, just above the point (x, y) of the plane.
fn needle(x: f64, y: f64) -> Block {
    const ABOVE: f64 = 0.015625;
    let base = [[0.03125, 0.0], [-0.015625, 0.03125], [-0.015625, -0.03125]];
    let mut vertices: Vec<Metres> = vec![[x, y, ABOVE]];
    vertices.extend(base.map(|[u, v]| [x + u, y + v, 2.0]));
    block(&vertices, &[&[1, 2, 3], &[0, 2, 1], &[0, 3, 2], &[0, 1, 3]])
}

/// The kind of contact of a needle's tip above (x, y).
fn kind_at(sliver: &OracleSolid, t: &ToleranceSet, x: f64, y: f64) -> Option<ContactKind> {
    let needle = OracleSolid::new(&needle(x, y));
    let contacts = Pair::new(&needle, sliver).classify(t).contacts;
    contacts.into_iter().find(|contact| contact.kind() != ContactKind::EdgeEdge).map(|contact| contact.kind())
}

fn draw_panel(svg: &mut Svg, t: &ToleranceSet, heading: &str, top: f64) {
    let block = sliver();
    let at =
        |[x, y]: [f64; 2]| -> At { (MARGIN.0 + (x - SHOWN[0][0]) * SCALE, top + MARGIN.1 + (SHOWN[1][1] - y) * SCALE) };
    svg.text((MARGIN.0, top + 30.0), HEADING, heading);
    draw_kinds(svg, &OracleSolid::new(&block), t, at);
    draw_radii(svg, &block, t, at);
    svg.outline(&OUTLINE.map(at), INK, 2.2);
}

fn draw_kinds(svg: &mut Svg, sliver: &OracleSolid, t: &ToleranceSet, at: impl Fn([f64; 2]) -> At) {
    let count = |axis: usize| ((SHOWN[1][axis] - SHOWN[0][axis]) / CELL) as usize;
    for row in 0..count(1) {
        let y = SHOWN[0][1] + CELL * row as f64;
        let kinds: Vec<Option<ContactKind>> =
            (0..count(0)).map(|k| kind_at(sliver, t, SHOWN[0][0] + CELL * (k as f64 + 0.5), y + CELL / 2.0)).collect();
        // Cells of one colour side by side become one rectangle.
        let mut from = 0;
        for run in kinds.chunk_by(|a, b| a == b) {
            if let Some((_, colour, _)) = KINDS.iter().find(|(kind, _, _)| run[0] == Some(*kind)) {
                let corner = at([SHOWN[0][0] + CELL * from as f64, y + CELL]);
                svg.rectangle(corner, (CELL * SCALE * run.len() as f64 + 0.3, CELL * SCALE + 0.3), colour);
            }
            from += run.len();
        }
    }
}

fn draw_radii(svg: &mut Svg, block: &Block, t: &ToleranceSet, at: impl Fn([f64; 2]) -> At) {
    let prepared = PreparedBlock::<f64>::new(block).expect("the sliver has extent");
    let t = Tolerances::<f64>::new(t).expect("the tolerances are finite");
    for v in (0..OUTLINE.len()).map(VertexId::at) {
        let radius = SpecRules::vertex_radius(&t, prepared.vertex(v).shortest);
        let [x, y, _] = metres(&block.vertices()[v.index()]);
        svg.ring(at([x, y]), radius * SCALE, GREY);
    }
    for k in 0..OUTLINE.len() as u32 {
        let Some(e) = block.topology().edge_between(VertexId(k), VertexId((k + 1) % OUTLINE.len() as u32)) else {
            continue;
        };
        let ridge = prepared.edge(e);
        let [left, right] = prepared.widths(e);
        let radius = SpecRules::edge_radius(&t, left, right);
        let ends = [ridge.p, ridge.q].map(|p| [p.x, p.y]);
        let across = [-ridge.direction.y * radius, ridge.direction.x * radius];
        for side in [-1.0, 1.0] {
            let [p, q] = ends.map(|[x, y]| at([x + side * across[0], y + side * across[1]]));
            svg.line(p, q, GREY, 1.2, None);
        }
    }
}
