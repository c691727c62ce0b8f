//! Integers of as few bits as the enclosure of a value says, against those of any length.

use super::in_integers::{PolynomialInIntegers, WIDTHS, value_of};
use super::without_tolerances;
use crate::number::{Ball, Bits};
use crate::pair::Pair;
use crate::predicate::{Factor, LargerGap, Polynomial};
use crate::prepared_block::PreparedBlock;
use crate::sign_cascade::SignCascade;
use crate::view::{BallView, LazyScales, Scales};
use num_bigint::BigInt;
use rockproof_model::{Block, BlockOptions, Entrance, FaceId, Number, Sign, Vec3, VertexId};
use std::cell::OnceCell;
use std::ops::AddAssign;

/// What was seen of enclosures.
#[derive(Clone, Copy, Default)]
pub(super) struct Seen {
    /// Values told by integers that do not hold what comes on the way.
    wrapped: u64,
    /// Values of just as many bits as their enclosure says.
    at_the_edge: u64,
    /// Values that an integer cannot hold, and those of them whose sign it then gets wrong.
    too_long: u64,
    wrong: u64,
    /// Values of less than 128 bits by the bound of f64 alone.
    by_bounds: u64,
    /// Gaps proved equal by their planes, and those that are equal and not proved.
    equal: u64,
    not_proved: u64,
    /// Margins that balls tell, near ties among them, and those that they do not.
    margins: u64,
    near_ties: u64,
    margins_of_integers: u64,
}

impl AddAssign for Seen {
    fn add_assign(&mut self, other: Seen) {
        self.wrapped += other.wrapped;
        self.at_the_edge += other.at_the_edge;
        self.too_long += other.too_long;
        self.wrong += other.wrong;
        self.by_bounds += other.by_bounds;
        self.equal += other.equal;
        self.not_proved += other.not_proved;
        self.margins += other.margins;
        self.near_ties += other.near_ties;
        self.margins_of_integers += other.margins_of_integers;
    }
}

impl Seen {
    pub(super) fn check(&self) {
        let Seen { wrapped, at_the_edge, too_long, wrong, equal, not_proved, .. } = *self;
        let Seen { margins, near_ties, margins_of_integers, .. } = *self;
        assert!(self.by_bounds > 1_000, "{} short by the bound of f64", self.by_bounds);
        assert!(wrapped > 1_000 && at_the_edge > 100, "{wrapped} wrapped, {at_the_edge} as long as they may be");
        // An integer too short is noticed: no sign is right by itself.
        assert!(wrong > 100 && wrong < too_long, "{wrong} wrong of {too_long}");
        assert!(equal > 20 && not_proved > 0, "{equal} equal gaps proved, {not_proved} not");
        let told = margins > 1_000 && near_ties > 50 && margins_of_integers > 50;
        assert!(told, "{margins} margins told by balls, {near_ties} near ties, {margins_of_integers} not told");
    }
}

/// Holds what the cascade concludes from the enclosure of a polynomial's value against the value.
pub(super) fn check<P: Polynomial>(
    run: &SignCascade<'_, '_>,
    p: &P,
    in_integers: &PolynomialInIntegers<'_, '_, '_, P>,
    about: &str,
) -> Seen {
    let t = run.tolerances;
    let (value, exact) = (&in_integers.value, in_integers.exact());
    let slot = P::FIRST_SLOT + p.variant();
    let made: OnceCell<Scales<Ball>> = OnceCell::new();
    let balls = BallView { floats: run.float_view(), scales: LazyScales { made: &made, make: &|| Scales::balls(t) } };
    let mut seen = Seen::default();
    let around = Ball { middle: p.value(&run.float_view()).0, radius: run.bound_of::<P>(p.variant()) };
    seen.by_bounds += u64::from(run.bits_of_ball::<P>(around).is_some_and(|bits| bits < Bits(128)));
    for enclosed in [
        run.bits_of_ball::<P>(p.value(&balls)),
        run.bits_of_ball::<P>(around),
        run.bits_of_double::<P>(&run.double_ball(p)),
    ] {
        let Some(enclosed) = enclosed else { continue };
        assert!(value.bits() <= u64::from(enclosed.0), "{value} in {enclosed:?}, slot {slot}, {about}");
        seen.at_the_edge += u64::from(value.bits() == u64::from(enclosed.0));
        for (number, width) in WIDTHS.into_iter().enumerate() {
            if enclosed < Bits(width) {
                assert_eq!(in_integers.sign(number), exact, "{width}-bit integers, slot {slot}, {about}");
                seen.wrapped += u64::from(in_integers.bits >= Bits(width));
            } else if value.bits() >= u64::from(width) {
                seen.too_long += 1;
                seen.wrong += u64::from(in_integers.sign(number) != exact);
            }
        }
    }
    let margin = run.margins().of_integers(p);
    match run.margins().of_balls(p) {
        Some(told) => {
            assert_eq!((told.0, told.1.to_bits()), (margin.0, margin.1.to_bits()), "margin, slot {slot}, {about}");
            seen.margins += 1;
            seen.near_ties += u64::from(told.1 > 0.0 && told.1 < 1e-6);
        }
        None => seen.margins_of_integers += 1,
    }
    if let Some(gaps) = p.ties_with(t) {
        if run.are_equal(&gaps, &balls) {
            assert!(exact.is_zero(), "gaps called equal, slot {slot}, {about}");
            seen.equal += 1;
        } else {
            seen.not_proved += u64::from(exact.is_zero());
        }
    }
    seen
}

/// Two faces of a plate that are 2⁻⁵¹ m from parallel, which balls of f64 do not tell, and a vertex halfway between them along the first one's normal,
/// exactly: its gaps are not the same, since it is beside the middles of the faces.
#[test]
fn gaps_to_planes_that_are_nearly_parallel_are_not_equal() {
    let (length, width, tilt) = (4.0 + 2f64.powi(-20), 4.0 - 2f64.powi(-22), 2f64.powi(-51));
    let (along, across) = (11.0 / 32.0, 5.0 / 64.0);
    let number = |value: f64| Number::from_f64(value).expect("finite");
    let corners = [(0.0, 0.0), (length, 0.0), (length, width), (0.0, width)];
    let corner = |(x, y): (f64, f64), top: bool| {
        let height = number(along * x).plus(&number(across * y));
        let rest = if top {
            1.0
        } else if x > 0.0 {
            tilt
        } else {
            0.0
        };
        Vec3::new(number(x), number(y), height.plus(&number(rest)))
    };
    let plate = corners.map(|at| corner(at, false)).into_iter().chain(corners.map(|at| corner(at, true))).collect();
    let faces = vec![
        vec![0, 3, 2, 1],
        vec![4, 5, 6, 7],
        vec![0, 1, 5, 4],
        vec![1, 2, 6, 5],
        vec![2, 3, 7, 6],
        vec![3, 0, 4, 7],
    ];
    let plate = Block::new(plate, faces, &BlockOptions { planarity: Number::ZERO }).expect("a plate");
    // The middle of the plate, and from there along the upper face.
    let middle = [length / 2.0, width / 2.0].map(number);
    let beside = 1.0;
    let height = [along * length / 2.0, across * width / 2.0, 0.5, tilt / 4.0, along * beside];
    let height = height.map(number).iter().fold(Number::ZERO, |sum, part| sum.plus(part));
    let tip = Vec3::new(middle[0].plus(&number(beside)), middle[1].clone(), height);
    let far = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|way| {
        let [x, y, z] = way.map(Number::from_integer);
        Vec3::new(tip.x.plus(&x), tip.y.plus(&y), tip.z.plus(&z))
    });
    let corner = [tip].into_iter().chain(far).collect();
    let faces = vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]];
    let corner = Block::new(corner, faces, &BlockOptions { planarity: Number::ZERO }).expect("a corner");
    let prepared = [&corner, &plate].map(PreparedBlock::new);
    let (pair, tolerances) = (Pair::new(&prepared[0], &prepared[1]), without_tolerances());
    let entrance = |face| Entrance::VertexFace(VertexId::at(0), FaceId::at(face));
    let gaps = LargerGap { first: entrance(1), second: entrance(0), factor: Factor::One };
    let mut run = SignCascade::new(&pair, &tolerances);
    let made: OnceCell<Scales<Ball>> = OnceCell::new();
    let scales = LazyScales { made: &made, make: &|| Scales::balls(&tolerances) };
    let balls = BallView { floats: run.float_view(), scales };
    let equal = gaps.ties_with(&tolerances).expect("a factor of one");
    let (parallel, level) = equal.values(&balls);
    assert!(parallel.iter().all(|ball| ball.certain_sign().is_none_or(Sign::is_zero)), "balls cannot tell");
    assert!(level.iter().any(|ball| ball.certain_sign().is_none_or(Sign::is_zero)), "balls cannot tell");
    assert!(!run.are_equal(&equal, &balls), "planes that are nearly parallel");
    let exact = value_of(&pair, &tolerances, &gaps);
    assert_ne!(exact, BigInt::ZERO);
    assert_eq!(run.sign(&gaps), Sign::of_ordering(exact.cmp(&BigInt::ZERO)));
}
