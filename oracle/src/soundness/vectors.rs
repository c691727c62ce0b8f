//! What every level starts from: vectors and tolerances are no further from the exact ones than their bounds say, and no longer than
//! their counts of bits.

use crate::number::{Approx, Ball, Bits, Bound};
use crate::pair::Pair;
use crate::view::{BallView, BitsView, BoundView, ExactView, FloatView, LazyScales, Scales, View};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Signed;
use num_traits::float::FloatCore;
use rockproof_model::decision::Side;
use rockproof_model::ring::ExactRing;
use rockproof_model::{EdgeId, FaceId, Number, ToleranceSet, Vec3, VertexId};
use std::cell::OnceCell;

/// Compares all views of a pair with the exact one.
pub(super) fn check(pair: &Pair<'_>, t: &ToleranceSet, about: &str) {
    let exact = Scales::exact(t, &pair.grid().lattice);
    let (numbers, counts, balls) = (OnceCell::new(), OnceCell::new(), OnceCell::new());
    let floats = Scales::approximate(t);
    let float = || FloatView { a: pair.a, b: pair.b, scales: &floats };
    let (units, metres) = pair.grid().lattice.units_per_metre();
    let views = Views {
        exact: ExactView { geometry: pair.heap(), scales: LazyScales { made: &numbers, make: &|| exact.clone() } },
        counted: BitsView {
            a: &pair.a.block,
            b: &pair.b.block,
            coordinate: pair.grid().bits,
            scales: LazyScales { made: &counts, make: &|| exact.bits() },
        },
        balls: BallView { floats: float(), scales: LazyScales { made: &balls, make: &|| Scales::balls(t) } },
        bounds: BoundView::of(pair.a, pair.b, Scales::<Bound>::bounds(t)),
        float: float(),
        unit: (metres, units),
        about,
    };
    let coordinate = views.counted.coordinate;
    for side in [Side::A, Side::B] {
        let topology = pair.topology(side);
        for v in topology.vertex_ids() {
            fits(
                &views.exact.between((Side::A, VertexId(0)), (side, v)),
                &Vec3::new(coordinate, coordinate, coordinate),
                about,
            );
            for other in [Side::A, Side::B] {
                let last = pair.topology(other).vertex_count() - 1;
                for w in [0, 2, last].map(VertexId::at) {
                    views.compare(1, Vector::Between((side, v), (other, w)));
                }
            }
        }
        for edge in topology.edge_ids() {
            views.compare(1, Vector::Direction(side, edge));
            views.compare(3, Vector::Inward(side, edge, false));
            views.compare(3, Vector::Inward(side, edge, true));
        }
        for face in topology.face_ids() {
            views.compare(2, Vector::Normal(side, face));
            views.compare(1, Vector::Centre(side, face));
            let (length, count) = (views.exact.loop_length(side, face), views.counted.loop_length(side, face));
            assert!(length.bits() <= u64::from(count.0), "{about}");
            let bound = views.bounds.loop_length(side, face).magnitude;
            assert!(within(&length, &BigInt::from(1), 0.0, bound), "{bound}, {about}");
            if pair.prepared(side).faces[face.index()].surely_convex {
                turns_left(&views.exact, side, face, about);
            }
        }
    }
    views.compare_tolerances(t);
}

/// A vector of a pair.
#[derive(Clone, Copy, Debug)]
enum Vector {
    Between((Side, VertexId), (Side, VertexId)),
    Direction(Side, EdgeId),
    Normal(Side, FaceId),
    Centre(Side, FaceId),
    Inward(Side, EdgeId, bool),
}

impl Vector {
    fn of<V: View>(self, view: &V) -> Vec3<V::T> {
        match self {
            Vector::Between(from, to) => view.between(from, to),
            Vector::Direction(side, edge) => view.direction(side, edge),
            Vector::Normal(side, face) => view.normal(side, face),
            Vector::Centre(side, face) => view.centre(side, face),
            Vector::Inward(side, edge, right) => view.inward(side, edge, right),
        }
    }
}

struct Views<'p, 's> {
    exact: ExactView<'p, 's, BigInt>,
    counted: BitsView<'p>,
    balls: BallView<'p>,
    bounds: BoundView<'p>,
    float: FloatView<'p>,
    /// Metres of one lattice unit, as a fraction.
    unit: (BigInt, BigInt),
    about: &'p str,
}

impl Views<'_, '_> {
    /// Compares a vector of this degree in length.
    fn compare(&self, degree: u32, vector: Vector) {
        let exact = vector.of(&self.exact);
        fits(&exact, &vector.of(&self.counted), self.about);
        let (metres, of) = (self.unit.0.pow(degree), self.unit.1.pow(degree));
        let (float, bound, ball) = (vector.of(&self.float), vector.of(&self.bounds), vector.of(&self.balls));
        for (k, exact) in exact.components().into_iter().enumerate() {
            let exact = exact * &metres;
            let (Approx(float), bound, ball) = (*float.components()[k], *bound.components()[k], *ball.components()[k]);
            if bound.error.is_finite() && bound.magnitude.is_finite() {
                assert!(within(&exact, &of, float, bound.error), "{vector:?}, {bound:?}, {}", self.about);
                assert!(float.abs() <= bound.magnitude, "{vector:?}, {bound:?}, {}", self.about);
                assert!(within(&exact, &of, 0.0, bound.magnitude), "{vector:?}, {bound:?}, {}", self.about);
            }
            if ball.radius.is_finite() && ball.middle.is_finite() {
                assert!(within(&exact, &of, ball.middle, ball.radius), "{vector:?}, {ball:?}, {}", self.about);
            }
        }
    }

    fn compare_tolerances(&self, t: &ToleranceSet) {
        let of = |number: &Number, bound: &Bound, ball: &Ball, any: Option<&Bound>| {
            let off = (rational(number.approximate()) - number.to_rational()).abs();
            assert!(off <= rational(bound.error), "{number:?} {bound:?}");
            assert!(
                (rational(ball.middle) - number.to_rational()).abs() <= rational(ball.radius),
                "{number:?} {ball:?}"
            );
            if let Some(any) = any {
                assert!(number.approximate() > 1.0 || off <= rational(any.error), "{number:?} {any:?}");
            }
        };
        let (bounds, balls, any) = (self.bounds.scales(), self.balls.scales(), Scales::at_most_one());
        of(&t.search, &bounds.search, &balls.search, Some(&any.search));
        of(&t.territory, &bounds.territory, &balls.territory, Some(&any.territory));
        of(&t.penetration, &bounds.penetration, &balls.penetration, Some(&any.penetration));
        of(&t.overlap_sine, &bounds.overlap, &balls.overlap, Some(&any.overlap));
        of(&t.parallel_sine, &bounds.parallel, &balls.parallel, Some(&any.parallel));
        of(&t.equal, &bounds.equal, &balls.equal, Some(&any.equal));
        let (numbers, counts) = (self.exact.scales(), self.counted.scales());
        for (number, count) in [
            (&numbers.unit, counts.unit),
            (&numbers.search, counts.search),
            (&numbers.territory, counts.territory),
            (&numbers.penetration, counts.penetration),
            (&numbers.one, counts.one),
            (&numbers.overlap, counts.overlap),
            (&numbers.parallel, counts.parallel),
            (&numbers.whole, counts.whole),
            (&numbers.equal, counts.equal),
        ] {
            assert!(number.bits() <= u64::from(count.0), "{}", self.about);
        }
    }
}

fn rational(value: f64) -> BigRational {
    BigRational::from_float(value).expect("finite")
}

/// Whether the fraction `exact / of` is no further from `middle` than `radius`. In integers: to reduce fractions would take most of the walk's time.
fn within(exact: &BigInt, of: &BigInt, middle: f64, radius: f64) -> bool {
    let ((middle, of_middle), (radius, of_radius)) = (whole_and_exponent(middle), whole_and_exponent(radius));
    let lowest = of_middle.min(of_radius).min(0);
    let off = ((middle * of) << (of_middle - lowest)) - (exact << -lowest);
    off.abs() <= (radius * of) << (of_radius - lowest)
}

/// A float as a whole number times two to an exponent.
fn whole_and_exponent(value: f64) -> (BigInt, i64) {
    let (digits, exponent, sign) = FloatCore::integer_decode(value);
    (BigInt::from(digits) * sign, if digits == 0 { 0 } else { i64::from(exponent) })
}

#[test]
fn an_enclosure_holds_its_ends_and_nothing_beyond() {
    for (middle, radius) in [(0.75, 0.25), (-3e-300, 0.0), (0.0, 5e-324), (1e300, 1e-300), (-7.5, 2f64.powi(80))] {
        for of in [1, 3, 1_i64 << 40] {
            let ends = [rational(middle) - rational(radius), rational(middle) + rational(radius)];
            for (end, outwards) in ends.iter().zip([-1, 1]) {
                let (exact, of) = (end.numer() * of, end.denom() * of);
                assert!(within(&exact, &of, middle, radius), "{middle} {radius}");
                assert!(!within(&(exact + outwards), &of, middle, radius), "{middle} {radius}");
            }
        }
    }
}

fn fits(exact: &Vec3<BigInt>, counts: &Vec3<Bits>, about: &str) {
    for (value, count) in exact.components().into_iter().zip(counts.components()) {
        assert!(value.bits() <= u64::from(count.0), "{value} in {count:?}, {about}");
    }
}

/// A face that is said to be convex turns left at every corner.
fn turns_left(view: &ExactView<'_, '_, BigInt>, side: Side, face: FaceId, about: &str) {
    let edges = view.topology(side).face_edges(face);
    if edges.len() == 3 {
        return;
    }
    for k in 0..edges.len() {
        let (here, next) = (edges[k], edges[(k + 1) % edges.len()]);
        let goes_back = |edge: EdgeId| view.topology(side).edges()[edge.index()].right == face;
        let turn = view.inward(side, here, goes_back(here)).dot(&view.direction(side, next));
        let turn = if goes_back(next) { -turn } else { turn };
        assert!(ExactRing::sign(&turn).is_positive(), "face {face} of {side:?}, {about}");
    }
}
