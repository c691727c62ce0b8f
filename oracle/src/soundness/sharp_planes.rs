//! Planes in balls of f64 that are made of balls of two f64: what they enclose, and that they tell apart what balls of f64 do not.

use super::in_integers::sign_of;
use super::{Dice, without_tolerances};
use crate::field::DoubleBall;
use crate::number::Ball;
use crate::pair::Pair;
use crate::predicate::{Factor, LargerGap, Polynomial, plane};
use crate::prepared_block::PreparedBlock;
use crate::sign_cascade::SignCascade;
use crate::view::{BallView, LazyScales, Scales, View};
use rockproof_model::decision::Side;
use rockproof_model::{Block, Entrance, Number, Vec3};
use std::cell::OnceCell;

#[test]
fn a_ball_of_f64_holds_all_of_two() {
    let quarter = f64::EPSILON / 4.0;
    for (low, radius) in [(0.0, 0.0), (quarter, 0.0), (-quarter, 1e-20), (0.0, 1e-30), (quarter, quarter)] {
        let Ball { middle, radius: around } = DoubleBall { high: 1.0, low, radius }.as_ball();
        assert_eq!(middle, 1.0);
        assert!(around >= low.abs() + radius && around <= (low.abs() + radius) * (1.0 + 1e-12), "{low} {radius}");
    }
}

/// A brick whose corners are off by up to 1000 units of this decimal digit.
fn brick(dice: &mut Dice, at: [f64; 3], digits: u64) -> Block {
    let number = |value: f64| Number::from_f64(value).expect("finite");
    let corner = |at: [f64; 3]| Vec3::new(number(at[0]), number(at[1]), number(at[2]));
    let block = Block::cuboid(&corner(at), &corner([at[0] + 0.5, at[1] + 0.25, at[2] + 0.125])).expect("a brick");
    let mut near = |c: &Number| c.plus(&number((dice.below(2001) as f64 - 1000.0) * 0.1f64.powi(digits as i32)));
    let vertices = block.vertices().iter().map(|v| Vec3::new(near(&v.x), near(&v.y), near(&v.z))).collect();
    block.with_vertices(vertices)
}

/// Bricks that lie on one another, pressed in by a hair: all gaps of their corners and edges there are nearly the same.
#[test]
fn gaps_that_differ_by_roundoffs_are_told_apart() {
    let (mut dice, t) = (Dice(21), without_tolerances());
    let (mut by_planes, mut by_balls, mut asked) = (0, 0, 0);
    for _ in 0..40 {
        let digits = [13, 19][dice.below(2) as usize];
        let (a, b) = (brick(&mut dice, [0.1, 0.3, 0.7], digits), brick(&mut dice, [0.35, 0.3, 0.825 - 1e-7], digits));
        let (a, b) = (PreparedBlock::new(&a), PreparedBlock::new(&b));
        let pair = Pair::new(&a, &b);
        let run = SignCascade::new(&pair, &t);
        let (of_a, of_b) = (pair.topology(Side::A), pair.topology(Side::B));
        let mut all: Vec<Entrance> = Vec::new();
        all.extend(of_a.vertex_ids().flat_map(|v| of_b.face_ids().map(move |f| Entrance::VertexFace(v, f))));
        all.extend(of_a.edge_ids().flat_map(|a| of_b.edge_ids().map(move |b| Entrance::EdgeEdge(a, b))));
        let floats = run.float_view();
        all.retain(|entrance| {
            let (p, q) = plane(&floats, entrance);
            q.0 > 1e-8 && p.0 * p.0 < 1e-10 * q.0
        });
        let balls = OnceCell::new();
        let scales = LazyScales { made: &balls, make: &|| Scales::balls(&t) };
        let view = BallView { floats, scales };
        for _ in 0..60 {
            let [first, second] = [0; 2].map(|_: usize| all[dice.below(all.len() as u64) as usize]);
            let gaps = LargerGap { first, second, factor: Factor::One };
            let exact = sign_of(&pair, &t, &gaps);
            asked += 1;
            by_balls += u32::from(gaps.value(&view).certain_sign().is_some());
            if let Some(sign) = run.sign_by_sharp_planes(&gaps, view.scales()) {
                assert_eq!(sign, exact, "{first:?} and {second:?}");
                by_planes += 1;
            }
        }
    }
    assert!(by_planes > by_balls + 50, "{by_planes} by planes, {by_balls} by balls, of {asked}");
}
