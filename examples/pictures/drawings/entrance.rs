//! The entrance of a v-v contact: the planes two corners can enter one another through, and the one chosen.

use super::axonometric::{Camera, cross, plus, scaled, unit};
use super::contact_types::{
    contact_points, entrance_normal, metres_of, plane, standing_on_a_corner, tolerances, with_a_corner_on_top,
};
use super::shapes::Metres;
use super::svg::{ACCENT, At, BLOCK_A, BLOCK_B, GREY, HEADING, PLAIN, SMALL, Svg, Text};
use rockproof_model::decision::{Feature, Predicate};
use rockproof_model::{Block, Entrance, Number};
use rockproof_oracle::{Gap, Pair, PreparedBlock, TraceEntry};

const PANEL: At = (214.0, 318.0);
const LIST: f64 = 318.0;
/// Half the side of a drawn piece of a plane, in metres.
const HALF: f64 = 0.85;

struct Candidate {
    entrance: Entrance,
    gap: Gap,
    chosen: bool,
}

/// The picture.
pub(super) fn draw() -> String {
    let a = standing_on_a_corner([0.125, -0.0625, 0.4375]);
    let b = with_a_corner_on_top([0.0; 3]);
    let (prepared_a, prepared_b) = (PreparedBlock::new(&a), PreparedBlock::new(&b));
    let pair = Pair::new(&prepared_a, &prepared_b);
    let trace = pair.trace(&tolerances());
    let candidates: Vec<Candidate> = trace
        .iter()
        .filter_map(|entry| {
            let entrance = entrance_asked(entry)?;
            Some(Candidate { entrance, gap: pair.gap(&entrance), chosen: entry.outcome == 1 })
        })
        .collect();
    let contacts = pair.classify(&tolerances()).contacts;
    let [contact] = contacts.as_slice() else { panic!("one contact is drawn, found {contacts:?}") };
    let mut shown: Vec<&Candidate> = candidates.iter().collect();
    // Ascending: all of them are apart.
    shown.sort_by(|c, d| c.gap.squared.cmp(&d.gap.squared));
    let pick = [shown[0], shown[shown.len() / 2], shown[shown.len() - 1]];
    let ends = contact_points(&a, &b, contact);

    let width = 3.0 * PANEL.0 + LIST;
    let mut svg =
        Svg::new(width, PANEL.1, "The entrance of a vertex-to-vertex contact: the passing plane with the largest gap");
    for (k, candidate) in pick.into_iter().enumerate() {
        draw_panel(&mut svg, [&a, &b], ends, candidate, PANEL.0 * k as f64);
    }
    draw_list(&mut svg, &candidates, 3.0 * PANEL.0 + 20.0);
    svg.finish()
}

fn draw_panel(svg: &mut Svg, [a, b]: [&Block; 2], [on_a, on_b]: [Metres; 2], candidate: &Candidate, left: f64) {
    let camera = Camera::new([3.0, -5.0, 2.1], (left + PANEL.0 / 2.0, 190.0), 52.0);
    let normal = unit(entrance_normal(a, b, &candidate.entrance));
    let colour = if candidate.chosen { ACCENT } else { GREY };
    let tile = |through: Metres| square(normal, through).map(|corner| camera.at(corner));
    // A plane that passes has A on one side and B on the other: the one on the camera's side hides the plane.
    let (nearer, further) = ((a, BLOCK_A), (b, BLOCK_B));
    let (nearer, further) = if camera.sees(normal) { (nearer, further) } else { (further, nearer) };
    camera.block(svg, further.0, further.1, None);
    svg.glass(&tile(on_b), colour, 0.25);
    svg.glass(&tile(on_a), colour, 0.25);
    camera.block(svg, nearer.0, nearer.1, None);
    svg.line(camera.at(on_a), camera.at(on_b), colour, 1.6, Some("1 4"));
    svg.dot(camera.at(on_a), 5.0, colour);
    svg.dot(camera.at(on_b), 5.0, colour);
    let chosen = if candidate.chosen { "   chosen" } else { "" };
    let heading = Text { colour, ..HEADING };
    svg.text((left + 16.0, 28.0), heading, &format!("{}{chosen}", plane(&candidate.entrance)));
    svg.text((left + 16.0, PANEL.1 - 16.0), PLAIN, &format!("gap {}", metres_of(&candidate.gap)));
}

/// A square piece of the plane with this unit normal.
fn square(normal: Metres, centre: Metres) -> [Metres; 4] {
    let u = scaled(unit(cross([0.0, 1.0, 0.0], normal)), HALF);
    let v = cross(normal, u);
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(s, t)| plus(centre, plus(scaled(u, s), scaled(v, t))))
}

fn draw_list(svg: &mut Svg, candidates: &[Candidate], left: f64) {
    svg.text((left, 28.0), HEADING, "all planes that pass");
    let size = |c: &Candidate| Number::from_rational(c.gap.squared.clone()).approximate().sqrt();
    for (k, candidate) in candidates.iter().enumerate() {
        let y = 58.0 + 26.0 * k as f64;
        let style =
            Text { bold: candidate.chosen, colour: if candidate.chosen { ACCENT } else { PLAIN.colour }, ..PLAIN };
        svg.text((left, y), style, &plane(&candidate.entrance));
        let bar = 220.0 * size(candidate);
        svg.rectangle((left + 76.0, y - 11.0), (bar, 13.0), if candidate.chosen { ACCENT } else { "#b9b2a8" });
        svg.text((left + 84.0 + bar, y), style, &metres_of(&candidate.gap));
    }
    let y = 58.0 + 26.0 * candidates.len() as f64 + 8.0;
    for (k, line) in [
        "Apart, the largest gap is where the blocks",
        "first enter; overlapping, the largest gap",
        "is the shortest way out.",
    ]
    .into_iter()
    .enumerate()
    {
        svg.text((left, y + 17.0 * k as f64), SMALL, line);
    }
}

fn entrance_asked(entry: &TraceEntry) -> Option<Entrance> {
    if entry.decision.predicate != Predicate::EntranceChoice {
        return None;
    }
    match [entry.decision.features()[2]?, entry.decision.features()[3]?] {
        [Feature::Vertex(_, a), Feature::Face(_, b)] => Some(Entrance::VertexFace(a, b)),
        [Feature::Face(_, a), Feature::Vertex(_, b)] => Some(Entrance::FaceVertex(a, b)),
        [Feature::Edge(_, a), Feature::Edge(_, b)] => Some(Entrance::EdgeEdge(a, b)),
        _ => None,
    }
}
