//! Which blocks are solved together.

/// The blocks with unknowns that pairs tie together, each list ascending: systems that can be solved apart. `None` where one of them has more
/// than `most` unknowns. `sizes` are the unknowns of each block; what has none ties nothing.
pub(super) fn islands_up_to(
    most: usize,
    sizes: &[usize],
    pairs: impl Iterator<Item = [usize; 2]>,
) -> Option<Vec<Vec<usize>>> {
    let mut lowest: Vec<usize> = (0..sizes.len()).collect();
    for [i, j] in pairs.filter(|blocks| blocks.iter().all(|&block| sizes[block] > 0)) {
        let (from, to) = (lowest[i].max(lowest[j]), lowest[i].min(lowest[j]));
        if from != to {
            lowest.iter_mut().filter(|place| **place == from).for_each(|place| *place = to);
        }
    }
    let mut islands = vec![Vec::new(); sizes.len()];
    for (block, &lowest) in lowest.iter().enumerate().filter(|(block, _)| sizes[*block] > 0) {
        islands[lowest].push(block);
    }
    islands.retain(|island| !island.is_empty());
    let unknowns = |island: &Vec<usize>| island.iter().map(|&block| sizes[block]).sum::<usize>();
    islands.iter().all(|island| unknowns(island) <= most).then_some(islands)
}

#[cfg(test)]
mod tests {
    use super::islands_up_to;

    #[test]
    fn blocks_that_meet_through_others_are_one_island() {
        // 0 meets 3, 1 meets 2, then 2 meets 3: all one. 4 stays alone.
        let pairs = [[3, 0], [1, 2], [2, 3]];
        assert_eq!(islands_up_to(48, &[1; 5], pairs.into_iter()), Some(vec![vec![0, 1, 2, 3], vec![4]]));
        assert_eq!(islands_up_to(48, &[6; 2], std::iter::empty()), Some(vec![vec![0], vec![1]]));
    }

    #[test]
    fn what_has_no_unknowns_ties_nothing() {
        assert_eq!(islands_up_to(48, &[6, 0, 12], [[0, 1], [1, 2]].into_iter()), Some(vec![vec![0], vec![2]]));
    }

    #[test]
    fn an_island_may_have_just_the_most_unknowns() {
        // 1 + 1 unknowns tied, and 2 alone.
        let islands = |most| islands_up_to(most, &[1, 2, 1], [[2, 0]].into_iter());
        assert_eq!(islands(2), Some(vec![vec![0, 2], vec![1]]));
        assert_eq!(islands(1), None);
    }
}
