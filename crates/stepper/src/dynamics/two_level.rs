//! What preconditions conjugate gradients without a factor: an additive Schwarz method of two levels (Dryja and Widlund 1987). Its fine level is
//! the matrix's diagonal by blocks; its coarse level is the matrix for groups of blocks that move by the twelve displacements of a block, or six where
//! blocks are rigid.
//!
//! M⁻¹ = D⁻¹ + P (PᵀKP)⁻¹ Pᵀ, where P gives each block the displacement that its group has there. Threads share blocks by the parts of `system.rs` and
//! panels of the coarse level, whose contacts come one after another: the same bits on any number of threads.

use crate::dynamics::block_inverse::BlockInverse;
use crate::dynamics::conjugate_gradients::{Measured, Preconditioner, dot};
use crate::dynamics::contact::Resistance;
use crate::dynamics::displacement::{BlockVector, displacement, generalized};
use crate::dynamics::groups::Groups;
use crate::dynamics::island::packed;
use crate::dynamics::products::Products;
use crate::dynamics::solve::Solve;
use crate::dynamics::system::{Lists, NO_PLACE, Part, System};
use crate::real::Real;
use crate::vector::Vector;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::ops::Range;

type Square<R> = [[R; 12]; 12];

/// Both levels, ready to be applied.
pub(super) struct TwoLevel<'t, 's, R> {
    system: &'t System<'s, R>,
    groups: &'t Groups,
    /// Of each place.
    inverses: Vec<BlockInverse>,
    /// Where the centroid of each place is from the centre of its group (m).
    arms: Vec<Vector<R>>,
    /// The factor of the coarse level.
    coarse: Vec<f32>,
}

impl<'t, 's, R: Solve> TwoLevel<'t, 's, R> {
    /// None where the island has no groups, or where one of the matrices is not positive definite in f32.
    pub(super) fn new(products: &Products<'t, 's, R>) -> Option<TwoLevel<'t, 's, R>> {
        let system = products.system;
        let groups = system.layout.groups.as_ref()?;
        let parts: Vec<(Range<usize>, &[u32])> = system.places_by_part().collect();
        let inverses: Option<Vec<Vec<BlockInverse>>> = parts
            .into_par_iter()
            .map(|(places, closed)| Arch::new().dispatch(Diagonal { products, places, closed }))
            .collect();
        let arms = arms(system, groups);
        let pattern = &groups.pattern;
        let panel = |place: u32| match place {
            NO_PLACE => NO_PLACE,
            place => pattern.panel(groups.of_place[place as usize] as usize) as u32,
        };
        let bearing = Lists::of_both(pattern.panel_count(), &system.sides, panel);
        let fill = |panel: usize, values: &mut [f32]| {
            let mut whole = vec![R::ZERO; values.len()];
            let bearing = bearing.of(panel);
            Arch::new().dispatch(Coarse { products, groups, arms: &arms, panel, bearing, values: &mut whole });
            values.iter_mut().zip(whole).for_each(|(value, whole)| *value = whole.to_f64() as f32);
        };
        let mut coarse = vec![0.0; pattern.values()];
        f32::factorize(pattern, &mut coarse, &vec![true; pattern.panel_count()], &fill).ok()?;
        Some(TwoLevel { system, groups, inverses: inverses?.concat(), arms, coarse })
    }
}

impl<R: Solve> Preconditioner<R> for TwoLevel<'_, '_, R> {
    fn measure(&self, residual: &[R]) -> Option<Measured<'_, R>> {
        let direction = self.precondition(residual)?;
        Some(Measured { square: dot(residual, &direction), direction: Box::new(|| direction) })
    }
}

impl<R: Solve> TwoLevel<'_, '_, R> {
    /// M⁻¹ times a residual.
    pub(super) fn precondition(&self, residual: &[R]) -> Option<Vec<R>> {
        let (coarse, fine) = (&self.groups.pattern, &self.system.layout.pattern);
        let mut sums = vec![R::ZERO; coarse.size()];
        for (place, (&arm, &group)) in self.arms.iter().zip(&self.groups.of_place).enumerate() {
            let own = to_group(arm, &residual[fine.unknowns(place)]);
            let sums = &mut sums[coarse.unknowns(group as usize)];
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum = *sum + own);
        }
        let mut motions: Vec<f32> = sums.into_iter().map(|x| x.to_f64() as f32).collect();
        f32::substitute(coarse, &self.coarse, &mut motions).ok()?;
        let mut all = vec![R::ZERO; residual.len()];
        let parts = self.system.parts(&mut all).into_par_iter();
        parts.for_each(|part| {
            Arch::new().dispatch(Applying { level: self, residual, motions: &motions, part });
        });
        Some(all)
    }
}

/// Where the centroids are from the centres of their groups (m).
fn arms<R: Real>(system: &System<'_, R>, groups: &Groups) -> Vec<Vector<R>> {
    let centroid = |place: usize| system.block_systems[system.blocks[place] as usize].centroid;
    let mut arms = vec![Vector::ZERO; system.blocks.len()];
    for group in 0..groups.pattern.node_of(groups.pattern.size()) {
        let places = groups.places.of(group);
        let sum = places.iter().fold(Vector::ZERO, |sum, &place| sum + centroid(place as usize));
        let centre = sum / R::from_f64(places.len() as f64);
        places.iter().for_each(|&place| arms[place as usize] = centroid(place as usize) - centre);
    }
    arms
}

/// `Pᵀy` for one block.
#[inline(always)]
fn to_group<R: Real>(arm: Vector<R>, y: &[R]) -> BlockVector<R> {
    let mut all = generalized(arm, Vector::new(y[0], y[1], y[2]));
    for (all, &y) in all.iter_mut().zip(y).skip(3) {
        *all = *all + y;
    }
    all
}

/// `T(x)ᵀ`, column by column, and what a contact makes of them: `S·T(x)` for its stiffness S.
#[inline(always)]
fn resisted<R: Real>(resistance: &Resistance<R>, arm: Vector<R>) -> [[BlockVector<R>; 3]; 2] {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| {
        let [x, y, z] = axis.map(R::from_f64);
        Vector::new(x, y, z)
    });
    let rows = axes.map(|axis| generalized(arm, axis));
    let products = axes.map(|axis| {
        let stiffness = resistance.against(axis).components();
        std::array::from_fn(|k| stiffness[0] * rows[0][k] + stiffness[1] * rows[1][k] + stiffness[2] * rows[2][k])
    });
    [rows, products]
}

/// Adds `sign·rowsᵀ·columns`, of which a row of the sum belongs to one of the first.
#[inline(always)]
fn add_outer<R: Real>(sum: &mut Square<R>, rows: &[BlockVector<R>; 3], columns: &[BlockVector<R>; 3], sign: R) {
    for (row, sum) in sum.iter_mut().enumerate() {
        let factors = [rows[0][row] * sign, rows[1][row] * sign, rows[2][row] * sign];
        for (column, sum) in sum.iter_mut().enumerate() {
            *sum = *sum
                + (factors[0] * columns[0][column] + factors[1] * columns[1][column] + factors[2] * columns[2][column]);
        }
    }
}

/// The whole matrix of a block.
#[inline(always)]
fn whole<R: Real>(matrix: &[R; 78]) -> Square<R> {
    let mut whole = [[R::ZERO; 12]; 12];
    for row in 0..12 {
        for column in 0..=row {
            whole[row][column] = matrix[packed(row, column)];
            whole[column][row] = matrix[packed(row, column)];
        }
    }
    whole
}

/// The inverses of the blocks' own matrices at some places.
struct Diagonal<'d, 'p, 's, R> {
    products: &'d Products<'p, 's, R>,
    places: Range<usize>,
    closed: &'d [u32],
}

impl<R: Real + Send + Sync> WithSimd for Diagonal<'_, '_, '_, R> {
    type Output = Option<Vec<BlockInverse>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let system = self.products.system;
        let block = |place: usize| &system.block_systems[system.blocks[place] as usize];
        let mut squares: Vec<Square<R>> = self.places.clone().map(|place| whole(&block(place).stiffness)).collect();
        for &k in self.closed {
            let contact = system.contact(k);
            let resistance = contact.resistance();
            for (arm, place) in system.arms(contact).into_iter().zip(system.sides[k as usize]) {
                let Some(inner) = (place as usize).checked_sub(self.places.start) else { continue };
                let Some(square) = squares.get_mut(inner) else { continue };
                let [rows, products] = resisted(&resistance, arm);
                add_outer(square, &rows, &products, R::from_f64(1.0));
            }
        }
        squares.iter().zip(self.places).map(|(square, place)| BlockInverse::of(square, block(place).unknowns)).collect()
    }
}

/// Filling a panel of the coarse level.
struct Coarse<'c, 'p, 's, R> {
    products: &'c Products<'p, 's, R>,
    groups: &'c Groups,
    arms: &'c [Vector<R>],
    panel: usize,
    /// The closed contacts that bear on it.
    bearing: &'c [u32],
    values: &'c mut [R],
}

impl<R: Real + Send + Sync> WithSimd for Coarse<'_, '_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Coarse { products: Products { system, .. }, groups, arms, panel, bearing, values } = self;
        let pattern = &groups.pattern;
        let mut add = |row: usize, column: usize, square: &Square<R>| {
            let Some((at, stride)) = pattern.part_of(panel, row, column) else { return };
            for k in 0..pattern.unknowns(column).len() {
                let values = &mut values[at + stride * k..][..pattern.unknowns(row).len()];
                values.iter_mut().zip(square).for_each(|(value, row)| *value = *value + row[k]);
            }
        };
        for group in pattern.nodes(panel) {
            let mut square = [[R::ZERO; 12]; 12];
            for &place in groups.places.of(group) {
                let block = &system.block_systems[system.blocks[place as usize] as usize];
                // PᵀK, row by row, then PᵀKP: both are what the group has of the columns of a symmetric matrix.
                let matrix = whole(&block.stiffness);
                let half: Square<R> = std::array::from_fn(|k| to_group(arms[place as usize], &matrix[k]));
                for k in 0..12 {
                    let column = std::array::from_fn::<R, 12, _>(|row| half[row][k]);
                    let column = to_group(arms[place as usize], &column);
                    square[k].iter_mut().zip(column).for_each(|(sum, value)| *sum = *sum + value);
                }
            }
            add(group, group, &square);
        }
        let sides = |k: u32| system.sides[k as usize];
        for same in bearing.chunk_by(|&k, &m| sides(k) == sides(m)) {
            let places = sides(same[0]);
            let [i, j] = places.map(|place| (place != NO_PLACE).then(|| groups.of_place[place as usize] as usize));
            // Within a group both points move by the same displacement, but for their gap.
            if i == j {
                continue;
            }
            let is_own = |group: &usize| pattern.panel(*group) == panel;
            let between = i.zip(j).map(|(i, j)| [i.max(j), i.min(j)]).filter(|[_, column]| is_own(column));
            let (own_i, own_j) = (i.filter(is_own), j.filter(is_own));
            let far = places.map(|place| if place == NO_PLACE { Vector::ZERO } else { arms[place as usize] });
            let mut squares = [[[R::ZERO; 12]; 12]; 3];
            let one = R::from_f64(1.0);
            for &k in same {
                let contact = system.contact(k);
                let resistance = contact.resistance();
                let near = system.arms(contact);
                let [[e, pressed], [g, against]] = [0, 1].map(|side| resisted(&resistance, near[side] + far[side]));
                if own_i.is_some() {
                    add_outer(&mut squares[0], &e, &pressed, one);
                }
                if own_j.is_some() {
                    add_outer(&mut squares[1], &g, &against, one);
                }
                match between {
                    // Rows belong to the later group.
                    Some([row, _]) if Some(row) == i => add_outer(&mut squares[2], &e, &against, -one),
                    Some(_) => add_outer(&mut squares[2], &g, &pressed, -one),
                    None => {}
                }
            }
            if let Some(i) = own_i {
                add(i, i, &squares[0]);
            }
            if let Some(j) = own_j {
                add(j, j, &squares[1]);
            }
            if let Some([row, column]) = between {
                add(row, column, &squares[2]);
            }
        }
    }
}

/// Applying both levels at some places.
struct Applying<'a, 't, 's, R> {
    level: &'a TwoLevel<'t, 's, R>,
    residual: &'a [R],
    /// What the coarse level says.
    motions: &'a [f32],
    part: Part<'a, R>,
}

impl<R: Real + Send + Sync> WithSimd for Applying<'_, '_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Applying { level: TwoLevel { system, groups, inverses, arms, .. }, residual, motions, mut part } = self;
        let fine = &system.layout.pattern;
        for place in part.places.clone() {
            let Some(into) = part.at(fine, place) else { continue };
            let residual = &residual[fine.unknowns(place)];
            let group = &motions[groups.pattern.unknowns(groups.of_place[place] as usize)];
            let mut motion = [R::ZERO; 12];
            motion.iter_mut().zip(group).for_each(|(motion, &x)| *motion = R::from_f64(f64::from(x)));
            let moved = displacement(arms[place], &motion).components();
            motion[..3].copy_from_slice(&moved);
            let own = inverses[place].times(residual);
            for (into, (&motion, own)) in into.iter_mut().zip(motion.iter().zip(own)) {
                *into = motion + R::from_f64(f64::from(own));
            }
        }
    }
}
