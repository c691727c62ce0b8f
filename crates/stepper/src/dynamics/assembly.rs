//! The matrix of an island, added up panel by panel where the factor will stand.

use crate::dynamics::displacement::{BlockVector, generalized};
use crate::dynamics::island::packed;
use crate::dynamics::system::{Lists, NO_PLACE, Spring, System, springs};
use crate::real::Real;
use pulp::{Arch, Simd, WithSimd};

impl<R: Real + Send + Sync> System<'_, R> {
    /// Of each panel that is to be filled the closed contacts that bear on it, ascending.
    pub(super) fn bearing(&self, marked: &[bool]) -> Lists {
        let panel = |place: u32| {
            let panel = if place == NO_PLACE { return NO_PLACE } else { self.layout.pattern.panel(place as usize) };
            if marked[panel] { panel as u32 } else { NO_PLACE }
        };
        Lists::of_both(marked.len(), &self.sides, panel)
    }

    /// Adds the matrix in a panel to its values, which are zero. `bearing` has the contacts that bear on it.
    pub(super) fn fill(&self, panel: usize, bearing: &Lists, values: &mut [R]) {
        Arch::new().dispatch(Filling { system: self, panel, bearing: bearing.of(panel), values });
    }

    /// Where what ties two blocks stands in a panel.
    fn pair_parts(&self, panel: usize, sides: [u32; 2]) -> PairParts {
        let pattern = &self.layout.pattern;
        let part = |row: usize, column: usize| {
            if pattern.panel(column) != panel {
                return None;
            }
            let (at, stride) = pattern.part_of(panel, row, column)?;
            Some(PanelPart { at, stride, rows: pattern.unknowns(row).len(), columns: pattern.unknowns(column).len() })
        };
        let [i, j] = sides.map(|place| (place != NO_PLACE).then_some(place as usize));
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

/// Filling a panel, by the widest instructions that the processor has. They change no bit: each sum is one of its own.
struct Filling<'f, 's, R> {
    system: &'f System<'s, R>,
    panel: usize,
    /// The closed contacts that bear on it.
    bearing: &'f [u32],
    values: &'f mut [R],
}

impl<R: Real + Send + Sync> WithSimd for Filling<'_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Filling { system, panel, bearing, values } = self;
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
        let mut rows = Rows { e: Vec::new(), g: Vec::new(), stiffness: Vec::new(), scaled: Vec::new() };
        let blocks = |k: u32| system.contact(k).entering();
        for same in bearing.chunk_by(|&k, &m| blocks(k) == blocks(m)) {
            rows.clear();
            for contact in same.iter().map(|&k| system.contact(k)) {
                let [arm_i, arm_j] = system.arms(contact);
                for Spring { along, stiffness, .. } in springs(contact).into_iter().flatten() {
                    rows.e.push(generalized(arm_i, along));
                    rows.g.push(generalized(arm_j, along));
                    rows.stiffness.push(stiffness);
                }
            }
            rows.add(values, &system.pair_parts(panel, system.sides[same[0] as usize]));
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
