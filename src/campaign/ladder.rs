//! Ladders across a tolerance: its critical value for one decision of a pair as it stands, and the values a few steps
//! of the number format, or some percent, to either side.

use crate::campaign::directed::Rung;
use crate::campaign::directed::exact::{Exact, Root};
use crate::campaign::directed::shadow::{Shadow, V, cross, length, minus, plus, quantum, times};
use crate::campaign::families::Kit;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::number::round_rational;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, Criteria, Number, Precision, Sign, ToleranceSet, Vec3};

/// The tolerances that classification uses, as they are named in files.
pub const TOLERANCES: [&str; 6] = ["search", "territory", "penetration", "overlap_sine", "parallel_sine", "equal"];

/// The value of a tolerance at which one decision turns from no (below) to yes (at and above).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Critical {
    /// The decision.
    pub decision: Decision,
    /// Which tolerance it is compared with.
    pub tolerance: &'static str,
    /// The square of the critical value (m², or dimensionless).
    pub squared: BigRational,
    /// The critical value, rounded to f64 where it is irrational.
    pub value: Number,
    /// Whether `value` is the critical value itself.
    pub exact: bool,
    /// How far B is to be moved first (m), where the pair as it stands would not ask the decision.
    pub offset: Option<[Number; 3]>,
}

impl Critical {
    fn new(decision: Decision, tolerance: &'static str, squared: BigRational) -> Option<Critical> {
        if !squared.is_positive() {
            return None;
        }
        let (numerator, denominator) = (Root::of(squared.numer()), Root::of(squared.denom()));
        let exact = numerator.is_exact() && denominator.is_exact();
        let value = if exact {
            Number::from_rational(BigRational::new(numerator.root, denominator.root))
        } else {
            // √(n/d) = √(n·d)/d
            let product = Root::of(&(squared.numer() * squared.denom()));
            let near = BigRational::new(product.root, squared.denom() << product.shift);
            Number::from_f64(round_rational(&near, Precision::F64)?).ok()?
        };
        Some(Critical { decision, tolerance, squared, value, exact, offset: None })
    }

    /// The tolerance's value at a rung, and the margin there: positive where the answer is yes with room to spare.
    /// `None` where the rung asks for an exact tie and the critical value is irrational, or where the value would be
    /// negative or overflow.
    pub fn at(&self, rung: Rung) -> Option<(Number, Sign)> {
        let value = match rung {
            Rung::Exact => return self.exact.then(|| (self.value.clone(), Sign::Zero)),
            Rung::Steps(precision, steps) => {
                let near = self.value.rounded(precision)?;
                near + steps as f64 * quantum(near, precision)
            }
            Rung::Permille(share) => self.value.approximate() * (1000.0 + f64::from(share)) / 1000.0,
        };
        if value < 0.0 {
            return None;
        }
        let value = Number::from_f64(value).ok()?;
        let square = value.to_rational().pow(2);
        Some((value, (square - &self.squared).sign()))
    }

    /// `set` with the tolerance at `value`.
    pub fn applied(&self, set: &ToleranceSet, value: &Number) -> ToleranceSet {
        let mut set = set.clone();
        for (name, number) in set.numbers_mut() {
            if name == self.tolerance {
                *number = value.clone();
            }
        }
        set
    }
}

/// Chooses a decision of the pair that `tolerance` settles, and finds the critical value. `None` where the pair as it
/// stands has none of a sensible size.
pub fn critical(
    kit: &mut Kit<'_>,
    (a, b): (&Block, &Block),
    set: &ToleranceSet,
    tolerance: &'static str,
) -> Option<Critical> {
    let shadow = Shadow::of(a, b);
    let precision =
        if a.is_exact_in(Precision::F32) && b.is_exact_in(Precision::F32) { Precision::F32 } else { Precision::F64 };
    let pair = Pair { shadow, set, precision };
    let mut offset = None;
    let (decision, squared) = match tolerance {
        "search" => pair.reach(kit, Predicate::VertexVertexNear),
        // Under `classic` the territory radius is the search distance.
        "territory" if set.criteria == Criteria::Classic => None,
        "territory" => match kit.below(3) {
            0 => pair.nearly_parallel(kit, true),
            1 => pair.reach(kit, Predicate::VertexTerritory),
            _ => pair.reach(kit, Predicate::EdgeTerritory),
        },
        "penetration" => match kit.below(4) {
            0 if set.criteria == Criteria::Revised => pair.cone(kit, true),
            1 if set.criteria == Criteria::Revised => pair.wedges(kit, true),
            0 | 1 => pair.gap(kit, Predicate::VertexFaceDepth),
            2 => pair.gap(kit, Predicate::VertexFaceDepth),
            _ => pair.gap(kit, Predicate::EdgeEdgeDepth),
        },
        "overlap_sine" => match kit.below(5) {
            0 | 1 => pair.one_exit(kit).map(|(found, start)| {
                offset = Some(start);
                found
            }),
            2 => pair.wedges(kit, false),
            _ => pair.cone(kit, false),
        },
        "parallel_sine" => pair.nearly_parallel(kit, false),
        "equal" => pair.equal(kit),
        _ => None,
    }?;
    let mut critical = Critical::new(decision, tolerance, squared)?;
    critical.offset = offset.map(|o| o.map(|c| Number::from_f64(c).unwrap_or(Number::ZERO)));
    let value = critical.value.approximate();
    let fits = match tolerance {
        "search" => value <= 4.0 * set.search.approximate(),
        "territory" => value <= set.search.approximate(),
        "penetration" => value <= 4.0 * set.penetration.approximate(),
        "equal" => value <= 0.125,
        _ => value <= 0.95,
    };
    fits.then_some(critical)
}

/// λ = 1/4, less a thousandth: what is measured against it is in f64.
const QUARTER: f64 = 0.25 * 0.999;

type Found = Option<(Decision, BigRational)>;

struct Pair<'p> {
    shadow: Shadow<'p>,
    set: &'p ToleranceSet,
    /// The coarsest precision that holds the pair: offsets are kept to its spacing.
    precision: Precision,
}

impl Pair<'_> {
    fn exact(&self, vertices: &[(Side, u32)]) -> Exact<'_> {
        Exact::new((self.shadow.a, self.shadow.b), vertices, [0.0; 3], self.set)
    }

    fn loop_of(&self, side: Side, face: u32) -> impl Iterator<Item = (Side, u32)> + '_ {
        self.shadow.block(side).topology().faces()[face as usize].iter().map(move |&v| (side, v))
    }

    fn beside(&self, side: Side, edge: u32) -> impl Iterator<Item = (Side, u32)> + '_ {
        let e = self.shadow.block(side).topology().edges()[edge as usize];
        self.loop_of(side, e.left).chain(self.loop_of(side, e.right))
    }

    /// A distance that `search` or `territory` must reach.
    fn reach(&self, kit: &mut Kit<'_>, predicate: Predicate) -> Found {
        match (predicate, kit.below(4)) {
            (Predicate::VertexVertexNear, 1) => self.distance_to_edge(kit, Predicate::VertexEdgeNear),
            (Predicate::VertexVertexNear, 2) => self.gap(kit, Predicate::VertexFaceNear),
            (Predicate::VertexVertexNear, 3) => self.gap(kit, Predicate::EdgeEdgeNear),
            (Predicate::EdgeTerritory, _) => self.distance_to_edge(kit, predicate),
            _ => self.distance_to_vertex(kit, predicate),
        }
    }

    fn distance_to_vertex(&self, kit: &mut Kit<'_>, predicate: Predicate) -> Found {
        let (va, vb) = self.shadow.vertex_vertex(kit)?;
        let exact = self.exact(&[(Side::A, va), (Side::B, vb)]);
        let apart = exact.vertex(Side::A, va).minus(&exact.vertex(Side::B, vb));
        let distance = length(minus(self.shadow.vertex(Side::A, va), self.shadow.vertex(Side::B, vb)));
        let limit = self.quarter_edge(Side::A, va).min(self.quarter_edge(Side::B, vb));
        if predicate == Predicate::VertexTerritory && distance >= limit {
            return None;
        }
        let decision = Decision::about(predicate, &[Feature::Vertex(Side::A, va), Feature::Vertex(Side::B, vb)]);
        Some((decision, square_metres(&exact, apart.norm_squared(), 1.into())))
    }

    /// λ times the shortest edge at a vertex, a little less to be sure.
    fn quarter_edge(&self, side: Side, vertex: u32) -> f64 {
        let edges = self.shadow.block(side).topology().vertex_edges(vertex).iter();
        edges.map(|&e| length(self.shadow.edge(side, e).1)).fold(f64::INFINITY, f64::min) * QUARTER
    }

    /// λ times the smaller width of the faces at an edge, a little less to be sure.
    fn quarter_width(&self, side: Side, edge: u32) -> f64 {
        let e = self.shadow.block(side).topology().edges()[edge as usize];
        let (p, d) = self.shadow.edge(side, edge);
        let width = |face: u32| {
            let far = |v: u32| length(cross(minus(self.shadow.vertex(side, v), p), d)) / length(d);
            self.shadow.block(side).topology().faces()[face as usize].iter().map(|&v| far(v)).fold(0.0, f64::max)
        };
        width(e.left).min(width(e.right)) * QUARTER
    }

    fn distance_to_edge(&self, kit: &mut Kit<'_>, predicate: Predicate) -> Found {
        let asked = side(kit);
        let (v, e) = self.shadow.vertex_edge(kit, asked)?;
        let (along, distance) = self.shadow.foot(asked, v, e);
        let too_far = predicate == Predicate::EdgeTerritory && distance >= self.quarter_width(asked.other(), e);
        if !(0.0..1.0).contains(&along) || too_far {
            return None;
        }
        let edge = self.shadow.block(asked.other()).topology().edges()[e as usize];
        let exact = self.exact(&[(asked, v), (asked.other(), edge.p), (asked.other(), edge.q)]);
        let d = exact.direction(asked.other(), e);
        let x = exact.vertex(asked, v).minus(&exact.vertex(asked.other(), edge.p));
        let decision = Decision::about(predicate, &[Feature::Vertex(asked, v), Feature::Edge(asked.other(), e)]);
        Some((decision, square_metres(&exact, x.cross(&d).norm_squared(), d.norm_squared())))
    }

    /// A gap (for `search`) or a depth (for `penetration`).
    fn gap(&self, kit: &mut Kit<'_>, predicate: Predicate) -> Found {
        let deep = matches!(predicate, Predicate::VertexFaceDepth | Predicate::EdgeEdgeDepth);
        let (exact, gap, square, decision) = if matches!(predicate, Predicate::EdgeEdgeNear | Predicate::EdgeEdgeDepth)
        {
            let (ea, eb) = self.shadow.edge_edge(kit)?;
            let (s, t, _) = self.shadow.feet(ea, eb)?;
            if !((0.0..1.0).contains(&s) && (0.0..1.0).contains(&t)) {
                return None;
            }
            let exact = self.exact(&self.beside(Side::A, ea).chain(self.beside(Side::B, eb)).collect::<Vec<_>>());
            let n = exact.perpendicular(ea, eb);
            let (pa, pb) = (exact.edge(Side::A, ea).p, exact.edge(Side::B, eb).p);
            let gap = exact.along((Side::A, pa), pb, &n).constant;
            let features = [Feature::Edge(Side::A, ea), Feature::Edge(Side::B, eb)];
            (exact, gap, n.norm_squared(), Decision::about(predicate, &features))
        } else {
            let asked = side(kit);
            let (v, f) = self.shadow.vertex_face(kit, asked);
            if self.shadow.above_face(asked, v, f).1 > 0.0 {
                return None;
            }
            let exact = self.exact(&self.loop_of(asked.other(), f).chain([(asked, v)]).collect::<Vec<_>>());
            let (gap, square, k) = exact.gap(asked, v, f);
            let features = [Feature::Vertex(asked, v), Feature::Face(asked.other(), f)];
            (exact, gap.constant, square * &k * &k, Decision::about(predicate, &features))
        };
        if gap.is_zero() || deep != gap.is_negative() {
            return None;
        }
        let gap_squared = &gap * &gap;
        Some((decision, square_metres(&exact, gap_squared, square)))
    }

    /// An edge direction that dips below a plane: the sine of its angle, or (`by_depth`) the depth of its far end.
    fn cone(&self, kit: &mut Kit<'_>, by_depth: bool) -> Found {
        let asked = side(kit);
        let (v, f) = self.shadow.vertex_face(kit, asked);
        let topology = self.shadow.block(asked).topology();
        let edge = *kit.pick(topology.vertex_edges(v));
        let end = topology.edges()[edge as usize].other(v);
        let exact = self.exact(&self.loop_of(asked.other(), f).chain([(asked, v), (asked, end)]).collect::<Vec<_>>());
        let n = exact.normal(asked.other(), f);
        let e = exact.vertex(asked, end).minus(&exact.vertex(asked, v));
        let dip = e.dot(&n);
        let features = [Feature::Vertex(asked, v), Feature::Face(asked.other(), f), Feature::Edge(asked, edge)];
        let decision = Decision::about(Predicate::ConePasses, &features);
        if !dip.is_negative() {
            return None;
        }
        let test = Dip { squared: &dip * &dip, norms: n.norm_squared(), arm: e.norm_squared(), width: None };
        Some((decision, test.critical(&exact, self.set, by_depth)?))
    }

    /// The worst of the four faces at two crossing edges.
    fn wedges(&self, kit: &mut Kit<'_>, by_depth: bool) -> Found {
        let (ea, eb) = self.shadow.edge_edge(kit)?;
        let exact = self.exact(&self.beside(Side::A, ea).chain(self.beside(Side::B, eb)).collect::<Vec<_>>());
        let n = exact.perpendicular(ea, eb);
        let decision =
            Decision::about(Predicate::WedgesPass, &[Feature::Edge(Side::A, ea), Feature::Edge(Side::B, eb)]);
        let mut worst: Option<BigRational> = None;
        for (side, edge) in [(Side::A, ea), (Side::B, eb)] {
            let e = exact.edge(side, edge);
            for face in [e.left, e.right] {
                let m = exact.inward(side, edge, face);
                let dip = n.dot(&m);
                if dip.is_zero() || dip.is_negative() == (side == Side::B) {
                    continue;
                }
                let width = width_squared(&exact, side, edge, face);
                let test =
                    Dip { squared: &dip * &dip, norms: n.norm_squared(), arm: m.norm_squared(), width: Some(width) };
                worst = worst.max(test.critical(&exact, self.set, by_depth));
            }
        }
        Some((decision, worst?))
    }

    /// The sine between the two faces at a blunt edge of a convex block, and an offset of B that puts a vertex of the
    /// other under both: the deeper overlap may be another way out than the shallower.
    fn one_exit(&self, kit: &mut Kit<'_>) -> Option<((Decision, BigRational), V)> {
        if !(self.shadow.a.is_convex() && self.shadow.b.is_convex()) {
            return None;
        }
        let asked = side(kit);
        let other = asked.other();
        let (vertex, edge) = self.shadow.vertex_edge(kit, asked)?;
        let e = self.shadow.block(other).topology().edges()[edge as usize];
        let exact = self.exact(&self.beside(other, edge).collect::<Vec<_>>());
        let (n, m) = (exact.normal(other, e.left), exact.normal(other, e.right));
        if !n.dot(&m).is_positive() {
            return None;
        }
        let (p, d) = self.shadow.edge(other, edge);
        let depth = self.set.penetration.approximate() / 4.0;
        // Deeper under one face than under the other, less than g under both.
        let (n_left, n_right) = (self.shadow.normal(other, e.left), self.shadow.normal(other, e.right));
        let inward = plus(times(n_left, kit.between(32, 64) as f64 / 64.0), times(n_right, 1.5));
        let place = minus(plus(p, times(d, kit.between(4, 12) as f64 / 16.0)), times(inward, depth));
        let way = minus(place, self.shadow.vertex(asked, vertex));
        let way = if asked == Side::B { way } else { times(way, -1.0) };
        let start = self.shadow.on_grid(way, self.precision);
        let moved = self.shadow.moved(start);
        let ((left, out_left), (right, out_right)) =
            (moved.above_face(asked, vertex, e.left), moved.above_face(asked, vertex, e.right));
        if out_left > 0.0 || out_right > 0.0 || left >= 0.0 || right >= 0.0 {
            return None;
        }
        let face = if left < right { e.left } else { e.right };
        let both = [Feature::Vertex(asked, vertex), Feature::Face(other, face)];
        let features = if asked == Side::A { both } else { [both[1], both[0]] };
        let sine = BigRational::new(n.cross(&m).norm_squared(), n.norm_squared() * m.norm_squared());
        Some(((Decision::about(Predicate::OneExit, &features), sine), start))
    }

    /// The sine between two edges, or (`by_territory`) how far one drifts from the other over the longer's length.
    fn nearly_parallel(&self, kit: &mut Kit<'_>, by_territory: bool) -> Found {
        let (ea, eb) = self.shadow.edge_edge(kit)?;
        let ends = |side: Side, e: u32| {
            let edge = self.shadow.block(side).topology().edges()[e as usize];
            [(side, edge.p), (side, edge.q)]
        };
        let exact = self.exact(&[ends(Side::A, ea), ends(Side::B, eb)].concat());
        let (d1, d2) = (exact.direction(Side::A, ea), exact.direction(Side::B, eb));
        let (cross, l1, l2) = (d1.cross(&d2).norm_squared(), d1.norm_squared(), d2.norm_squared());
        let features = [Feature::Edge(Side::A, ea), Feature::Edge(Side::B, eb)];
        let decision = Decision::about(Predicate::NearlyParallel, &features);
        let sine = BigRational::new(cross.clone(), &l1 * &l2);
        let drift = square_metres(&exact, cross, l1.max(l2));
        // Under `revised` either tolerance is enough; one can only decide where the other says no.
        let by_sine = sine <= self.set.parallel_sine.to_rational().pow(2);
        let by_drift = self.set.criteria == Criteria::Revised && drift <= self.set.territory.to_rational().pow(2);
        match by_territory {
            true => (!by_sine).then_some((decision, drift)),
            false => (!by_drift).then_some((decision, sine)),
        }
    }

    /// The relative difference of the gaps of a vertex above two faces of a corner of the other block.
    fn equal(&self, kit: &mut Kit<'_>) -> Found {
        let (va, vb) = self.shadow.vertex_vertex(kit)?;
        let asked = side(kit);
        let (v, owner) = if asked == Side::A { (va, vb) } else { (vb, va) };
        let faces = self.shadow.block(asked.other()).topology().vertex_faces(owner);
        let exact = self
            .exact(&faces.iter().flat_map(|&f| self.loop_of(asked.other(), f)).chain([(asked, v)]).collect::<Vec<_>>());
        // Signed squares of the gaps order as the gaps do.
        let gaps: Vec<(u32, BigRational)> = faces
            .iter()
            .map(|&f| {
                let (gap, square, k) = exact.gap(asked, v, f);
                let sign = gap.constant.signum();
                (f, BigRational::new(sign * &gap.constant * &gap.constant, square * &k * &k))
            })
            .collect();
        let (best, largest) = gaps.iter().max_by(|g, h| g.1.cmp(&h.1).then(h.0.cmp(&g.0)))?;
        let (f, other) = kit.pick(&gaps);
        if f == best || largest.is_zero() || largest.is_positive() != other.is_positive() {
            return None;
        }
        // ε = |h_best − h|/|h_best| = |1 − √(h²/h_best²)|; rational where the ratio is a square.
        let ratio = other / largest;
        let root = Root::of(&(ratio.numer() * ratio.denom()));
        if !root.is_exact() {
            return None;
        }
        let share = (BigRational::from_integer(1.into()) - BigRational::new(root.root, ratio.denom().clone())).abs();
        let vertices = match asked {
            Side::A => [Feature::Vertex(Side::A, v), Feature::Vertex(Side::B, owner)],
            Side::B => [Feature::Vertex(Side::A, owner), Feature::Vertex(Side::B, v)],
        };
        let candidate = match asked {
            Side::A => [Feature::Vertex(Side::A, v), Feature::Face(Side::B, *f)],
            Side::B => [Feature::Face(Side::A, *f), Feature::Vertex(Side::B, v)],
        };
        let features = [vertices[0], vertices[1], candidate[0], candidate[1]];
        Some((Decision::about(Predicate::EntranceChoice, &features), share.pow(2)))
    }
}

/// One comparison of the no-overlap checks: a dip of `√squared` along a normal, for an arm.
struct Dip {
    squared: BigInt,
    norms: BigInt,
    arm: BigInt,
    /// The face's width squared, as numerator and denominator; for the cone check the arm is the length itself.
    width: Option<(BigInt, BigInt)>,
}

impl Dip {
    /// The square of the sine or depth that would let this dip pass, if the other tolerance does not.
    fn critical(&self, exact: &Exact<'_>, set: &ToleranceSet, by_depth: bool) -> Option<BigRational> {
        let sine = BigRational::new(self.squared.clone(), &self.norms * &self.arm);
        let depth = match &self.width {
            None => square_metres(exact, self.squared.clone(), self.norms.clone()),
            Some((width, over)) => square_metres(exact, &self.squared * width, &self.norms * &self.arm * over),
        };
        let by_sine = sine <= set.overlap_sine.to_rational().pow(2);
        let deep_enough = set.criteria == Criteria::Revised && depth <= set.penetration.to_rational().pow(2);
        match by_depth {
            true => (!by_sine).then_some(depth),
            false => (!deep_enough).then_some(sine),
        }
    }
}

/// `numerator / denominator` lattice units squared in m².
fn square_metres(exact: &Exact<'_>, numerator: BigInt, denominator: BigInt) -> BigRational {
    exact.metres(&exact.metres(&BigRational::new(numerator, denominator)))
}

/// The square of the greatest distance of a face's vertices from the line of one of its edges: numerator, denominator.
fn width_squared(exact: &Exact<'_>, side: Side, edge: u32, face: u32) -> (BigInt, BigInt) {
    let d = exact.direction(side, edge);
    let p = exact.vertex(side, exact.edge(side, edge).p);
    let corners = &exact.block(side).topology().faces()[face as usize];
    let far = corners.iter().map(|&v| exact.vertex(side, v).minus(&p).cross(&d)).max_by_key(Vec3::norm_squared);
    (far.map_or(BigInt::zero(), |f| f.norm_squared()), d.norm_squared())
}

fn side(kit: &mut Kit<'_>) -> Side {
    if kit.chance(50) { Side::A } else { Side::B }
}
