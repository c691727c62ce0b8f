//! The matrix of an island times vectors. It is not kept: what blocks bring, and what closed contacts bring, is multiplied block by block and contact by
//! contact. All three components of a vector are calculated at once; what the contacts of a pair do to its blocks is added up before it is turned into
//! forces on their unknowns.
//!
//! Threads share it as they do the right side (`system.rs`): the same bits on any number of threads.

use crate::dynamics::displacement::{BlockVector, add};
use crate::dynamics::island::{PackedBlockMatrix, packed};
use crate::dynamics::system::{CONTACTS_AT_ONCE, Lists, NO_PLACE, Part, System};
use crate::real::Real;
use crate::vector::Vector;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// So many numbers are multiplied at once: three components of a vector, and a fourth that means nothing.
const LANES: usize = 4;

type Lanes<R> = [R; LANES];

/// The matrix of an island, ready to be multiplied.
pub(super) struct Products<'p, 's, R> {
    pub(super) system: &'p System<'s, R>,
    pairs: Vec<TouchingPair>,
    contacts: Vec<ResistingContact<R>>,
    /// The pairs at each part of the places.
    at_part: Lists,
}

/// Two blocks with closed contacts.
struct TouchingPair {
    /// Places of A and B; [`NO_PLACE`] of a fixed one.
    places: [u32; 2],
    /// The first of its contacts, and the first after them.
    contacts: [u32; 2],
}

/// What a closed contact brings: the arms from the centroids of A and of B, the columns of its springs' matrix, and a number without meaning, so that
/// four numbers can be read from where a column begins.
struct ResistingContact<R>([R; 16]);

impl<'p, 's, R: Real + Send + Sync> Products<'p, 's, R> {
    pub(super) fn new(system: &'p System<'s, R>) -> Products<'p, 's, R> {
        let count = system.sides.len() as u32;
        let mut pairs = Vec::new();
        let mut first = 0;
        while first < count {
            let contact = system.contact(first);
            let [i, j] = system.sides[first as usize];
            let same = (first..count).take_while(|&k| system.contact(k).blocks == contact.blocks).count() as u32;
            let places = if contact.plane.a_enters { [i, j] } else { [j, i] };
            pairs.push(TouchingPair { places, contacts: [first, first + same] });
            first += same;
        }
        let of_contact = |k: u32| {
            let contact = system.contact(k);
            let ([i, j], resistance) = (system.arms(contact), contact.resistance());
            let [a, b] = if contact.plane.a_enters { [i, j] } else { [j, i] };
            let unit = |axis: usize| {
                let [x, y, z] = std::array::from_fn(|k| R::from_f64(if k == axis { 1.0 } else { 0.0 }));
                resistance.against(Vector::new(x, y, z))
            };
            let mut numbers = [R::ZERO; 16];
            for (three, vector) in numbers.chunks_exact_mut(3).zip([a, b, unit(0), unit(1), unit(2)]) {
                three.copy_from_slice(&vector.components());
            }
            ResistingContact(numbers)
        };
        let contacts = (0..count).into_par_iter().with_min_len(CONTACTS_AT_ONCE).map(of_contact).collect();
        let both: Vec<[u32; 2]> = pairs.iter().map(|pair| pair.places).collect();
        let at_part = system.lists_by_part(&both);
        Products { system, pairs, contacts, at_part }
    }

    /// How many times as stiff the springs at the blocks are as their inertia is in this step, in the mean over translations.
    pub(super) fn springs_to_inertia(&self) -> f64 {
        let moving = |sides: &[u32; 2]| sides.iter().filter(|&&place| place != NO_PLACE).count() as f64;
        let stiffness = |k: u32| self.system.contact(k).resistance().trace().to_f64();
        let springs: f64 = (0..).zip(&self.system.sides).map(|(k, sides)| moving(sides) * stiffness(k)).sum();
        let inertia = |&block: &u32| {
            let stiffness = &self.system.block_systems[block as usize].stiffness;
            (0..3).map(|axis| stiffness[packed(axis, axis)].to_f64()).sum::<f64>()
        };
        springs / self.system.blocks.iter().map(inertia).sum::<f64>()
    }

    /// The whole matrix times a vector.
    pub(super) fn times(&self, vector: &[R]) -> Vec<R> {
        let mut product = vec![R::ZERO; vector.len()];
        let parts = self.system.parts(&mut product).into_par_iter().enumerate();
        parts.for_each(|(number, part)| {
            let pairs = self.at_part.of(number);
            Arch::new().dispatch(Multiplying { products: self, vector, pairs, part });
        });
        product
    }
}

/// Multiplying at some places, by the widest instructions that the processor has. They change no bit: each sum is one of its own.
struct Multiplying<'m, 'p, 's, R> {
    products: &'m Products<'p, 's, R>,
    vector: &'m [R],
    /// Those at the places.
    pairs: &'m [u32],
    part: Part<'m, R>,
}

impl<R: Real + Send + Sync> WithSimd for Multiplying<'_, '_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Multiplying { products: Products { system, pairs, contacts, .. }, vector, pairs: own, mut part } = self;
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
        for &pair in own {
            let TouchingPair { places, contacts: [begin, end] } = pairs[pair as usize];
            let motion = |place: u32| match place {
                NO_PLACE => Gradient::of(&[R::ZERO; 12]),
                place => Gradient::of(&whole(&vector[pattern.unknowns(place as usize)])),
            };
            let [a, b] = places.map(motion);
            let mut force = [R::ZERO; LANES];
            let mut moments = [[[R::ZERO; LANES]; 3]; 2];
            for ResistingContact(numbers) in &contacts[begin as usize..end as usize] {
                let arm = |at: usize| [numbers[at], numbers[at + 1], numbers[at + 2]];
                let apart = difference(a.of_point(arm(0)), b.of_point(arm(3)));
                let [x, y, z] = [(apart[0], 6), (apart[1], 9), (apart[2], 12)]
                    .map(|(along, at)| product([along; LANES], four(numbers, at)));
                let pull = sum(sum(x, y), z);
                force = sum(force, pull);
                for (moments, at) in moments.iter_mut().zip([0, 3]) {
                    for (moment, along) in moments.iter_mut().zip(arm(at)) {
                        *moment = sum(*moment, product([along; LANES], pull));
                    }
                }
            }
            if let Some(product) = part.at(pattern, places[0] as usize) {
                add(product, &of_moments(&force, &moments[0]), None);
            }
            if let Some(product) = part.at(pattern, places[1] as usize) {
                add(product, &of_moments(&force, &moments[1]).map(|x| -x), None);
            }
        }
    }
}

/// The unknowns of a block, zero where it has no such unknown. Of known lengths, so that nothing need be called.
#[inline(always)]
fn whole<R: Real>(unknowns: &[R]) -> BlockVector<R> {
    if let Some(all) = unknowns.first_chunk::<12>() {
        return *all;
    }
    let mut whole = [R::ZERO; 12];
    if let (Some(six), Some(unknowns)) = (whole.first_chunk_mut::<6>(), unknowns.first_chunk::<6>()) {
        *six = *unknowns;
    }
    whole
}

/// What the unknowns of a block do to its points: a translation, and for each component of the arm what it adds.
struct Gradient<R>([Lanes<R>; 4]);

impl<R: Real> Gradient<R> {
    #[inline(always)]
    fn of(d: &BlockVector<R>) -> Gradient<R> {
        let (zero, half) = (R::ZERO, R::from_f64(0.5));
        let (yz, zx, xy) = (d[9] * half, d[10] * half, d[11] * half);
        Gradient([
            [d[0], d[1], d[2], zero],
            [d[6], xy + d[5], zx - d[4], zero],
            [xy - d[5], d[7], yz + d[3], zero],
            [zx + d[4], yz - d[3], d[8], zero],
        ])
    }

    #[inline(always)]
    fn of_point(&self, [x, y, z]: [R; 3]) -> Lanes<R> {
        let Gradient([shift, along_x, along_y, along_z]) = *self;
        let stretched = sum(product(along_x, [x; LANES]), product(along_y, [y; LANES]));
        sum(sum(shift, stretched), product(along_z, [z; LANES]))
    }
}

/// What forces do to twelve unknowns, from their sum and from that of their products with each component of the arms.
#[inline(always)]
fn of_moments<R: Real>(force: &Lanes<R>, moments: &[Lanes<R>; 3]) -> BlockVector<R> {
    let half = R::from_f64(0.5);
    let ([x, y, z, _], [[xx, xy, xz, _], [yx, yy, yz, _], [zx, zy, zz, _]]) = (*force, *moments);
    [x, y, z, yz - zy, zx - xz, xy - yx, xx, yy, zz, (zy + yz) * half, (zx + xz) * half, (yx + xy) * half]
}

#[inline(always)]
fn four<R: Real>(values: &[R], at: usize) -> Lanes<R> {
    [values[at], values[at + 1], values[at + 2], values[at + 3]]
}

#[inline(always)]
fn sum<R: Real>(a: Lanes<R>, b: Lanes<R>) -> Lanes<R> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}

#[inline(always)]
fn difference<R: Real>(a: Lanes<R>, b: Lanes<R>) -> Lanes<R> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

#[inline(always)]
fn product<R: Real>(a: Lanes<R>, b: Lanes<R>) -> Lanes<R> {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]]
}

#[inline(always)]
fn total<R: Real>(lanes: Lanes<R>) -> R {
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3])
}

/// Adds the matrix of a block times a vector: of each row four columns at once, but for those beside the diagonal.
#[inline(always)]
fn multiply<R: Real, const UNKNOWNS: usize>(
    sums: &mut [R; UNKNOWNS],
    matrix: &PackedBlockMatrix<R>,
    vector: &[R; UNKNOWNS],
) {
    for row in 0..UNKNOWNS {
        let values = &matrix[packed(row, 0)..][..=row];
        let (known, beside) = (vector[row], row - row % LANES);
        let mut lanes = [R::ZERO; LANES];
        for at in (0..beside).step_by(LANES) {
            let values = four(values, at);
            lanes = sum(lanes, product(values, four(vector, at)));
            let added = sum(four(sums, at), product(values, [known; LANES]));
            sums[at..at + LANES].copy_from_slice(&added);
        }
        let mut own = total(lanes) + values[row] * known;
        for column in beside..row {
            own = own + values[column] * vector[column];
            sums[column] = sums[column] + values[column] * known;
        }
        sums[row] = sums[row] + own;
    }
}
