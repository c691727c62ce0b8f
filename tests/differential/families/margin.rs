//! The margins of `rockproof_pairs::directed`, evaluated in plain fractions straight from SPEC section 4.

// Longer than 400 lines: every margin evaluated a second time, to be read beside SPEC section 4 as a whole.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{Block, Criteria, EdgeId, FaceId, Sign, ToleranceSet, VertexId, fraction};
use rockproof_pairs::batch::{PairCase, PairForm};

pub(crate) type Q = BigRational;
pub(crate) type V = [Q; 3];

pub(crate) fn points(block: &Block) -> Vec<V> {
    block.vertices().iter().map(|v| v.components().map(|c| c.to_rational())).collect()
}

pub(crate) fn approximate(q: &Q) -> f64 {
    q.to_f64().unwrap()
}

pub(crate) fn minus(a: &V, b: &V) -> V {
    [0, 1, 2].map(|k: usize| fraction::difference(&a[k], &b[k]))
}

pub(crate) fn dot(a: &V, b: &V) -> Q {
    let [x, y, z] = [0, 1, 2].map(|k: usize| fraction::product(&a[k], &b[k]));
    fraction::sum(&fraction::sum(&x, &y), &z)
}

pub(crate) fn cross(a: &V, b: &V) -> V {
    let times = |i: usize, j: usize| fraction::product(&a[i], &b[j]);
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| fraction::difference(&times(i, j), &times(j, i)))
}

fn square(a: &V) -> Q {
    dot(a, a)
}

pub(crate) fn normal(points: &[V], face: &[VertexId]) -> V {
    let at = |k: usize| minus(&points[face[k].index()], &points[face[0].index()]);
    (1..face.len() - 1)
        .map(|k| cross(&at(k), &at(k + 1)))
        .fold([Q::zero(), Q::zero(), Q::zero()], |s, n| [&s[0] + &n[0], &s[1] + &n[1], &s[2] + &n[2]])
}

fn whole(n: i64) -> Q {
    Q::from_integer(BigInt::from(n))
}

fn sign(q: &Q) -> Sign {
    if q.is_zero() {
        Sign::Zero
    } else if q.is_positive() {
        Sign::Positive
    } else {
        Sign::Negative
    }
}

/// The sign of `a + b·√n`, n ≥ 0.
fn sign_with_root(a: &Q, b: &Q, n: &Q) -> Sign {
    let (sa, sb) = (sign(a), if n.is_zero() { Sign::Zero } else { sign(b) });
    if sa == sb || sb.is_zero() {
        return sa;
    }
    if sa.is_zero() {
        return sb;
    }
    match (a * a).cmp(&(b * b * n)) {
        std::cmp::Ordering::Greater => sa,
        std::cmp::Ordering::Equal => Sign::Zero,
        std::cmp::Ordering::Less => sb,
    }
}

/// A pair in fractions.
struct Pair<'c> {
    blocks: [&'c Block; 2],
    points: [Vec<V>; 2],
    set: &'c ToleranceSet,
    /// Whether a ladder is across an angle, or across a length; nothing where the pair is of no ladder.
    across_angle: Option<bool>,
}

impl Pair<'_> {
    fn v(&self, side: Side, v: VertexId) -> &V {
        &self.points[side as usize][v.index()]
    }

    fn ends(&self, side: Side, e: EdgeId) -> (&V, V) {
        let edge = self.blocks[side as usize].topology().edge(e);
        (self.v(side, edge.p), minus(self.v(side, edge.q), self.v(side, edge.p)))
    }

    fn away(&self, side: Side, v: VertexId, e: EdgeId) -> V {
        let edge = self.blocks[side as usize].topology().edge(e);
        minus(self.v(side, edge.other(v)), self.v(side, v))
    }

    fn loop_of(&self, side: Side, f: FaceId) -> &[VertexId] {
        &self.blocks[side as usize].topology().faces()[f.index()]
    }

    fn normal(&self, side: Side, f: FaceId) -> V {
        normal(&self.points[side as usize], self.loop_of(side, f))
    }

    fn inward(&self, side: Side, e: EdgeId, f: FaceId) -> V {
        let (_, d) = self.ends(side, e);
        let m = cross(&self.normal(side, f), &d);
        let left = self.blocks[side as usize].topology().edge(e).left == f;
        if left { m } else { m.map(|c| -c) }
    }

    fn width2(&self, side: Side, e: EdgeId, f: FaceId) -> Q {
        let (p, d) = self.ends(side, e);
        let far = self.loop_of(side, f).iter().map(|&v| square(&cross(&minus(self.v(side, VertexId(v.0)), p), &d)));
        far.max().unwrap() / square(&d)
    }

    /// `N·(x − c)` and `|N|²`.
    fn gap(&self, side: Side, v: VertexId, f: FaceId) -> (Q, Q) {
        let other = side.other();
        let n = self.normal(other, f);
        let corners = self.loop_of(other, f);
        let mean = [0, 1, 2].map(|i| {
            corners.iter().map(|&v| self.v(other, VertexId(v.0))[i].clone()).fold(Q::zero(), |s, c| s + c)
                / whole(corners.len() as i64)
        });
        (dot(&n, &minus(self.v(side, v), &mean)), square(&n))
    }

    /// The gap's square with the gap's sign.
    fn signed_gap2(&self, side: Side, v: VertexId, f: FaceId) -> Q {
        let (q, n) = self.gap(side, v, f);
        q.signum() * &q * &q / n
    }

    fn shortest2(&self, side: Side, v: VertexId) -> Q {
        let edges = self.blocks[side as usize].topology().vertex_edges(v);
        edges.iter().map(|&e| square(&self.ends(side, e).1)).min().unwrap()
    }

    fn perpendicular(&self, e: EdgeId, f: EdgeId) -> V {
        let n = cross(&self.ends(Side::A, e).1, &self.ends(Side::B, f).1);
        let sum = |side: Side, e: EdgeId| {
            let edge = self.blocks[side as usize].topology().edge(e);
            dot(&n, &self.inward(side, e, edge.left)) + dot(&n, &self.inward(side, e, edge.right))
        };
        if (sum(Side::A, e) - sum(Side::B, f)).is_negative() { n.map(|c| -c) } else { n }
    }

    fn revised(&self) -> bool {
        self.set.criteria == Criteria::Revised
    }

    /// The margin of a decision that needs both measures. Where both say yes, that of the one that the ladder is across.
    fn both(&self, angle: Sign, length: Sign) -> Sign {
        match self.across_angle {
            Some(across_angle) if angle.min(length) != Sign::Negative => {
                if across_angle {
                    angle
                } else {
                    length
                }
            }
            _ => angle.min(length),
        }
    }

    fn neighbours(&self) -> Sign {
        let s = self.set.search.to_rational();
        let margins = (0..3).flat_map(|i| {
            let bound = |side: usize, high: bool| {
                let along = self.points[side].iter().map(|p| &p[i]);
                if high { along.max().unwrap().clone() } else { along.min().unwrap().clone() }
            };
            [bound(0, true) + &s - bound(1, false), bound(1, true) + &s - bound(0, false)]
        });
        sign(&margins.min().unwrap())
    }

    fn cone(&self, side: Side, v: VertexId, f: FaceId, e: EdgeId) -> Sign {
        let (n, e) = (self.normal(side.other(), f), self.away(side, v, e));
        let dip = dot(&n, &e);
        if !dip.is_negative() {
            return Sign::Positive;
        }
        self.dip(&dip, &square(&n), &square(&e), &square(&e))
    }

    fn dip(&self, dip: &Q, n2: &Q, arm2: &Q, width2: &Q) -> Sign {
        let so = self.set.overlap_sine.to_rational();
        let by_sine = sign(&(&so * &so * n2 * arm2 - dip * dip));
        let g = self.set.penetration.to_rational();
        let by_depth = sign(&(&g * &g * n2 * arm2 - dip * dip * width2));
        if self.revised() { self.both(by_sine, by_depth) } else { by_sine }
    }

    /// How far a dip is within a tenth of r.
    fn true_exit_dip(&self, dip: &Q, n2: &Q, arm2: &Q, width2: &Q) -> Sign {
        let tenth = self.set.territory.to_rational() / whole(10);
        sign(&(&tenth * &tenth * n2 * arm2 - dip * dip * width2))
    }

    /// Whether the plane of a vertex and a face is a true exit: the worst over the edges that dip.
    fn true_exit_of_face(&self, side: Side, v: VertexId, f: FaceId) -> Sign {
        let n = self.normal(side.other(), f);
        let edges = self.blocks[side as usize].topology().vertex_edges(v);
        let arms = edges.iter().map(|&e| self.away(side, v, e)).filter(|arm| dot(&n, arm).is_negative());
        let worst = arms.map(|arm| self.true_exit_dip(&dot(&n, &arm), &square(&n), &square(&arm), &square(&arm))).min();
        if self.revised() { worst.unwrap_or(Sign::Positive) } else { Sign::Positive }
    }

    fn wedges(&self, e: EdgeId, f: EdgeId) -> Sign {
        self.worst_wedge(e, f, Self::dip)
    }

    fn true_exit_of_edges(&self, e: EdgeId, f: EdgeId) -> Sign {
        if self.revised() { self.worst_wedge(e, f, Self::true_exit_dip) } else { Sign::Positive }
    }

    /// The worst over the faces at two edges that dip.
    fn worst_wedge(&self, e: EdgeId, f: EdgeId, margin: fn(&Self, &Q, &Q, &Q, &Q) -> Sign) -> Sign {
        let n = self.perpendicular(e, f);
        let mut worst = Sign::Positive;
        for (side, edge) in [(Side::A, e), (Side::B, f)] {
            let both = self.blocks[side as usize].topology().edge(edge);
            for face in [both.left, both.right] {
                let m = self.inward(side, edge, face);
                let dip = if side == Side::A { dot(&n, &m) } else { -dot(&n, &m) };
                if dip.is_negative() {
                    worst = worst.min(margin(self, &dip, &square(&n), &square(&m), &self.width2(side, edge, face)));
                }
            }
        }
        worst
    }

    fn parallel(&self, e: EdgeId, f: EdgeId) -> Sign {
        let ((_, d), (_, c)) = (self.ends(Side::A, e), self.ends(Side::B, f));
        let n2 = square(&cross(&d, &c));
        let sp = self.set.parallel_sine.to_rational();
        let r = self.set.territory.to_rational();
        let by_sine = sign(&(&sp * &sp * square(&d) * square(&c) - &n2));
        let by_drift = sign(&(&r * &r * square(&d).max(square(&c)) - &n2));
        if self.revised() { self.both(by_sine, by_drift) } else { by_sine }
    }

    fn feet_inside(&self, e: EdgeId, f: EdgeId) -> Sign {
        let ((p, d), (q, c)) = (self.ends(Side::A, e), self.ends(Side::B, f));
        let n = cross(&d, &c);
        let nn = square(&n);
        let pq = minus(q, p);
        let (s, t) = (dot(&cross(&pq, &c), &n), dot(&cross(&pq, &d), &n));
        [&nn - &s, &nn - &t, s, t].iter().map(sign).min().unwrap()
    }

    fn inside_face(&self, side: Side, v: VertexId, f: FaceId) -> Option<Sign> {
        let other = side.other();
        if !self.blocks[other as usize].face_is_convex(f) {
            return None;
        }
        let (n, corners) = (self.normal(other, f), self.loop_of(other, f));
        let x = self.v(side, v);
        (0..corners.len())
            .map(|k| {
                let (p, q) = (
                    self.v(other, VertexId(corners[k].0)),
                    self.v(other, VertexId(corners[(k + 1) % corners.len()].0)),
                );
                sign(&dot(&minus(x, p), &cross(&n, &minus(q, p))))
            })
            .min()
    }

    /// Whether two faces' gaps are equal, or the first smaller by the share ε of the second.
    fn tie(&self, side: Side, v: VertexId, first: FaceId, second: FaceId) -> bool {
        let (h1, h2) = (self.signed_gap2(side, v, first), self.signed_gap2(side, v, second));
        let share = self.set.equal.to_rational();
        let factor = whole(1) - if h2.is_negative() { -share } else { share };
        h1 == h2 || h1 == &h2 * &factor * &factor
    }
}

/// The sign of the margin of the decision a pair was aimed at; `None` where its definition names no single value.
pub(crate) fn margin(case: &PairCase) -> Option<Sign> {
    let decision = case.form.decision()?;
    let pair = Pair {
        blocks: [&case.a, &case.b],
        points: [points(&case.a), points(&case.b)],
        set: case.sets[0].of(case.aimed_for),
        across_angle: match &case.form {
            PairForm::Ladder { tolerance, .. } => Some(tolerance.ends_with("_sine")),
            _ => None,
        },
    };
    let set = pair.set;
    let (s, r, g) = (set.search.to_rational(), set.territory.to_rational(), set.penetration.to_rational());
    let sixteenth = Q::new(1.into(), 16.into());
    use Feature::{Edge, Face, Vertex};
    let [f0, f1, f2, f3] = decision.features();
    Some(match (decision.predicate, f0, f1) {
        (Predicate::Neighbours, ..) => pair.neighbours(),
        (p @ (Predicate::VertexVertexNear | Predicate::VertexTerritory), Some(Vertex(..)), Some(Vertex(_, b))) => {
            let Some(Vertex(_, a)) = f0 else { return None };
            let limit = if p == Predicate::VertexTerritory && pair.revised() {
                let shortest = pair.shortest2(Side::A, a).min(pair.shortest2(Side::B, b));
                (&r * &r).min(shortest * sixteenth)
            } else {
                &s * &s
            };
            sign(&(limit - square(&minus(pair.v(Side::A, a), pair.v(Side::B, b)))))
        }
        (Predicate::VertexRegion, Some(Vertex(side, v)), Some(Vertex(_, w))) => {
            let Some(Edge(_, e)) = f2 else { return None };
            let away = pair.away(side.other(), w, e);
            sign(&-dot(&minus(pair.v(side, v), pair.v(side.other(), w)), &away))
        }
        (predicate, Some(Vertex(side, v)), Some(Edge(_, e))) => {
            let (p, d) = pair.ends(side.other(), e);
            let x = minus(pair.v(side, v), p);
            let dd = square(&d);
            let along = dot(&x, &d);
            let distance2 = square(&cross(&x, &d)) / &dd;
            match predicate {
                Predicate::FootInside => sign(&along).min(sign(&(&dd - &along))),
                Predicate::VertexEdgeNear => sign(&(&s * &s - distance2)),
                Predicate::EdgeTerritory => {
                    let limit = if pair.revised() {
                        let edge = pair.blocks[side.other() as usize].topology().edge(e);
                        let width =
                            pair.width2(side.other(), e, edge.left).min(pair.width2(side.other(), e, edge.right));
                        (&r * &r).min(width * sixteenth)
                    } else {
                        &s * &s
                    };
                    sign(&(limit - distance2))
                }
                Predicate::EdgeRegion => {
                    let Some(Face(_, f)) = f2 else { return None };
                    sign(&-dot(&x, &pair.inward(side.other(), e, f)))
                }
                Predicate::FootRegion => {
                    let Some(Edge(_, at)) = f2 else { return None };
                    let share = along / dd;
                    let foot = [0, 1, 2].map(|i| &d[i] * &share - &x[i]);
                    sign(&-dot(&foot, &pair.away(side, v, at)))
                }
                _ => return None,
            }
        }
        (Predicate::InsideFace, Some(Vertex(side, v)), Some(Face(_, f))) => pair.inside_face(side, v, f)?,
        (Predicate::ConePasses, Some(Vertex(side, v)), Some(Face(_, f))) => {
            let Some(Edge(_, e)) = f2 else { return None };
            pair.cone(side, v, f, e)
        }
        (Predicate::ShortestExit, Some(Vertex(side, v)), Some(Face(_, f))) => {
            let block = pair.blocks[side.other() as usize];
            let edges = block.topology().edges().iter().enumerate();
            let mut joined =
                edges.filter(|(i, e)| block.edge_is_convex(EdgeId(*i as u32)) && (e.left == f || e.right == f));
            let tie = joined.any(|(_, e)| {
                pair.tie(side, v, FaceId(f.0), if e.left == f { FaceId(e.right.0) } else { FaceId(e.left.0) })
            });
            return (case.margin == Some(Sign::Zero)).then_some(if tie { Sign::Zero } else { Sign::Negative });
        }
        (Predicate::OneExit, Some(_), Some(_)) => return None,
        (Predicate::TrueExit, Some(Vertex(side, v)), Some(Face(_, f)))
        | (Predicate::TrueExit, Some(Face(_, f)), Some(Vertex(side, v))) => pair.true_exit_of_face(side, v, f),
        (predicate, Some(Vertex(side, v)), Some(Face(_, f)))
        | (predicate @ Predicate::GapSign, Some(Face(_, f)), Some(Vertex(side, v))) => {
            let (q, n) = pair.gap(side, v, f);
            match predicate {
                Predicate::VertexFaceNear => sign_with_root(&-q, &s, &n),
                Predicate::VertexFaceDepth => sign_with_root(&q, &g, &n),
                Predicate::GapSign => sign(&q),
                _ => return None,
            }
        }
        (Predicate::EntranceDepth, Some(Vertex(_, a)), Some(Vertex(_, b))) => {
            // Which face is the way in is decided by others; at the tie one of the corners' faces is g away.
            let tie = |side: Side, v: VertexId, owner: VertexId| {
                let faces = pair.blocks[side.other() as usize].topology().vertex_faces(owner);
                faces.iter().any(|&f| pair.signed_gap2(side, v, f) == -(&g * &g))
            };
            let hit = tie(Side::A, a, b) || tie(Side::B, b, a);
            return (case.margin == Some(Sign::Zero)).then_some(if hit { Sign::Zero } else { Sign::Negative });
        }
        (Predicate::EntranceChoice, Some(Vertex(_, a)), Some(Vertex(_, b))) => {
            let (side, v, owner, first) = match (f2, f3) {
                (Some(Vertex(Side::A, _)), Some(Face(_, f))) => (Side::A, a, b, f),
                (Some(Face(_, f)), Some(Vertex(Side::B, _))) => (Side::B, b, a, f),
                _ => return None,
            };
            let faces = pair.blocks[side.other() as usize].topology().vertex_faces(owner);
            if let PairForm::Ladder { .. } = case.form {
                let edges = pair.blocks[side as usize].topology().vertex_edges(v);
                let passes = |f: &&FaceId| edges.iter().all(|&e| pair.cone(side, v, **f, e) != Sign::Negative);
                let passing: Vec<FaceId> = faces.iter().filter(passes).copied().collect();
                let is_true = |f: &&FaceId| pair.true_exit_of_face(side, v, **f) != Sign::Negative;
                let gap = |&f: &FaceId| pair.signed_gap2(side, v, f);
                let among_true = passing.iter().filter(is_true).map(gap).max();
                let best = among_true.or_else(|| passing.iter().map(gap).max())?;
                let h = pair.signed_gap2(side, v, first);
                // ε − |1 − √(h²/best²)| with a rational root.
                let ratio = h / best;
                if ratio.is_negative() {
                    return None;
                }
                let root = Q::new((ratio.numer() * ratio.denom()).sqrt(), ratio.denom().clone());
                sign(&(set.equal.to_rational() - (whole(1) - root).abs()))
            } else {
                let tie = faces.iter().any(|&f| f != first && pair.tie(side, v, first, f));
                return (case.margin == Some(Sign::Zero)).then_some(if tie { Sign::Zero } else { Sign::Negative });
            }
        }
        (predicate, Some(Edge(_, e)), Some(Edge(_, f))) => {
            let n = pair.perpendicular(e, f);
            let q = dot(&n, &minus(pair.ends(Side::A, e).0, pair.ends(Side::B, f).0));
            match predicate {
                Predicate::NearlyParallel => pair.parallel(e, f),
                Predicate::FeetInside => pair.feet_inside(e, f),
                Predicate::EdgeEdgeNear => sign_with_root(&-q, &s, &square(&n)),
                Predicate::EdgeEdgeDepth => sign_with_root(&q, &g, &square(&n)),
                Predicate::GapSign => sign(&q),
                Predicate::WedgesPass => pair.wedges(e, f),
                Predicate::TrueExit => pair.true_exit_of_edges(e, f),
                _ => return None,
            }
        }
        _ => return None,
    })
}
