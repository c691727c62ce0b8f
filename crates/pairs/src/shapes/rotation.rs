//! Rational rotations: integer quaternions give integer matrices `M` with `M·Mᵀ = norm²·I` (Euler–Rodrigues; Cayley's
//! rational rotations are the same set). Divided by the norm that is a rotation; divided by a power of two it is
//! a rotation and a stretch that binary floating point holds exactly.

/// An integer matrix that turns, and stretches by `norm`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RationalRotation {
    /// `M`, with `M·Mᵀ = norm²·I` and a positive determinant.
    pub matrix: [[i64; 3]; 3],
    /// The factor by which `M` stretches.
    pub norm: i64,
}

impl RationalRotation {
    /// No turn.
    pub const NONE: RationalRotation = RationalRotation { matrix: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], norm: 1 };

    /// The turn of the quaternion `a + b·i + c·j + d·k`, which must not be zero.
    pub fn from_quaternion([a, b, c, d]: [i64; 4]) -> RationalRotation {
        RationalRotation {
            matrix: [
                [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
                [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
                [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
            ],
            norm: a * a + b * b + c * c + d * d,
        }
    }

    /// The smallest power of two that is at least the norm.
    pub fn binary_norm(&self) -> i64 {
        (self.norm as u64).next_power_of_two() as i64
    }
}

/// The 24 turns of a cube onto itself.
pub fn cube_turn(number: u32) -> [[i64; 3]; 3] {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]];
    let order = (number / 4 % 6) as usize;
    let signs = number % 4;
    let even = order < 3;
    let first = if signs & 1 == 0 { 1 } else { -1 };
    let second = if signs & 2 == 0 { 1 } else { -1 };
    let third = if even { first * second } else { -first * second };
    let mut matrix = [[0; 3]; 3];
    for (row, sign) in [first, second, third].into_iter().enumerate() {
        matrix[row][ORDERS[order][row]] = sign;
    }
    matrix
}

/// Vectors of whole components and whole length `(x, y, z, length)`: the exact distances of this project.
pub const WHOLE_LENGTHS: [[i64; 4]; 12] = [
    [1, 0, 0, 1],
    [3, 4, 0, 5],
    [1, 2, 2, 3],
    [2, 3, 6, 7],
    [1, 4, 8, 9],
    [4, 4, 7, 9],
    [2, 6, 9, 11],
    [6, 6, 7, 11],
    [5, 12, 0, 13],
    [3, 4, 12, 13],
    [2, 5, 14, 15],
    [8, 15, 0, 17],
];

#[cfg(test)]
mod tests {
    use super::*;

    fn determinant(m: &[[i64; 3]; 3]) -> i64 {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    }

    #[test]
    fn turns_keep_angles_and_orientation() {
        let mut turns = vec![RationalRotation::NONE];
        for q in [[1, 0, 0, 3], [2, -1, 3, 1], [0, 0, 1, 1], [-3, 2, 2, 1]] {
            turns.push(RationalRotation::from_quaternion(q));
        }
        turns.extend((0..24).map(|n| RationalRotation { matrix: cube_turn(n), norm: 1 }));
        for RationalRotation { matrix: m, norm } in turns {
            for i in 0..3 {
                for j in 0..3 {
                    let dot: i64 = (0..3).map(|k| m[i][k] * m[j][k]).sum();
                    assert_eq!(dot, if i == j { norm * norm } else { 0 });
                }
            }
            assert_eq!(determinant(&m), norm.pow(3));
        }
    }

    #[test]
    fn cube_turns_are_all_different() {
        let all: std::collections::BTreeSet<_> = (0..24).map(cube_turn).collect();
        assert_eq!(all.len(), 24);
    }

    #[test]
    fn lengths_are_whole() {
        for [x, y, z, length] in WHOLE_LENGTHS {
            assert_eq!(x * x + y * y + z * z, length * length);
        }
    }
}
