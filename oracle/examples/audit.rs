//! The audit of overlaps of a file, with its times:
//! `cargo run --release -p rockproof-oracle --example audit -- cases/real/openpit_rock.dda`, or `-- wall 100000` for a
//! turned wall of so many bricks.

use rockproof_model::preset::{Preset, derive};
use rockproof_model::scene::Scene;
use rockproof_model::{Block, Number, Precision, Vec3};
use rockproof_oracle::PreparedBlock;
use rockproof_oracle::audit::{Audit, Auditor, Decider, OverlapVisibility, rounding_depth};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let blocks: Vec<Block> = match &words[..] {
        [path] => Scene::load(path)?.shapes().into_iter().cloned().collect(),
        [_, count] => wall(count.parse()?)?,
        _ => return Err("give a file of blocks, or the word wall and a number".into()),
    };
    let set = derive(Preset::Auto, &blocks.iter().collect::<Vec<_>>(), Precision::F64)?;
    let start = Instant::now();
    let solids: Vec<PreparedBlock> = blocks.iter().map(PreparedBlock::new).collect();
    let auditor = Auditor::new(&solids, &set);
    println!("{} blocks made ready in {:.3} s", blocks.len(), start.elapsed().as_secs_f64());
    let start = Instant::now();
    let pairs = auditor.neighbours();
    println!("{} neighbouring pairs found in {:.3} s", pairs.len(), start.elapsed().as_secs_f64());
    let rounding = rounding_depth(&blocks.iter().collect::<Vec<_>>(), Precision::F64);
    let start = Instant::now();
    let beyond = Audit::of(pairs.iter().map(|&pair| auditor.pair_beyond_rounding(pair, &rounding)));
    let bounded = beyond.bounded.len();
    println!("{bounded} overlaps told to be rounding in {:.3} s, one thread", start.elapsed().as_secs_f64());
    let start = Instant::now();
    let audit = Audit::of(pairs.into_iter().map(|pair| auditor.pair(pair)));
    println!("audited in {:.3} s, one thread; decided by", start.elapsed().as_secs_f64());
    for decider in Decider::ALL {
        println!("  {:>16} {}", format!("{decider:?}"), audit.counts.of(decider));
    }
    for sight in [OverlapVisibility::Seen, OverlapVisibility::Shallow, OverlapVisibility::Unseen] {
        let count = audit.overlaps.iter().filter(|overlap| overlap.sight == sight).count();
        println!("  {:>16} {count}", sight.name());
    }
    let uneven = audit.overlaps.iter().filter(|overlap| overlap.is_within_unevenness).count();
    let deep = audit.overlaps.iter().filter(|overlap| overlap.is_deeper_than_g).count();
    println!("{} overlaps, {uneven} within the unevenness of faces, {deep} deeper than g", audit.overlaps.len());
    if let Some(deepest) = audit.deepest() {
        println!("deepest {:?}: {:?} m", deepest.blocks, deepest.penetration.depth_m());
    }
    Ok(())
}

/// Bricks of 2 × 1 × 1 in layers of a hundred by ten, every other one shifted by half a brick, turned by 3-4-5 about z
/// and then about x, rounded to f64.
fn wall(count: usize) -> Result<Vec<Block>, Box<dyn Error>> {
    let ratio = |n: f64, d: f64| Number::from_f64(n / d);
    let (c, s) = (ratio(3.0, 5.0)?, ratio(4.0, 5.0)?);
    let turn = |a: &Number, b: &Number| (a.times(&c).plus(&b.times(&s).negated()), a.times(&s).plus(&b.times(&c)));
    let brick = |k: usize| {
        let (x, y, z) = (2 * (k % 100) + k / 1000 % 2, k / 100 % 10, k / 1000);
        let corner = |by: [usize; 3]| {
            let [x, y, z] = [x + by[0], y + by[1], z + by[2]].map(|c| Number::from_integer(c as i32));
            Vec3::new(x, y, z)
        };
        let block = Block::cuboid(&corner([0; 3]), &corner([2, 1, 1]))?;
        let turned = block.vertices().iter().map(|v| {
            let (x, y) = turn(&v.x, &v.y);
            let (y, z) = turn(&y, &v.z);
            Vec3::new(x, y, z)
        });
        block.with_vertices(turned.collect()).rounded(Precision::F64).ok_or_else(|| "a coordinate overflows".into())
    };
    (0..count).map(brick).collect()
}
