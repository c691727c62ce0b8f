//! The matrix and the right side of an island, added up panel by panel where the factor will stand.

use crate::dynamics::area::tangents;
use crate::dynamics::contact::StepContact;
use crate::dynamics::displacement::{BlockVector, displacement, generalized};
use crate::dynamics::island::{BlockSystem, packed};
use crate::dynamics::layout::IslandLayout;
use crate::dynamics::state::Mode;
use crate::real::Real;
use faer::traits::pulp::{Arch, Simd, WithSimd};

/// What the system of an island is made of.
pub(super) struct System<'s, R> {
    layout: &'s IslandLayout,
    block_systems: &'s [BlockSystem<R>],
    contacts: &'s [StepContact<R>],
    /// The closed contacts of the island.
    closed: &'s [usize],
    /// The blocks of the island, ascending.
    island: &'s [u32],
    /// The place of each block from the island's first to its last, where it has one; empty where few of them have one.
    places: Vec<u32>,
    /// The block of each place.
    blocks: Vec<u32>,
    /// Of each panel that is to be filled the closed contacts that bear on it, ascending: where they begin, and these.
    begins: Vec<u32>,
    bearing: Vec<u32>,
}

/// The place of a block that has none.
const NOWHERE: u32 = u32::MAX;

/// Of islands that reach over so many times more blocks than they have, blocks are searched for.
const SPARSE: usize = 16;

impl<'s, R: Real> System<'s, R> {
    /// Of blocks, where the panels that are marked are to be filled, none by an empty list; of all contacts those that are closed and in the island.
    pub(super) fn new(
        island: &'s [u32],
        layout: &'s IslandLayout,
        marked: &[bool],
        block_systems: &'s [BlockSystem<R>],
        (contacts, closed): (&'s [StepContact<R>], &'s [usize]),
    ) -> System<'s, R> {
        let (first, last) = (island.first().map_or(0, |&b| b as usize), island.last().map_or(0, |&b| b as usize));
        // Many islands that reach far must not take a table of all blocks each.
        let spread = if last - first < SPARSE * island.len() { last + 1 - first } else { 0 };
        let mut places = vec![NOWHERE; spread];
        let mut of_place = vec![0; island.len()];
        for (&block, &place) in island.iter().zip(&layout.places) {
            of_place[place as usize] = block;
            if let Some(known) = places.get_mut(block as usize - first) {
                *known = place;
            }
        }
        let mut system = System {
            layout,
            block_systems,
            contacts,
            closed,
            island,
            places,
            blocks: of_place,
            begins: vec![0; marked.len() + 1],
            bearing: Vec::new(),
        };
        if marked.is_empty() {
            return system;
        }
        let of = |system: &System<'_, R>, k: usize| {
            let panel = |block: u32| {
                let place = system.place(block as usize)?;
                Some(layout.pattern.panel(place)).filter(|&panel| marked[panel])
            };
            let [a, b] = contacts[k].blocks.map(panel);
            [a, b.filter(|_| a != b)]
        };
        for &k in closed {
            of(&system, k).into_iter().flatten().for_each(|panel| system.begins[panel + 1] += 1);
        }
        for panel in 0..marked.len() {
            system.begins[panel + 1] += system.begins[panel];
        }
        let mut next = system.begins.clone();
        system.bearing = vec![0; next[marked.len()] as usize];
        for &k in closed {
            for panel in of(&system, k).into_iter().flatten() {
                system.bearing[next[panel] as usize] = k as u32;
                next[panel] += 1;
            }
        }
        system
    }

    fn place(&self, block: usize) -> Option<usize> {
        if self.places.is_empty() {
            let found = self.island.binary_search(&(block as u32)).ok()?;
            return Some(self.layout.places[found] as usize);
        }
        let known = self.places.get(block.checked_sub(self.island[0] as usize)?)?;
        (*known != NOWHERE).then_some(*known as usize)
    }

    /// The right side.
    pub(super) fn force(&self) -> Vec<R> {
        let mut force = vec![R::ZERO; self.layout.pattern.size()];
        Arch::new().dispatch(Forcing { system: self, force: &mut force });
        force
    }

    /// Adds the matrix in a panel that is to be filled to its values, which are zero.
    pub(super) fn fill(&self, panel: usize, values: &mut [R]) {
        Arch::new().dispatch(Filling { system: self, panel, values });
    }

    /// The whole matrix times a vector, whatever panels are marked.
    pub(super) fn times(&self, vector: &[R]) -> Vec<R> {
        let mut product = vec![R::ZERO; vector.len()];
        Arch::new().dispatch(Multiplying { system: self, vector, product: &mut product });
        product
    }

    /// Where what ties two blocks stands in a panel.
    fn pair_parts(&self, panel: usize, blocks: [usize; 2]) -> PairParts {
        let pattern = &self.layout.pattern;
        let place = |block: usize| self.place(block);
        let part = |row: usize, column: usize| {
            if pattern.panel(column) != panel {
                return None;
            }
            let (at, stride) = pattern.part_of(panel, row, column)?;
            Some(PanelPart { at, stride, rows: pattern.unknowns(row).len(), columns: pattern.unknowns(column).len() })
        };
        let [i, j] = blocks.map(place);
        let own = [i, j].map(|place| place.and_then(|place| part(place, place)));
        // Rows belong to the later place.
        let between = i.zip(j).and_then(|(i, j)| part(i.max(j), i.min(j)));
        PairParts { own, between, i_is_later: i.zip(j).is_some_and(|(i, j)| i > j) }
    }
}

/// Where the parts of two blocks that a contact ties stand in a panel, as far as they do.
struct PairParts {
    own: [Option<PanelPart>; 2],
    between: Option<PanelPart>,
    i_is_later: bool,
}

/// A part of a panel: `at + row + stride·column`.
#[derive(Clone, Copy)]
struct PanelPart {
    at: usize,
    stride: usize,
    rows: usize,
    columns: usize,
}

/// A spring of length `before + e·d_i − g·d_j`.
struct Spring<R> {
    e: BlockVector<R>,
    g: BlockVector<R>,
    /// In N/m.
    stiffness: R,
    /// In m.
    before: R,
}

/// The springs of a closed contact.
#[inline(always)]
fn springs<R: Real>(contact: &StepContact<R>) -> [Option<Spring<R>>; 3] {
    let [e, g] = contact.rows();
    let normal = Some(Spring { e, g, stiffness: contact.joint.normal, before: contact.plane.gap });
    let across = |along, stiffness| {
        let [e, g] = contact.arms.map(|arm| generalized(arm, along));
        Some(Spring { e, g, stiffness, before: contact.stretch.dot(along) })
    };
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

/// Adding up the right side, as [`Filling`].
struct Forcing<'f, 's, R> {
    system: &'f System<'s, R>,
    force: &'f mut [R],
}

impl<R: Real> WithSimd for Forcing<'_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Forcing { system, force } = self;
        let pattern = &system.layout.pattern;
        for (place, &block) in system.blocks.iter().enumerate() {
            let unknowns = pattern.unknowns(place);
            let count = unknowns.len();
            force[unknowns].copy_from_slice(&system.block_systems[block as usize].force[..count]);
        }
        for contact in system.closed.iter().map(|&k| &system.contacts[k]) {
            let at = contact.entering().map(|block| system.place(block).map(|place| pattern.unknowns(place)));
            for Spring { e, g, stiffness, before } in springs(contact).into_iter().flatten() {
                for (at, row, factor) in [(&at[0], e, -stiffness * before), (&at[1], g, stiffness * before)] {
                    if let Some(at) = at {
                        add(&mut force[at.clone()], &row, factor);
                    }
                }
            }
            if contact.iterate.mode == Mode::Sliding {
                let acting = contact.iterate.friction.force;
                for (at, arm, acting) in [(&at[0], contact.arms[0], -acting), (&at[1], contact.arms[1], acting)] {
                    let Some(at) = at else { continue };
                    for (total, share) in force[at.clone()].iter_mut().zip(generalized(arm, acting)) {
                        *total = *total + share;
                    }
                }
            }
        }
    }
}

/// Filling a panel, by the widest instructions that the processor has. They change no bit: each sum is one of its own.
struct Filling<'f, 's, R> {
    system: &'f System<'s, R>,
    panel: usize,
    values: &'f mut [R],
}

impl<R: Real> WithSimd for Filling<'_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Filling { system, panel, values } = self;
        let pattern = &system.layout.pattern;
        for place in pattern.nodes(panel) {
            let block_systems = &system.block_systems[system.blocks[place] as usize];
            let Some((at, stride)) = pattern.part_of(panel, place, place) else { continue };
            let unknowns = pattern.unknowns(place).len();
            for column in 0..unknowns {
                let values = &mut values[at + stride * column..][..unknowns];
                for (row, value) in values.iter_mut().enumerate().skip(column) {
                    *value = block_systems.stiffness[packed(row, column)];
                }
            }
        }
        let bearing = system.begins[panel] as usize..system.begins[panel + 1] as usize;
        let mut rows = Rows { e: Vec::new(), g: Vec::new(), stiffness: Vec::new(), scaled: Vec::new() };
        let contact = |k: u32| &system.contacts[k as usize];
        for same in system.bearing[bearing].chunk_by(|&k, &m| contact(k).entering() == contact(m).entering()) {
            rows.clear();
            for &k in same {
                for spring in springs(contact(k)) {
                    let Some(spring) = spring else { break };
                    rows.e.push(spring.e);
                    rows.g.push(spring.g);
                    rows.stiffness.push(spring.stiffness);
                }
            }
            rows.add(values, &system.pair_parts(panel, contact(same[0]).entering()));
        }
    }
}

/// The rows of the springs between two blocks.
struct Rows<R> {
    e: Vec<BlockVector<R>>,
    g: Vec<BlockVector<R>>,
    /// In N/m.
    stiffness: Vec<R>,
    /// Rows times stiffness; kept to reuse its memory.
    scaled: Vec<BlockVector<R>>,
}

impl<R: Real> Rows<R> {
    fn clear(&mut self) {
        self.e.clear();
        self.g.clear();
        self.stiffness.clear();
    }

    /// Adds what the springs bring to the parts of the two blocks.
    #[inline(always)]
    fn add(&mut self, values: &mut [R], couplings: &PairParts) {
        let between = if couplings.i_is_later { (&self.g, &self.e) } else { (&self.e, &self.g) };
        let parts = [
            (couplings.own[0], (&self.e, &self.e), false),
            (couplings.own[1], (&self.g, &self.g), false),
            (couplings.between, between, true),
        ];
        for (part, (earlier, later), negative) in parts {
            let Some(part) = part else { continue };
            self.scaled.clear();
            for (row, &stiffness) in later.iter().zip(&self.stiffness) {
                let factor = if negative { -stiffness } else { stiffness };
                let mut scaled = *row;
                for r in &mut scaled {
                    *r = *r * factor;
                }
                self.scaled.push(scaled);
            }
            // Of known lengths, so that the loops can be unrolled.
            match part.rows {
                12 => add_coupling::<R, 12>(values, part, earlier, &self.scaled),
                6 => add_coupling::<R, 6>(values, part, earlier, &self.scaled),
                _ => {}
            }
        }
    }
}

/// Adds `Σ later·earlierᵀ` to a part of so many rows, one summand after another.
#[inline(always)]
fn add_coupling<R: Real, const ROWS: usize>(
    values: &mut [R],
    part: PanelPart,
    earlier: &[BlockVector<R>],
    later: &[BlockVector<R>],
) {
    for column in 0..part.columns.min(12) {
        let Some(values) = values[part.at + part.stride * column..].first_chunk_mut::<ROWS>() else { continue };
        let mut sums = *values;
        for (earlier, later) in earlier.iter().zip(later) {
            let factor = earlier[column];
            for row in 0..ROWS {
                sums[row] = sums[row] + later[row] * factor;
            }
        }
        *values = sums;
    }
}

/// Multiplying by the matrix, as [`Filling`].
struct Multiplying<'m, 's, R> {
    system: &'m System<'s, R>,
    vector: &'m [R],
    product: &'m mut [R],
}

impl<R: Real> WithSimd for Multiplying<'_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Multiplying { system, vector, product } = self;
        let pattern = &system.layout.pattern;
        for (place, &block) in system.blocks.iter().enumerate() {
            let (block_systems, at) = (&system.block_systems[block as usize], pattern.unknowns(place));
            let (vector, product) = (&vector[at.clone()], &mut product[at]);
            for row in 0..vector.len() {
                for column in 0..=row {
                    let value = block_systems.stiffness[packed(row, column)];
                    product[row] = product[row] + value * vector[column];
                    if column < row {
                        product[column] = product[column] + value * vector[row];
                    }
                }
            }
        }
        for &k in system.closed {
            let contact = &system.contacts[k];
            let at = contact.entering().map(|block| system.place(block).map(|place| pattern.unknowns(place)));
            let moved = |side: usize| {
                let mut d = [R::ZERO; 12];
                if let Some(at) = &at[side] {
                    d[..at.len()].copy_from_slice(&vector[at.clone()]);
                }
                displacement(contact.arms[side], &d)
            };
            let pull = contact.resists(moved(0) - moved(1));
            for (at, arm, pull) in [(&at[0], contact.arms[0], pull), (&at[1], contact.arms[1], -pull)] {
                let Some(at) = at else { continue };
                for (total, share) in product[at.clone()].iter_mut().zip(generalized(arm, pull)) {
                    *total = *total + share;
                }
            }
        }
    }
}

/// Adds a row times a factor.
#[inline(always)]
fn add<R: Real>(values: &mut [R], row: &BlockVector<R>, factor: R) {
    for (value, &r) in values.iter_mut().zip(row) {
        *value = *value + r * factor;
    }
}
