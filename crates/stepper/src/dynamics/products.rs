//! The matrix of an island times vectors. It is not kept: what blocks bring and what closed contacts bring is multiplied one by one.
//!
//! Threads share it as they do the right side (`system.rs`): the same bits on any number of threads.

use crate::dynamics::contact::Resistance;
use crate::dynamics::displacement::{BlockVector, add, displacement, generalized};
use crate::dynamics::island::{PackedBlockMatrix, packed};
use crate::dynamics::system::{CONTACTS_AT_ONCE, NO_PLACE, Part, System};
use crate::real::Real;
use crate::vector::Vector;
use faer::traits::pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// The matrix of an island, ready to be multiplied.
pub(super) struct Products<'p, 's, R> {
    pub(super) system: &'p System<'s, R>,
    /// One for each closed contact.
    pub(super) resisting: Vec<ResistingContact<R>>,
}

/// What a closed contact brings: of a contact in work that alone, since all are read with every product.
pub(super) struct ResistingContact<R> {
    pub(super) arms: [Vector<R>; 2],
    pub(super) resistance: Resistance<R>,
}

impl<'p, 's, R: Real + Send + Sync> Products<'p, 's, R> {
    pub(super) fn new(system: &'p System<'s, R>) -> Products<'p, 's, R> {
        let of_contact = |k: usize| {
            let contact = system.contact(k as u32);
            ResistingContact { arms: contact.arms, resistance: contact.resistance() }
        };
        let all = (0..system.sides.len()).into_par_iter().with_min_len(CONTACTS_AT_ONCE);
        Products { system, resisting: all.map(of_contact).collect() }
    }

    /// How many times as stiff the springs at the blocks are as their inertia is in this step, in the mean over translations.
    pub(super) fn springs_to_inertia(&self) -> f64 {
        let moving = |sides: &[u32; 2]| sides.iter().filter(|&&place| place != NO_PLACE).count() as f64;
        let springs = self.resisting.iter().zip(&self.system.sides);
        let springs: f64 = springs.map(|(contact, sides)| moving(sides) * contact.resistance.trace().to_f64()).sum();
        let inertia = |&block: &u32| {
            let stiffness = &self.system.block_systems[block as usize].stiffness;
            (0..3).map(|axis| stiffness[packed(axis, axis)].to_f64()).sum::<f64>()
        };
        springs / self.system.blocks.iter().map(inertia).sum::<f64>()
    }

    /// The whole matrix times a vector.
    pub(super) fn times(&self, vector: &[R]) -> Vec<R> {
        let mut product = vec![R::ZERO; vector.len()];
        let parts = self.system.parts(&mut product).into_par_iter();
        parts.for_each(|part| Arch::new().dispatch(Multiplying { products: self, vector, part }));
        product
    }
}

/// Multiplying at some places, by the widest instructions that the processor has. They change no bit: each sum is one of its own.
struct Multiplying<'m, 'p, 's, R> {
    products: &'m Products<'p, 's, R>,
    vector: &'m [R],
    part: Part<'m, R>,
}

impl<R: Real + Send + Sync> WithSimd for Multiplying<'_, '_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Multiplying { products: Products { system, resisting }, vector, mut part } = self;
        let pattern = &system.layout.pattern;
        for place in part.places.clone() {
            let block_system = &system.block_systems[system.blocks[place] as usize];
            let vector = &vector[pattern.unknowns(place)];
            let Some(product) = part.at(pattern, place) else { continue };
            if let (Some(product), Some(vector)) = (product.first_chunk_mut::<12>(), vector.first_chunk()) {
                multiply(product, &block_system.stiffness, vector);
            } else if let (Some(product), Some(vector)) = (product.first_chunk_mut::<6>(), vector.first_chunk()) {
                multiply(product, &block_system.stiffness, vector);
            }
        }
        for &k in part.closed {
            let (contact, sides) = (&resisting[k as usize], system.sides[k as usize]);
            let mut d: [BlockVector<R>; 2] = [[R::ZERO; 12]; 2];
            for (d, place) in d.iter_mut().zip(sides) {
                if place != NO_PLACE {
                    let at = pattern.unknowns(place as usize);
                    d[..at.len()].copy_from_slice(&vector[at]);
                }
            }
            let [i, j] = [displacement(contact.arms[0], &d[0]), displacement(contact.arms[1], &d[1])];
            let pull = contact.resistance.against(i - j);
            if let Some(product) = part.at(pattern, sides[0] as usize) {
                add(product, &generalized(contact.arms[0], pull), None);
            }
            if let Some(product) = part.at(pattern, sides[1] as usize) {
                add(product, &generalized(contact.arms[1], -pull), None);
            }
        }
    }
}

/// Adds the matrix of a block times a vector. Of a known size, so that the loops can be unrolled.
#[inline(always)]
fn multiply<R: Real, const UNKNOWNS: usize>(
    product: &mut [R; UNKNOWNS],
    matrix: &PackedBlockMatrix<R>,
    vector: &[R; UNKNOWNS],
) {
    for row in 0..UNKNOWNS {
        for column in 0..=row {
            let value = matrix[packed(row, column)];
            product[row] = product[row] + value * vector[column];
            if column < row {
                product[column] = product[column] + value * vector[row];
            }
        }
    }
}
