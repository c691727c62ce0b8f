//! How each sign was decided.

use std::ops::AddAssign;

/// How many signs each level of the cascade decided, cheapest level first. Part of every report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LevelCounts {
    /// f64 with a bound known beforehand; or what follows from signs of edges and normals.
    pub float: u64,
    /// f64, or two f64, with a bound that follows the values.
    pub ball: u64,
    /// 128-bit integers.
    pub i128: u64,
    /// 256-, 512- and 1,024-bit integers on the stack.
    pub fixed: [u64; 3],
    /// Integers on the heap.
    pub heap: u64,
}

impl LevelCounts {
    /// The levels by name, in the order of the tables' columns, which is not quite that in which they are tried: balls come before i128.
    pub fn by_name(&self) -> [(&'static str, u64); 7] {
        [
            ("f64", self.float),
            ("i128", self.i128),
            ("ball", self.ball),
            ("i256", self.fixed[0]),
            ("i512", self.fixed[1]),
            ("i1024", self.fixed[2]),
            ("heap", self.heap),
        ]
    }

    /// All signs decided.
    pub fn total(&self) -> u64 {
        self.by_name().iter().map(|(_, count)| count).sum()
    }
}

impl AddAssign for LevelCounts {
    fn add_assign(&mut self, other: LevelCounts) {
        self.float += other.float;
        self.ball += other.ball;
        self.i128 += other.i128;
        for (mine, theirs) in self.fixed.iter_mut().zip(other.fixed) {
            *mine += theirs;
        }
        self.heap += other.heap;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_add_up_level_by_level() {
        let mut sum = LevelCounts { float: 1, ball: 2, i128: 3, fixed: [4, 5, 6], heap: 7 };
        assert_eq!(sum.total(), 28);
        let names = [("f64", 1), ("i128", 3), ("ball", 2), ("i256", 4), ("i512", 5), ("i1024", 6), ("heap", 7)];
        assert_eq!(sum.by_name(), names);
        sum += LevelCounts { float: 10, ball: 20, i128: 30, fixed: [40, 50, 60], heap: 70 };
        assert_eq!(sum, LevelCounts { float: 11, ball: 22, i128: 33, fixed: [44, 55, 66], heap: 77 });
    }
}
