//! Which blocks are solved together.

/// Blocks that closed contacts tie together: their system can be solved apart.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Island {
    /// Ascending.
    pub(crate) blocks: Vec<usize>,
    /// The closed contacts with a block of it, ascending.
    pub(crate) contacts: Vec<usize>,
}

/// All islands of one solve.
#[derive(Debug, Default)]
pub(crate) struct Islands {
    pub(crate) all: Vec<Island>,
    /// The place of each block in `all`; `None` for a block without unknowns.
    of: Vec<Option<usize>>,
}

impl Islands {
    /// The islands of blocks with unknowns, `moves` says which have any. What has none ties nothing. `closed` are closed contacts and their blocks,
    /// ascending.
    pub(super) fn new(moves: &[bool], closed: &[(usize, [usize; 2])]) -> Islands {
        let mut lowest: Vec<usize> = (0..moves.len()).collect();
        for &(_, [i, j]) in closed.iter().filter(|(_, blocks)| blocks.iter().all(|&block| moves[block])) {
            let (from, to) = (lowest[i].max(lowest[j]), lowest[i].min(lowest[j]));
            if from != to {
                lowest.iter_mut().filter(|place| **place == from).for_each(|place| *place = to);
            }
        }
        let mut islands = Islands { all: Vec::new(), of: vec![None; moves.len()] };
        for block in (0..moves.len()).filter(|&block| moves[block]) {
            let first = lowest[block];
            if first == block {
                islands.of[block] = Some(islands.all.len());
                islands.all.push(Island::default());
            }
            islands.of[block] = islands.of[first];
            if let Some(place) = islands.of[block] {
                islands.all[place].blocks.push(block);
            }
        }
        for (k, blocks) in closed {
            // Of both blocks it is one island, or one of them has none.
            if let Some(place) = blocks.iter().find_map(|&block| islands.of[block]) {
                islands.all[place].contacts.push(*k);
            }
        }
        islands
    }

    /// The place of a block's island in `all`.
    pub(super) fn of(&self, block: usize) -> Option<usize> {
        self.of[block]
    }
}

#[cfg(test)]
mod tests {
    use super::{Island, Islands};

    fn island(blocks: &[usize], contacts: &[usize]) -> Island {
        Island { blocks: blocks.to_vec(), contacts: contacts.to_vec() }
    }

    #[test]
    fn blocks_that_meet_through_others_are_one_island() {
        // 0 meets 3, 1 meets 2, then 2 meets 3: all one. 4 stays alone.
        let closed = [(0, [3, 0]), (2, [1, 2]), (5, [2, 3])];
        let islands = Islands::new(&[true; 5], &closed);
        assert_eq!(islands.all, [island(&[0, 1, 2, 3], &[0, 2, 5]), island(&[4], &[])]);
        assert_eq!([2, 4].map(|block| islands.of(block)), [Some(0), Some(1)]);
    }

    #[test]
    fn what_has_no_unknowns_ties_nothing() {
        let islands = Islands::new(&[true, false, true], &[(1, [0, 1]), (3, [1, 2]), (4, [2, 1])]);
        assert_eq!(islands.all, [island(&[0], &[1]), island(&[2], &[3, 4])]);
        assert_eq!(islands.of(1), None);
    }
}
