//! Whether a face loop is a simple polygon, seen along the face's normal.

use crate::block::certain_sign::Surface;
use crate::block::polynomials::{Between, Orientation};
use crate::topology::{VertexId, loop_pairs};

type Segment = (VertexId, VertexId);

/// Checks that no two edges of the loop of a face with area cross or touch, other than neighbours in their vertex.
/// `slack` is how far, in metres, the face's vertices may be from its plane.
pub(super) fn check_simple(
    surface: &Surface<'_>,
    face: usize,
    approximate: &[[f64; 3]],
    slack: f64,
) -> Result<(), (Segment, Segment)> {
    let boundary = &surface.faces()[face];
    if boundary.len() == 3 || is_surely_convex(surface, face) {
        return Ok(());
    }
    let edges: Vec<Segment> = loop_pairs(boundary).collect();
    let spans: Vec<[(f64, f64); 3]> = edges.iter().map(|&edge| span(edge, approximate, slack)).collect();
    let mut order: Vec<usize> = (0..edges.len()).collect();
    order.sort_by(|&i, &j| spans[i][0].0.total_cmp(&spans[j][0].0));
    let mut worst: Option<(usize, usize)> = None;
    for (place, &i) in order.iter().enumerate() {
        for &j in order[place + 1..].iter().take_while(|&&j| spans[j][0].0 <= spans[i][0].1) {
            let apart = (1..3).any(|axis| spans[j][axis].0 > spans[i][axis].1 || spans[i][axis].0 > spans[j][axis].1);
            if !apart && meet(surface, face, edges[i], edges[j]) {
                let pair = (i.min(j), i.max(j));
                worst = Some(worst.map_or(pair, |w| w.min(pair)));
            }
        }
    }
    match worst {
        Some((i, j)) => Err((edges[i], edges[j])),
        None => Ok(()),
    }
}

/// A box around an edge, wide enough that edges which meet along the face's normal have boxes that meet.
fn span((p, q): Segment, approximate: &[[f64; 3]], slack: f64) -> [(f64, f64); 3] {
    std::array::from_fn(|axis| {
        let (a, b) = (approximate[p.index()][axis], approximate[q.index()][axis]);
        let margin = 2.0 * slack + (a.abs() + b.abs()) * 1e-12;
        (a.min(b) - margin, a.max(b) + margin)
    })
}

/// Whether every vertex is certainly to the left of every edge: then the loop is the boundary of its convex hull.
fn is_surely_convex(surface: &Surface<'_>, face: usize) -> bool {
    const LONGEST: usize = 24;
    let boundary = &surface.faces()[face];
    let n = boundary.len();
    n <= LONGEST
        && (0..n).all(|k| {
            let (a, b) = (boundary[k], boundary[(k + 1) % n]);
            (2..n).all(|i| {
                let turn = Orientation { face, a, b, c: boundary[(k + i) % n] };
                surface.estimate(&turn).and_then(|t| t.sign()).is_some_and(|s| s.is_positive())
            })
        })
}

/// Whether two edges of a loop have a point in common that no simple polygon allows.
fn meet(surface: &Surface<'_>, face: usize, (a, b): Segment, (c, d): Segment) -> bool {
    let turn = |a, b, c| surface.sign(&Orientation { face, a, b, c });
    let between = |a, b, c| surface.sign(&Between { face, a, b, c }).is_at_most_zero();
    // Neighbours share a vertex; they overlap when they leave it in the same direction.
    let shared = [(a, b, c, d), (b, a, c, d), (a, b, d, c), (b, a, d, c)].into_iter().find(|&(a, _, c, _)| a == c);
    if let Some((corner, one, _, other)) = shared {
        return turn(corner, one, other).is_zero() && !between(one, other, corner);
    }
    let [c_side, d_side, a_side, b_side] = [turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b)];
    (c_side.times(d_side).is_negative() && a_side.times(b_side).is_negative())
        || (c_side.is_zero() && between(a, b, c))
        || (d_side.is_zero() && between(a, b, d))
        || (a_side.is_zero() && between(c, d, a))
        || (b_side.is_zero() && between(c, d, b))
}
