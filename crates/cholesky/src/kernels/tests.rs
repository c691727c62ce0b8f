use super::*;
use pulp::Scalar;

/// Asks how products are added.
struct Ask;

impl WithSimd for Ask {
    type Output = Addition;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Addition {
        Addition::of::<S>()
    }
}

/// By what the kernels are run: the widest vectors that the processor has, or none.
#[derive(Clone, Copy, Debug)]
enum By {
    Vectors,
    Scalars,
}

impl By {
    fn run<W: WithSimd>(self, work: W) -> W::Output {
        match self {
            By::Vectors => Arch::new().dispatch(work),
            By::Scalars => work.with_simd(Scalar),
        }
    }
}

fn added<R: Float>(by: By, sum: R, a: R, b: R) -> R {
    match by.run(Ask) {
        Addition::Fused => a.mul_add(b, sum),
        Addition::Separate => sum + a * b,
    }
}

/// Numbers between -1 and 1 that no sum leaves exact.
fn numbers<R: Float>(count: usize) -> Vec<R> {
    (1..=count).map(|k| R::from((k as f64).sin()).expect("a number")).collect()
}

/// A symmetric matrix, column by column, whose diagonal exceeds the sum of each row, and rows below it.
fn matrix<R: Float>(size: usize, below: usize) -> Vec<R> {
    let height = size + below;
    let mut values = numbers::<R>(size * height);
    for k in 0..size {
        values[k * (height + 1)] = R::from(height as f64 + 1.0).expect("a number");
    }
    values
}

/// Number by number: sums in groups of four columns, as the kernels take them.
fn plainly<R: Float>(by: By, values: &mut [R], size: usize, height: usize) {
    for column in 0..size {
        let group = if column / ACROSS < size / ACROSS { column / ACROSS * ACROSS } else { column };
        for row in column..height {
            let sum = (0..group)
                .fold(R::zero(), |sum, k| added(by, sum, values[k * height + row], values[k * height + column]));
            let value = values[column * height + row] - sum;
            let value =
                (group..column).fold(value, |value, k| value - values[k * height + row] * values[k * height + column]);
            values[column * height + row] =
                if row == column { value.sqrt() } else { value / values[column * height + column] };
        }
    }
}

/// By the kernels, with rows below cut in parts.
fn by_kernels<R: Float>(by: By, values: &mut [R], [size, height, part]: [usize; 3]) -> Result<(), usize> {
    let mut below: Vec<Vec<&mut [R]>> = (0..(height - size).div_ceil(part)).map(|_| Vec::new()).collect();
    let mut square = Vec::new();
    for column in values.chunks_exact_mut(height) {
        let (inner, outer) = column.split_at_mut(size);
        square.push(inner);
        below.iter_mut().zip(outer.chunks_mut(part)).for_each(|(rows, part)| rows.push(part));
    }
    by.run(Square(&mut square))?;
    let square: Vec<&[R]> = square.iter().map(|column| &**column).collect();
    below.iter_mut().for_each(|rows| by.run(Division { square: &square, rows }));
    Ok(())
}

fn factors_alike<R: Float + std::fmt::Debug>(by: By, accuracy: f64) {
    for size in (1..=14).chain([24, 31, 60]) {
        for below in [0, 1, 5, 23, 40] {
            let height = size + below;
            let given = matrix::<R>(size, below);
            let mut expected = given.clone();
            plainly(by, &mut expected, size, height);
            for part in [1, 7, 96] {
                let mut found = given.clone();
                by_kernels(by, &mut found, [size, height, part]).expect("a factor");
                for column in 0..size {
                    let rows = column * height + column..(column + 1) * height;
                    assert_eq!(found[rows.clone()], expected[rows], "{size} {below} {part}, column {column}");
                }
            }
            // The factor times its transpose is the matrix.
            let number =
                |values: &[R], row: usize, column: usize| values[column * height + row].to_f64().expect("a number");
            for column in 0..size {
                for row in column..height {
                    let product: f64 =
                        (0..=column).map(|k| number(&expected, row, k) * number(&expected, column, k)).sum();
                    let apart = (product - number(&given, row, column)).abs();
                    assert!(apart < accuracy * (height as f64 + 1.0), "{size} {below}: {row} {column} {apart}");
                }
            }
        }
    }
}

#[test]
fn a_factor_is_the_same_bits_however_its_rows_are_cut() {
    assert!(matches!(By::Scalars.run(Ask), Addition::Separate));
    for by in [By::Vectors, By::Scalars] {
        factors_alike::<f64>(by, 1e-14);
        factors_alike::<f32>(by, 1e-5);
    }
}

#[test]
fn products_of_rows_are_the_same_bits_however_they_are_cut() {
    for by in [By::Vectors, By::Scalars] {
        products_alike::<f64>(by);
        products_alike::<f32>(by);
    }
}

fn products_alike<R: Float + std::fmt::Debug>(by: By) {
    // One after another in the same memory: what an earlier one left there must not be read.
    let mut packed = Packed::default();
    for (depth, height) in [(50, 61), (1, 3), (12, 131), (5, 40)] {
        let values = numbers::<R>(depth * height);
        let columns = Columns { values: &values, height };
        for across in [0..1, 1..height.min(8), 0..height.min(49)] {
            packed.pack_across(columns, across.clone());
            for part in [1, 10, 96] {
                for begin in (0..height).step_by(part) {
                    let rows = begin..height.min(begin + part);
                    let mut into = vec![R::nan(); rows.len() * across.len()];
                    by.run(RowProducts {
                        columns,
                        rows: rows.clone(),
                        across: across.clone(),
                        into: &mut into,
                        packed: &mut packed,
                    });
                    let of = |row: usize, column: usize| {
                        columns.all().fold(R::zero(), |sum, values| added(by, sum, values[row], values[column]))
                    };
                    for (column, found) in across.clone().zip(into.chunks_exact(rows.len())) {
                        let expected: Vec<R> = rows.clone().map(|row| of(row, column)).collect();
                        assert_eq!(found, expected, "{depth} {height} {part}");
                    }
                }
            }
        }
    }
}

#[test]
fn the_first_pivot_that_is_not_positive_and_finite_is_told() {
    for size in [1, 4, 5, 13] {
        for failing in 0..size {
            for pivot in [-1.0, f64::NAN, f64::INFINITY] {
                let mut values = matrix::<f64>(size, 3);
                values[failing * (size + 4)] = pivot;
                assert_eq!(by_kernels(By::Vectors, &mut values, [size, size + 3, 96]), Err(failing), "{size} {pivot}");
            }
        }
    }
    // Two unknowns that are one: the second pivot is zero.
    assert_eq!(by_kernels(By::Vectors, &mut [4.0, 4.0, 4.0, 4.0], [2, 2, 1]), Err(1));
}
