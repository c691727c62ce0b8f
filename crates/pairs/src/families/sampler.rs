//! What every family draws with: random whole numbers, coordinate styles, lengths, gaps, shapes, and the last touches
//! (orientation, place, which block is A) that no family should have to think of.

use crate::shapes::catalogue::{self, SIDE, hull_of};
use crate::shapes::lattice_solid::Units;
use crate::shapes::rotation::{WHOLE_LENGTHS, cube_turn};
use crate::shapes::{LatticeSolid, RationalRotation};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;
use rockproof_model::Block;

rockproof_model::named_enum! {
    /// Which numbers the coordinates of a pair are.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum CoordinateStyle {
        /// Multiples of 2⁻¹⁰ m: f32 holds them, so ties survive in every engine.
        Grid = "grid",
        /// Multiples of 2⁻³⁰ m: f64 holds them, f32 rounds.
        Rounded = "rounded",
        /// Multiples of 2⁻⁴⁴ m: f64 holds most with its last bits in use, the rest are finer.
        Full = "full",
        /// Fractions that no binary number holds.
        Fraction = "fraction",
    }
}

/// Random choices of one pair. All from whole numbers, so that they are the same on every machine.
#[derive(Debug)]
pub struct PairSampler<'r> {
    rng: &'r mut ChaCha8Rng,
    style: CoordinateStyle,
    denominator: i128,
}

/// Lengths are drawn in sixteenths of a metre.
const COARSE: i128 = 16;

impl<'r> PairSampler<'r> {
    /// A kit with a style of its own choice: half of all pairs are on the grid, where ties are frequent.
    pub fn new(rng: &'r mut ChaCha8Rng) -> PairSampler<'r> {
        let mut sampler = PairSampler { rng, style: CoordinateStyle::Grid, denominator: 1 };
        let style = *sampler.pick(&[
            CoordinateStyle::Grid,
            CoordinateStyle::Grid,
            CoordinateStyle::Grid,
            CoordinateStyle::Grid,
            CoordinateStyle::Rounded,
            CoordinateStyle::Rounded,
            CoordinateStyle::Full,
            CoordinateStyle::Fraction,
        ]);
        sampler.set_style(style);
        sampler
    }

    /// A kit of the given style.
    pub fn with_style(rng: &'r mut ChaCha8Rng, style: CoordinateStyle) -> PairSampler<'r> {
        let mut sampler = PairSampler { rng, style, denominator: 1 };
        sampler.set_style(style);
        sampler
    }

    fn set_style(&mut self, style: CoordinateStyle) {
        self.style = style;
        self.denominator = match style {
            CoordinateStyle::Grid => 1 << 10,
            CoordinateStyle::Rounded => 1 << 30,
            CoordinateStyle::Full => 1 << 44,
            // Multiples of 16 throughout, so that the coarse lengths are on the lattice.
            CoordinateStyle::Fraction => *self.pick(&[1200, 16_000, 336, 11_088, 16 * 99_991, 3 << 30]),
        };
    }

    /// The style of the pair's coordinates.
    pub fn style(&self) -> CoordinateStyle {
        self.style
    }

    /// Units per metre of the lengths this kit draws.
    pub fn denominator(&self) -> i128 {
        self.denominator
    }

    /// Uniform from `0 .. count`; `count` must be positive.
    pub fn below(&mut self, count: u64) -> u64 {
        // Multiply and shift (Lemire 2019): no division, and a bias below 2⁻³² for the counts used here.
        ((u128::from(self.rng.next_u64()) * u128::from(count)) >> 64) as u64
    }

    /// Uniform from `low ..= high`.
    pub fn between(&mut self, low: i128, high: i128) -> i128 {
        low + i128::from(self.below((high - low + 1) as u64))
    }

    /// Whether something with a chance of `percent` happens.
    pub fn chance(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }

    /// −1 or 1.
    pub fn sign(&mut self) -> i128 {
        if self.chance(50) { 1 } else { -1 }
    }

    /// One of `options`, which must not be empty.
    pub fn pick<'o, T>(&mut self, options: &'o [T]) -> &'o T {
        &options[self.below(options.len() as u64) as usize]
    }

    /// A length between `low` and `high` sixteenths of a metre, in units; on the grid a multiple of a sixteenth.
    pub fn length(&mut self, low: i128, high: i128) -> i128 {
        if self.style == CoordinateStyle::Grid || self.chance(10) {
            self.between(low, high) * (self.denominator / COARSE)
        } else {
            self.between(low * self.denominator / COARSE, high * self.denominator / COARSE)
        }
    }

    /// Three lengths.
    pub fn lengths(&mut self, low: i128, high: i128) -> Units {
        [self.length(low, high), self.length(low, high), self.length(low, high)]
    }

    /// A whole number of units from 0 to `limit`: often 0, a simple share of it, a few units, or anything.
    pub fn share(&mut self, limit: i128) -> i128 {
        match self.below(8) {
            0 | 1 => 0,
            2 => limit / 2,
            3 => limit / (1 << self.between(2, 5)),
            4 => self.between(0, limit.min(4)),
            _ => self.between(0, limit),
        }
    }

    /// A gap between features of blocks of this size (units): zero, or of the order of the tolerances that presets
    /// derive from the size (a hundredth for depths, a fortieth for the search distance), or a few units. Either sign.
    pub fn gap(&mut self, size: i128) -> i128 {
        match self.below(10) {
            0..=2 => 0,
            3 => self.between(1, 3) * self.sign(),
            4 | 5 => self.between(0, size / 16),
            6 => self.between(0, size / 40),
            7 => -self.between(0, size / 100),
            8 => -self.between(0, size / 30),
            _ => size / (1 << self.between(5, 10)) * self.sign(),
        }
    }

    /// A small vector: zero, along an axis, of whole length in the pattern of a Pythagorean box, or anything up to the
    /// order of the search distance.
    pub fn small_vector(&mut self, size: i128) -> Units {
        let reach = (size / 40).max(2);
        match self.below(8) {
            0 => [0; 3],
            1 | 2 => {
                let mut vector = [0; 3];
                vector[self.below(3) as usize] = self.share(reach) * self.sign();
                vector
            }
            3 | 4 => {
                let unit = self.whole_vector();
                let step = self.between(1, (reach / unit.1).max(1));
                unit.0.map(|c| c * step)
            }
            _ => [(); 3].map(|()| self.share(reach) * self.sign()),
        }
    }

    /// A vector of whole components and whole length, with its length.
    pub fn whole_vector(&mut self) -> (Units, i128) {
        let [x, y, z, length] = self.pick(&WHOLE_LENGTHS).map(i128::from);
        let turned = apply(&cube_turn(self.below(24) as u32), [x, y, z]);
        (turned, length)
    }

    /// A direction of small whole components, not zero.
    pub fn direction(&mut self) -> Units {
        loop {
            let direction = [(); 3].map(|()| self.between(-3, 3));
            if direction != [0; 3] {
                return direction;
            }
        }
    }

    /// The named shape of the catalogue with sides of these lengths.
    pub fn shape(&mut self, name: &str, sides: Units) -> LatticeSolid {
        catalogue::named(name).stretched(sides, SIDE * self.denominator)
    }

    /// A box from the origin with sides between `low` and `high` sixteenths of a metre.
    pub fn cuboid(&mut self, low: i128, high: i128) -> LatticeSolid {
        let sides = if self.chance(20) { [self.length(low, high); 3] } else { self.lengths(low, high) };
        self.shape("cuboid", sides)
    }

    /// A convex block: a box, another shape of the catalogue, or the hull of random points.
    pub fn convex(&mut self, low: i128, high: i128) -> LatticeSolid {
        match self.below(16) {
            0..=4 => self.cuboid(low, high),
            5 if self.chance(12) => self.round(low, high),
            5 => self.hull(low, high),
            _ => {
                // Equal sides keep the whole ratios between a shape's own lengths, and so its rational angles.
                let equal = [self.length(low, high); 3];
                let sides = if self.chance(35) { equal } else { self.lengths(low, high) };
                self.pick(catalogue::convex()).solid.stretched(sides, SIDE * self.denominator)
            }
        }
    }

    /// The hull of six to twelve random points in a cube.
    pub fn hull(&mut self, low: i128, high: i128) -> LatticeSolid {
        loop {
            let points: Vec<Units> = (0..self.between(6, 12)).map(|_| [(); 3].map(|()| self.between(0, 16))).collect();
            if let Some(solid) = hull_of(&points, 2) {
                let sides = self.lengths(low, high);
                return solid.stretched(sides, SIDE * self.denominator);
            }
        }
    }

    /// A convex block of 50 to 200 vertices.
    fn round(&mut self, low: i128, high: i128) -> LatticeSolid {
        let sides = self.lengths(low, high);
        self.pick(catalogue::round()).solid.stretched(sides, SIDE * self.denominator)
    }

    /// A concave block of the catalogue.
    pub fn concave(&mut self, low: i128, high: i128) -> LatticeSolid {
        let sides = self.lengths(low, high);
        self.pick(catalogue::concave()).solid.stretched(sides, SIDE * self.denominator)
    }

    /// The solid turned about the origin by a small integer quaternion. In a binary style it is stretched as well, so
    /// that its coordinates stay binary.
    pub fn turned(&mut self, solid: &LatticeSolid) -> LatticeSolid {
        let quaternion = loop {
            let q = [(); 4].map(|()| self.between(-2, 2) as i64);
            if q != [0; 4] {
                break q;
            }
        };
        self.turned_by(solid, RationalRotation::from_quaternion(quaternion))
    }

    /// The solid tipped by some degrees to a few hundredths of one, about one axis or two: what it laid on dips below
    /// the plane it laid on by lengths of the order of g, r and r/10.
    pub fn tipped(&mut self, solid: &LatticeSolid) -> LatticeSolid {
        let n = match self.below(4) {
            0 => self.between(3, 40),
            1 => self.between(40, 400),
            2 => self.between(400, 4000),
            _ => 1 << self.between(4, 12),
        };
        let mut quaternion = [n as i64, 0, 0, 0];
        let axis = 1 + self.below(3) as usize;
        quaternion[axis] = self.sign() as i64;
        if self.chance(30) {
            quaternion[axis % 3 + 1] = self.sign() as i64;
        }
        self.turned_by(solid, RationalRotation::from_quaternion(quaternion))
    }

    /// The solid turned about z by a Pythagorean angle.
    pub fn turned_flat(&mut self, solid: &LatticeSolid) -> LatticeSolid {
        let (a, b) = *self.pick(&[(1, 1), (2, 1), (3, 1), (3, 2), (4, 1), (1, 0), (7, 1), (1, 2), (1, 3)]);
        let b = b * self.sign() as i64;
        self.turned_by(solid, RationalRotation::from_quaternion([a, 0, 0, b]))
    }

    /// The solid turned about the origin; stretched too in a binary style.
    pub fn turned_by(&self, solid: &LatticeSolid, turn: RationalRotation) -> LatticeSolid {
        let norm = if self.style == CoordinateStyle::Fraction { turn.norm } else { turn.binary_norm() };
        solid.mapped(&turn.matrix, norm)
    }

    /// One of the 24 turns of a cube, about the origin.
    pub fn cube_turned(&mut self, solid: &LatticeSolid) -> LatticeSolid {
        solid.mapped(&cube_turn(self.below(24) as u32), 1)
    }

    /// `b` moved so that its vertex `vb` is at vertex `va` of `a` plus `offset` units of this kit.
    pub fn vertex_to_vertex(
        &self,
        (a, va): (&LatticeSolid, usize),
        (b, vb): (&LatticeSolid, usize),
        offset: Units,
    ) -> (LatticeSolid, LatticeSolid) {
        self.point_to_point((a, scaled(a.points()[va], 2)), (b, scaled(b.points()[vb], 2)), offset)
    }

    /// `b` moved so that the point `pb` of it is at the point `pa` of `a` plus `offset` units of this kit. The points
    /// are given in halves of the solids' own units, so that they can be midpoints.
    pub fn point_to_point(
        &self,
        (a, pa): (&LatticeSolid, Units),
        (b, pb): (&LatticeSolid, Units),
        offset: Units,
    ) -> (LatticeSolid, LatticeSolid) {
        let (half_a, half_b) = (a.refined(2), b.refined(2));
        let (mut a, b) = LatticeSolid::on_one_lattice(&half_a, &half_b);
        let mut b = b;
        let common = |d: i128| num_integer::lcm(d, self.denominator) / d;
        let factor = common(a.denominator());
        (a, b) = (a.refined(factor), b.refined(factor));
        let unit = a.denominator() / self.denominator;
        let to_a = a.denominator() / half_a.denominator();
        let to_b = b.denominator() / half_b.denominator();
        let shift = [0, 1, 2].map(|i| pa[i] * to_a - pb[i] * to_b + offset[i] * unit);
        let b = b.moved(shift);
        (a, b)
    }

    /// Gives the pair its last touches: a turn of the cube, sometimes a turn, shear or far place that spares its
    /// relative position, and a random order.
    pub fn finish(&mut self, a: LatticeSolid, b: LatticeSolid) -> (Block, Block) {
        let (mut a, mut b) = LatticeSolid::on_one_lattice(&a, &b);
        let cube = cube_turn(self.below(24) as u32);
        (a, b) = (a.mapped(&cube, 1), b.mapped(&cube, 1));
        match self.below(12) {
            0 | 1 => {
                let (q, r) = (self.between(-2, 2) as i64, self.between(-2, 2) as i64);
                let turn = RationalRotation::from_quaternion([2, q, r, 1]);
                (a, b) = (self.turned_by(&a, turn), self.turned_by(&b, turn));
            }
            2 => {
                let mut small = || self.between(-1, 1) as i64;
                let shear = [[4, small(), small()], [small(), 4, small()], [small(), small(), 4]];
                (a, b) = (a.mapped(&shear, 4), b.mapped(&shear, 4));
            }
            _ => {}
        }
        if self.chance(50) {
            let step = a.denominator() / self.denominator;
            let offset = self.lengths(-64, 64).map(|c| c * step);
            (a, b) = (a.moved(offset), b.moved(offset));
        }
        let (a, b) = (a.block(0), b.block(0));
        if self.chance(50) { (a, b) } else { (b, a) }
    }
}

/// `matrix · vector`.
pub(crate) fn apply(matrix: &[[i64; 3]; 3], vector: Units) -> Units {
    matrix.map(|row| row.iter().zip(vector).map(|(m, c)| i128::from(*m) * c).sum())
}

/// `vector · factor`.
pub(crate) fn scaled(vector: Units, factor: i128) -> Units {
    vector.map(|c| c * factor)
}
