//! The system of an island: which contact bears on which block, and the right side. `assembly.rs` adds up its matrix, `products.rs` multiplies by it.
//!
//! Threads share the blocks by parts that the system alone determines; to each block its contacts bring what they do one after another: the same
//! bits on any number of threads.

use crate::dynamics::area::tangents;
use crate::dynamics::contact::StepContact;
use crate::dynamics::displacement::{add, generalized};
use crate::dynamics::island::BlockSystem;
use crate::dynamics::layout::IslandLayout;
use crate::dynamics::state::Mode;
use crate::real::Real;
use crate::vector::Vector;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use rockproof_cholesky::Pattern;
use std::ops::Range;

/// What the system of an island is made of.
pub(super) struct System<'s, R> {
    pub(super) layout: &'s IslandLayout,
    pub(super) block_systems: &'s [BlockSystem<R>],
    contacts: &'s [StepContact<R>],
    /// The closed contacts of the island, by their places among all.
    closed: &'s [u32],
    /// The block of each place.
    pub(super) blocks: Vec<u32>,
    /// The places of blocks i and j of each closed contact; [`NO_PLACE`] where a block is fixed.
    pub(super) sides: Vec<[u32; 2]>,
    /// The closed contacts at each part of the places, ascending.
    at_part: Lists,
}

/// The place of a block that has none.
pub(super) const NO_PLACE: u32 = u32::MAX;

/// Of islands that reach over so many times more blocks than they have, blocks are searched for.
const SPARSE: usize = 16;

/// A thread takes so many contacts at a time.
pub(super) const CONTACTS_AT_ONCE: usize = 512;

/// A part has so many places. Contacts between two parts are looked at for both.
const PART: usize = 256;

/// Lists of numbers, one after another.
#[derive(Debug)]
pub(super) struct Lists {
    /// Where each begins, and where the last ends.
    begins: Vec<u32>,
    all: Vec<u32>,
}

impl Lists {
    /// Of pairs, by number: each stands in the lists of both of its members, once if that is the same list, and in none if it is [`NO_PLACE`].
    #[inline(always)]
    pub(super) fn of_both(count: usize, pairs: &[[u32; 2]], list: impl Fn(u32) -> u32) -> Lists {
        let mut begins = vec![0u32; count + 1];
        for pair in pairs {
            let [one, other] = pair.map(&list);
            if one != NO_PLACE {
                begins[one as usize + 1] += 1;
            }
            if other != NO_PLACE && other != one {
                begins[other as usize + 1] += 1;
            }
        }
        for list in 0..count {
            begins[list + 1] += begins[list];
        }
        let (mut next, mut all) = (begins.clone(), vec![0; begins[count] as usize]);
        let mut put = |list: u32, number: u32| {
            let next = &mut next[list as usize];
            all[*next as usize] = number;
            *next += 1;
        };
        for (number, pair) in (0..).zip(pairs) {
            let [one, other] = pair.map(&list);
            if one != NO_PLACE {
                put(one, number);
            }
            if other != NO_PLACE && other != one {
                put(other, number);
            }
        }
        Lists { begins, all }
    }

    pub(super) fn of(&self, list: usize) -> &[u32] {
        &self.all[self.begins[list] as usize..self.begins[list + 1] as usize]
    }
}

/// A part of the places, and numbers of their unknowns.
pub(super) struct Part<'p, R> {
    pub(super) places: Range<usize>,
    /// The closed contacts at them, ascending.
    pub(super) closed: &'p [u32],
    /// Their first unknown.
    begin: usize,
    values: &'p mut [R],
}

impl<R> Part<'_, R> {
    /// The numbers of a place, if it belongs to the part.
    #[inline(always)]
    pub(super) fn at(&mut self, pattern: &Pattern, place: usize) -> Option<&mut [R]> {
        let unknowns = self.places.contains(&place).then(|| pattern.unknowns(place))?;
        Some(&mut self.values[unknowns.start - self.begin..unknowns.end - self.begin])
    }
}

impl<'s, R: Real + Send + Sync> System<'s, R> {
    /// Of blocks, ascending; of all contacts those that are closed and in the island.
    pub(super) fn new(
        island: &'s [u32],
        layout: &'s IslandLayout,
        block_systems: &'s [BlockSystem<R>],
        (contacts, closed): (&'s [StepContact<R>], &'s [u32]),
    ) -> System<'s, R> {
        let (first, last) = (island.first().map_or(0, |&b| b as usize), island.last().map_or(0, |&b| b as usize));
        // Many islands that reach far must not take a table of all blocks each.
        let spread = if last - first < SPARSE * island.len() { last + 1 - first } else { 0 };
        let mut places = vec![NO_PLACE; spread];
        let mut blocks = vec![0; island.len()];
        for (&block, &place) in island.iter().zip(&layout.places) {
            blocks[place as usize] = block;
            if let Some(known) = places.get_mut(block as usize - first) {
                *known = place;
            }
        }
        let place = |block: usize| {
            if places.is_empty() {
                return island.binary_search(&(block as u32)).map_or(NO_PLACE, |found| layout.places[found]);
            }
            block.checked_sub(first).and_then(|block| places.get(block)).copied().unwrap_or(NO_PLACE)
        };
        let sides = |&k: &u32| contacts[k as usize].entering().map(place);
        let sides: Vec<[u32; 2]> = closed.par_iter().with_min_len(CONTACTS_AT_ONCE).map(sides).collect();
        let at_part = lists_by_part(blocks.len(), &sides);
        System { layout, block_systems, contacts, closed, blocks, sides, at_part }
    }

    /// Pairs of places at each part of the places.
    pub(super) fn lists_by_part(&self, pairs: &[[u32; 2]]) -> Lists {
        lists_by_part(self.blocks.len(), pairs)
    }

    /// A closed contact of the island.
    pub(super) fn contact(&self, closed: u32) -> &'s StepContact<R> {
        &self.contacts[self.closed[closed as usize] as usize]
    }

    /// Where a contact is from the centroids of blocks i and j (m).
    #[inline(always)]
    pub(super) fn arms(&self, contact: &StepContact<R>) -> [Vector<R>; 2] {
        contact.arms(contact.entering().map(|block| self.block_systems[block].centroid))
    }

    /// Parts of the places that threads can share, and the closed contacts at each.
    pub(super) fn places_by_part(&self) -> impl Iterator<Item = (Range<usize>, &[u32])> {
        let count = self.blocks.len();
        let part = move |first: usize| (first..(first + PART).min(count), self.at_part.of(first / PART));
        (0..count).step_by(PART).map(part)
    }

    /// Cuts a vector into parts that threads can share.
    pub(super) fn parts<'p>(&'p self, vector: &'p mut [R]) -> Vec<Part<'p, R>> {
        let (mut parts, mut rest, mut begin) = (Vec::new(), vector, 0);
        for (places, closed) in self.places_by_part() {
            let end = self.layout.pattern.unknowns(places.end - 1).end;
            let (values, others) = rest.split_at_mut(end - begin);
            parts.push(Part { places, closed, begin, values });
            (rest, begin) = (others, end);
        }
        parts
    }

    /// The right side.
    pub(super) fn force(&self) -> Vec<R> {
        let mut force = vec![R::ZERO; self.layout.pattern.size()];
        self.parts(&mut force).into_par_iter().for_each(|part| Arch::new().dispatch(Forcing { system: self, part }));
        force
    }
}

/// Pairs of so many places at each part of them.
fn lists_by_part(places: usize, pairs: &[[u32; 2]]) -> Lists {
    let part = |place: u32| if place == NO_PLACE { NO_PLACE } else { place / PART as u32 };
    Lists::of_both(places.div_ceil(PART), pairs, part)
}

/// A spring of length `before + along·(T_i d_i − T_j d_j)`.
pub(super) struct Spring<R> {
    pub(super) along: Vector<R>,
    /// In N/m.
    pub(super) stiffness: R,
    /// In m.
    before: R,
}

/// The springs of a closed contact.
#[inline(always)]
pub(super) fn springs<R: Real>(contact: &StepContact<R>) -> [Option<Spring<R>>; 3] {
    let normal =
        Some(Spring { along: contact.plane.normal, stiffness: contact.joint.normal, before: contact.plane.gap });
    let stretch = contact.first_stretch();
    let across = |along: Vector<R>, stiffness| Some(Spring { along, stiffness, before: stretch.dot(along) });
    let friction = &contact.iterate.friction;
    match contact.iterate.mode {
        Mode::Locked => {
            let (one, two) = tangents(contact.plane.normal);
            [normal, across(one, contact.joint.shear), across(two, contact.joint.shear)]
        }
        Mode::Sliding if friction.is_stiff() => [normal, across(friction.across, friction.spring), None],
        Mode::Sliding | Mode::Open => [normal, None, None],
    }
}

/// Adding up the right side at some places, by the widest instructions that the processor has. They change no bit: each sum is one of its own.
struct Forcing<'f, 's, 'p, R> {
    system: &'f System<'s, R>,
    part: Part<'p, R>,
}

impl<R: Real + Send + Sync> WithSimd for Forcing<'_, '_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Forcing { system, mut part } = self;
        let pattern = &system.layout.pattern;
        for place in part.places.clone() {
            let Some(force) = part.at(pattern, place) else { continue };
            let count = force.len();
            force.copy_from_slice(&system.block_systems[system.blocks[place] as usize].force[..count]);
        }
        for &k in part.closed {
            let (contact, sides) = (system.contact(k), system.sides[k as usize]);
            let [arm_i, arm_j] = system.arms(contact);
            for Spring { along, stiffness, before } in springs(contact).into_iter().flatten() {
                if let Some(force) = part.at(pattern, sides[0] as usize) {
                    add(force, &generalized(arm_i, along), Some(-stiffness * before));
                }
                if let Some(force) = part.at(pattern, sides[1] as usize) {
                    add(force, &generalized(arm_j, along), Some(stiffness * before));
                }
            }
            if contact.iterate.mode == Mode::Sliding {
                let acting = contact.iterate.friction.force;
                if let Some(force) = part.at(pattern, sides[0] as usize) {
                    add(force, &generalized(arm_i, -acting), None);
                }
                if let Some(force) = part.at(pattern, sides[1] as usize) {
                    add(force, &generalized(arm_j, acting), None);
                }
            }
        }
    }
}
