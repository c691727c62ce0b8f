//! Values of pairs of features that random draws ask for again and again.

use std::cell::RefCell;

/// Values by two numbers, each worked out when first asked for.
#[derive(Debug)]
pub(crate) struct Remembered<T> {
    columns: usize,
    places: usize,
    values: RefCell<Vec<Option<T>>>,
}

/// The values kept at most; where there can be more, few are asked for twice, and each is worked out anew.
const MAX_VALUES: usize = 1 << 12;

impl<T: Clone> Remembered<T> {
    /// For numbers below `rows` and `columns`.
    pub(crate) fn new(rows: usize, columns: usize) -> Remembered<T> {
        Remembered { columns, places: rows.saturating_mul(columns), values: RefCell::default() }
    }

    /// The value of two numbers, by `make` unless it is known.
    pub(crate) fn get(&self, row: usize, column: usize, make: impl FnOnce() -> T) -> T {
        if self.places > MAX_VALUES {
            return make();
        }
        let place = row * self.columns + column;
        if let Some(Some(known)) = self.values.borrow().get(place) {
            return known.clone();
        }
        let made = make();
        let mut values = self.values.borrow_mut();
        if values.is_empty() {
            values.resize(self.places, None);
        }
        values[place] = Some(made.clone());
        made
    }
}

#[cfg(test)]
mod tests {
    use super::{MAX_VALUES, Remembered};
    use std::cell::Cell;

    #[test]
    fn each_value_is_its_own_and_made_once_unless_there_are_too_many() {
        for (rows, columns) in [(3, 5), (5, 3), (1, MAX_VALUES + 1)] {
            let (known, made) = (Remembered::new(rows, columns), Cell::new(0));
            for _ in 0..2 {
                for row in 0..rows {
                    for column in (0..columns).rev() {
                        let value = known.get(row, column, || {
                            made.set(made.get() + 1);
                            (row, column)
                        });
                        assert_eq!(value, (row, column));
                    }
                }
            }
            assert_eq!(made.get(), rows * columns * if rows * columns > MAX_VALUES { 2 } else { 1 });
        }
    }
}
