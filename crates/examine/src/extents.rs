//! How large a model is, and whether its units look right.

use num_traits::ToPrimitive;
use rockproof_model::{Number, Scene};

/// The block in the middle, when they are ordered by size, is between these sizes in metres (the cube root of its volume) unless the units are others.
const SIZES: [f64; 2] = [1e-3, 100.0];

/// The box of a scene and its shortest edge, in metres.
#[derive(Clone, Debug)]
pub struct Extents {
    sides: [f64; 3],
    from: [f64; 3],
    shortest: f64,
    block: usize,
    /// The cube root of the volume of the block in the middle when they are ordered by size, of two the smaller one: a base may be as long as the model.
    size: f64,
}

impl Extents {
    /// Of a scene that has blocks.
    pub fn of(scene: &Scene) -> Extents {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let (mut shortest, mut block) = (f64::INFINITY, 0);
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
                    (shortest, block) = (length, number);
                }
            }
            volumes.push(shape.volume().to_f64().unwrap_or(f64::NAN));
        }
        volumes.sort_by(f64::total_cmp);
        let size = volumes.get(volumes.len().saturating_sub(1) / 2).map_or(f64::NAN, |volume| volume.cbrt());
        Extents { sides: [0, 1, 2].map(|axis| high[axis] - low[axis]), from: low, shortest, block, size }
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

    /// Why the units may be others than metres, if they look so.
    pub fn unit_warning(&self) -> Option<String> {
        let (what, factor) = (if self.size > SIZES[1] { "millimetres" } else { "kilometres" }, self.factor()?);
        Some(format!(
            "half of the blocks are {} m or {}: lengths are metres here; if the file has {what}, `--scale {factor}` checks what it means, and `convert --scale {factor} --precision f64` writes it so",
            short(self.size),
            if self.size > SIZES[1] { "larger" } else { "smaller" }
        ))
    }

    /// What lengths should be multiplied by, if the units look as if they were others than metres.
    pub fn factor(&self) -> Option<&'static str> {
        match self.size {
            size if size > SIZES[1] => Some("1/1000"),
            size if size < SIZES[0] => Some("1000"),
            _ => None,
        }
    }
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
