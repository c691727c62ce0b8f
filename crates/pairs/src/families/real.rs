//! Neighbouring blocks of block files.

use super::{CoordinateStyle, Family, PairSampler};
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, BlockOptions, ContactKind, Number, Vec3};
use std::str::FromStr;
use std::sync::{Arc, OnceLock};

/// Pairs of neighbours, as they are or one of them moved by a little.
#[derive(Clone, Debug)]
pub struct RealNeighbours {
    pairs: Arc<Vec<(Block, Block)>>,
}

/// Pairs out of the block files of public generators, so that a campaign needs no file.
const CARRIED: &str = include_str!("real.txt");

impl RealNeighbours {
    /// Three dozen pairs that the program carries, from UnBlocks-gen and voro++.
    pub fn bundled() -> RealNeighbours {
        static PAIRS: OnceLock<Arc<Vec<(Block, Block)>>> = OnceLock::new();
        let read = || Arc::new(CARRIED.lines().filter(|l| !l.starts_with('#')).filter_map(read_pair).collect());
        RealNeighbours { pairs: Arc::clone(PAIRS.get_or_init(read)) }
    }

    /// The neighbours among `blocks`: pairs whose boxes, grown by a hundredth of their size, meet. `None` when there
    /// are none.
    pub fn neighbours(blocks: &[Block]) -> Option<RealNeighbours> {
        let boxes: Vec<[(f64, f64); 3]> = blocks.iter().map(grown_box).collect();
        let mut order: Vec<usize> = (0..blocks.len()).collect();
        order.sort_by(|&i, &j| boxes[i][0].0.total_cmp(&boxes[j][0].0).then(i.cmp(&j)));
        let mut found = Vec::new();
        for (at, &i) in order.iter().enumerate() {
            // Sorted along x: once a block begins behind the end of this one, so do all later ones.
            for &j in order[at + 1..].iter().take_while(|&&j| boxes[j][0].0 <= boxes[i][0].1) {
                if (1..3).all(|k| boxes[i][k].0 <= boxes[j][k].1 && boxes[j][k].0 <= boxes[i][k].1) {
                    found.push((i.min(j), i.max(j)));
                }
            }
        }
        found.sort_unstable();
        let pairs: Vec<_> = found.into_iter().map(|(i, j)| (blocks[i].clone(), blocks[j].clone())).collect();
        (!pairs.is_empty()).then(|| RealNeighbours { pairs: Arc::new(pairs) })
    }

    /// The pairs it draws from.
    pub fn pairs(&self) -> &[(Block, Block)] {
        &self.pairs
    }
}

impl Family for RealNeighbours {
    fn name(&self) -> &'static str {
        "real"
    }

    fn describe(&self) -> &'static str {
        "neighbouring blocks of block files, as they are or slightly moved"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &[ContactKind::VertexVertex, ContactKind::VertexEdge, ContactKind::EdgeVertex]
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut sampler = PairSampler::with_style(rng, CoordinateStyle::Grid);
        let (a, b) = sampler.pick(&self.pairs).clone();
        let b = match sampler.below(3) {
            0 => b,
            _ => {
                let step = grown_box(&b).map(|(low, high)| high - low).into_iter().fold(0.0, f64::max) / 65_536.0;
                let [x, y, z] = [(); 3].map(|()| {
                    let metres = sampler.gap(2048) as f64 * step;
                    Number::from_f64(metres).unwrap_or(Number::ZERO)
                });
                b.translated(&Vec3::new(x, y, z))
            }
        };
        if sampler.chance(50) { (a, b) } else { (b, a) }
    }
}

/// The block's box in f64, grown by a hundredth of its longest side.
fn grown_box(block: &Block) -> [(f64, f64); 3] {
    let mut bounds = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    for vertex in block.vertices() {
        for (bound, c) in bounds.iter_mut().zip(vertex.components()) {
            let c = c.approximate();
            *bound = (bound.0.min(c), bound.1.max(c));
        }
    }
    let margin = bounds.iter().map(|b| b.1 - b.0).fold(0.0, f64::max) / 100.0;
    bounds.map(|(low, high)| (low - margin, high + margin))
}

/// One line of `real.txt`.
fn read_pair(line: &str) -> Option<(Block, Block)> {
    let mut words = line.split_whitespace().skip(3);
    let planarity = Number::from_f64(next(&mut words)?).ok()?;
    let options = BlockOptions { planarity };
    let mut block = || {
        let vertices = next(&mut words)?;
        let vertices = (0..vertices)
            .map(|_| {
                let mut number = || Number::from_f64(next(&mut words)?).ok();
                Some(Vec3::new(number()?, number()?, number()?))
            })
            .collect::<Option<Vec<_>>>()?;
        let faces: usize = next(&mut words)?;
        let faces = (0..faces)
            .map(|_| {
                let corners = next(&mut words)?;
                (0..corners).map(|_| next(&mut words)).collect()
            })
            .collect::<Option<Vec<Vec<u32>>>>()?;
        Block::new(vertices, faces, &options).ok()
    };
    Some((block()?, block()?))
}

fn next<'l, T: FromStr>(words: &mut impl Iterator<Item = &'l str>) -> Option<T> {
    words.next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_carried_pair_is_read() {
        let lines = CARRIED.lines().filter(|l| !l.starts_with('#')).count();
        assert_eq!(RealNeighbours::bundled().pairs().len(), lines);
        assert!(lines >= 36);
    }

    #[test]
    fn neighbours_are_those_whose_boxes_meet() {
        let (a, b) = RealNeighbours::bundled().pairs()[0].clone();
        let far = a.translated(&Vec3::new(Number::from_integer(1000), Number::ZERO, Number::ZERO));
        let found = RealNeighbours::neighbours(&[far.clone(), b.clone(), a.clone()]).unwrap();
        assert_eq!(found.pairs(), &[(b, a.clone())]);
        assert!(RealNeighbours::neighbours(&[a, far]).is_none());
    }
}
