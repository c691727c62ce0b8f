//! How large a model is, and whether its units look right.

use num_traits::ToPrimitive;
use rockproof_model::scene::SceneFormat;
use rockproof_model::topology::Edge;
use rockproof_model::{Block, Number, Scene};
use rockproof_oracle::rational::Rational;

/// Blocks are between these sizes in metres (the cube root of the volume) unless the units are others: more than half of them, and at least three, or all.
const SIZES: [f64; 2] = [1e-3, 100.0];

/// The share of the shortest edge that neighbouring coordinates may be apart.
const COARSE: f64 = 1e-3;

/// The box of a scene and its shortest edge, in metres.
#[derive(Clone, Debug)]
pub struct Extents {
    sides: [f64; 3],
    from: [f64; 3],
    /// The largest coordinate, by its size (m).
    furthest: f64,
    shortest: f64,
    block: usize,
    /// The cube root of the volume that more than half of the blocks, and at least three or all, have at least, and that so many have at most (m).
    sizes: [f64; 2],
}

/// The length of an edge (m), rounded to the nearest f64.
fn exact_length(shape: &Block, edge: &Edge) -> Option<f64> {
    let [p, q] = [edge.p, edge.q].map(|end| shape.vertices()[end.index()].map(Number::to_rational));
    p.minus(&q).norm_squared().sqrt_rounded()
}

impl Extents {
    /// Of a scene that has blocks.
    pub fn of(scene: &Scene) -> Extents {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let (mut shortest, mut block, mut of) = (f64::INFINITY, 0, None);
        let mut volumes = Vec::with_capacity(scene.blocks.len());
        for (number, shape) in scene.shapes().into_iter().enumerate() {
            let points: Vec<[f64; 3]> =
                shape.vertices().iter().map(|v| v.components().map(Number::approximate)).collect();
            for point in &points {
                for axis in 0..3 {
                    low[axis] = low[axis].min(point[axis]);
                    high[axis] = high[axis].max(point[axis]);
                }
            }
            for edge in shape.topology().edges() {
                let [p, q] = [edge.p, edge.q].map(|end| points[end.index()]);
                let length = (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>().sqrt();
                if length < shortest {
                    (shortest, block, of) = (length, number, Some((shape, edge)));
                }
            }
            volumes.push(shape.volume().to_f64().unwrap_or(f64::NAN));
        }
        // Far from the origin rounded coordinates give another length.
        if let Some(exact) = of.and_then(|(shape, edge)| exact_length(shape, edge)) {
            shortest = exact;
        }
        volumes.sort_by(f64::total_cmp);
        // A base as long as the model, or a sliver, says nothing of the unit.
        let many = (volumes.len() / 2 + 1).max(3).min(volumes.len());
        let at = |place: Option<usize>| place.and_then(|at| volumes.get(at)).map_or(f64::NAN, |volume| volume.cbrt());
        let sizes = [volumes.len().checked_sub(many), many.checked_sub(1)].map(at);
        let furthest = low.into_iter().chain(high).map(f64::abs).fold(0.0, f64::max);
        Extents { sides: [0, 1, 2].map(|axis| high[axis] - low[axis]), from: low, furthest, shortest, block, sizes }
    }

    /// Two lines of the table of blocks.
    pub fn lines(&self) -> String {
        let [x, y, z] = self.sides.map(short);
        let [a, b, c] = self.from.map(short);
        format!(
            "  extent    {x:>12} × {y} × {z} m, from ({a}, {b}, {c})\n  shortest  {:>12} m: an edge of block {}\n",
            short(self.shortest),
            self.block
        )
    }

    /// The sides of the box (m).
    pub fn sides(&self) -> [f64; 3] {
        self.sides
    }

    /// The lowest corner of the box (m).
    pub fn from(&self) -> [f64; 3] {
        self.from
    }

    /// The shortest edge (m), and the block that has it.
    pub fn shortest(&self) -> (f64, usize) {
        (self.shortest, self.block)
    }

    /// What is wrong with coordinates of a file that has f32: two neighbouring ones are so far apart, where blocks are furthest from the origin, that they are more than a
    /// thousandth of the shortest edge. `scale` is what the file's lengths were multiplied by.
    pub fn coarse_f32(&self, scale: f64) -> Option<String> {
        let spacing = |at: f64| f32_spacing(at, scale);
        let is_coarse = |at: f64| spacing(at) > COARSE * self.shortest;
        is_coarse(self.furthest).then(|| {
            // From its own middle a block system is half as far away as it is long.
            let longest = self.sides.into_iter().fold(0.0, f64::max);
            let local = if is_coarse(longest / 2.0) { "" } else { "relative to a local origin, or " };
            let [spacing, furthest, shortest] = [spacing(self.furthest), self.furthest, self.shortest].map(short);
            format!(
                "the file has coordinates in f32, which at {furthest} m are {spacing} m apart, and the shortest edge is {shortest} m: export it {local}in double precision"
            )
        })
    }

    /// That single precision cannot hold the coordinates, as [`Extents::coarse_f32`] has it of a file's.
    pub fn too_far_for_f32(&self) -> Option<String> {
        let spacing = f32_spacing(self.furthest, 1.0);
        (spacing > COARSE * self.shortest).then(|| {
            let [spacing, furthest, shortest] = [spacing, self.furthest, self.shortest].map(short);
            format!(
                "f32 cannot hold these coordinates: at {furthest} m neighbouring ones are {spacing} m apart, and the shortest edge is {shortest} m"
            )
        })
    }

    /// Why the units may be others than metres, if they look so. A scene in TOML takes no `--scale`.
    pub fn unit_warning(&self, format: Option<SceneFormat>) -> Option<String> {
        let factor = self.factor()?;
        let [least, most] = self.sizes;
        let (what, size, than) =
            if least > SIZES[1] { ("millimetres", least, "larger") } else { ("kilometres", most, "smaller") };
        let size = short(size);
        let remedy = if format == Some(SceneFormat::Toml) {
            format!("if the scene has {what}, make it anew from what it was made of, with lengths times {factor}")
        } else {
            format!(
                "if the file has {what}, `--scale {factor}` checks what it means, and `convert --scale {factor} --precision f64` writes it so"
            )
        };
        Some(format!("half of the blocks are {size} m or {than}: lengths are metres here; {remedy}"))
    }

    /// What lengths should be multiplied by, if the units look as if they were others than metres.
    pub fn factor(&self) -> Option<&'static str> {
        match self.sizes {
            [least, _] if least > SIZES[1] => Some("1/1000"),
            [_, most] if most < SIZES[0] => Some("1000"),
            _ => None,
        }
    }
}

/// How far two neighbouring f32 are apart at a coordinate, in metres where lengths are multiplied by `scale`: from 2ⁿ up to 2ⁿ⁺¹ it is 2ⁿ⁻²³.
fn f32_spacing(at: f64, scale: f64) -> f64 {
    (at / scale).log2().floor().exp2() * f64::from(f32::EPSILON) * scale
}

/// Four digits, as short as can be.
pub fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e6).contains(&size) => {
            let digits = (3 - size.log10().floor() as i32).max(0) as usize;
            let text = format!("{value:.digits$}");
            if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
        }
        _ => format!("{value:.3e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn four_digits_are_enough() {
        assert_eq!(
            [0.0, 1.0, 2.30477, 1234.56, 0.0016, 123_456.0, 4e-5, 2e9].map(short),
            ["0", "1", "2.305", "1235", "0.0016", "123456", "4.000e-5", "2.000e9"]
        );
    }
}
