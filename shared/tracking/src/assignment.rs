//! The cheapest assignment of rows to columns.

/// Buffers of [`assign`], reused from call to call.
#[derive(Debug, Default)]
pub struct AssignmentBuffers {
    row_price: Vec<f64>,
    column_price: Vec<f64>,
    row_of_column: Vec<usize>,
    distance: Vec<f64>,
    previous_column: Vec<usize>,
    is_reached: Vec<bool>,
    column_of_row: Vec<Option<usize>>,
}

const FREE: usize = usize::MAX;

/// Assigns rows to columns, each at most once, at least total cost, where a
/// row left without a column costs `unassigned_cost`. Returns each row's column.
///
/// `costs` is `n_rows x n_columns`, row-major; an entry that is not a number,
/// or not below `unassigned_cost`, is never chosen.
///
/// Shortest augmenting paths with prices (Jonker and Volgenant 1987), exact,
/// O(rows² · (rows + columns)): each row has a column of its own that stands
/// for none. Of equally cheap assignments the same one is always chosen.
pub fn assign<'a>(
    costs: &[f64],
    n_columns: usize,
    unassigned_cost: f64,
    buffers: &'a mut AssignmentBuffers,
) -> &'a [Option<usize>] {
    let n_rows = costs.len().checked_div(n_columns).unwrap_or(0);
    buffers.reset(n_rows, n_columns + n_rows);
    let cost = |row: usize, column: usize| {
        if column >= n_columns {
            return if column - n_columns == row {
                unassigned_cost
            } else {
                f64::INFINITY
            };
        }
        let cost = costs[row * n_columns + column];
        if cost < unassigned_cost {
            cost
        } else {
            f64::INFINITY
        }
    };
    for row in 0..n_rows {
        buffers.augment(row, &cost);
    }
    for column in 0..n_columns {
        let row = buffers.row_of_column[column];
        if row != FREE {
            buffers.column_of_row[row] = Some(column);
        }
    }
    &buffers.column_of_row
}

impl AssignmentBuffers {
    fn reset(&mut self, n_rows: usize, n_columns: usize) {
        fn refill<T: Clone>(values: &mut Vec<T>, n: usize, value: T) {
            values.clear();
            values.resize(n, value);
        }
        refill(&mut self.row_price, n_rows, 0.0);
        refill(&mut self.column_price, n_columns, 0.0);
        refill(&mut self.row_of_column, n_columns, FREE);
        refill(&mut self.distance, n_columns, f64::INFINITY);
        refill(&mut self.previous_column, n_columns, FREE);
        refill(&mut self.is_reached, n_columns, false);
        refill(&mut self.column_of_row, n_rows, None);
    }

    /// Gives a row a column, moving others along the cheapest path.
    fn augment(&mut self, start: usize, cost: &impl Fn(usize, usize) -> f64) {
        self.distance.fill(f64::INFINITY);
        self.previous_column.fill(FREE);
        self.is_reached.fill(false);
        let (mut row, mut from, mut travelled) = (start, FREE, 0.0);
        let end = loop {
            self.relax(row, from, travelled, cost);
            // The row's own column for none keeps a finite way open.
            let Some(next) = self.nearest_unreached() else {
                return;
            };
            travelled = self.distance[next];
            self.is_reached[next] = true;
            if self.row_of_column[next] == FREE {
                break next;
            }
            (row, from) = (self.row_of_column[next], next);
        };
        self.raise_prices(start, travelled);
        self.turn_path(start, end);
    }

    fn relax(
        &mut self,
        row: usize,
        from: usize,
        travelled: f64,
        cost: &impl Fn(usize, usize) -> f64,
    ) {
        for column in 0..self.distance.len() {
            if !self.is_reached[column] {
                let reduced = cost(row, column) - self.row_price[row] - self.column_price[column];
                let distance = travelled + reduced;
                if distance < self.distance[column] {
                    self.distance[column] = distance;
                    self.previous_column[column] = from;
                }
            }
        }
    }

    fn nearest_unreached(&self) -> Option<usize> {
        (0..self.distance.len())
            .filter(|&column| !self.is_reached[column] && self.distance[column].is_finite())
            .min_by(|&a, &b| self.distance[a].total_cmp(&self.distance[b]))
    }

    fn raise_prices(&mut self, start: usize, travelled: f64) {
        self.row_price[start] += travelled;
        for column in 0..self.distance.len() {
            if self.is_reached[column] {
                let gain = travelled - self.distance[column];
                self.column_price[column] -= gain;
                let row = self.row_of_column[column];
                if row != FREE {
                    self.row_price[row] += gain;
                }
            }
        }
    }

    fn turn_path(&mut self, start: usize, end: usize) {
        let mut column = end;
        loop {
            let previous = self.previous_column[column];
            if previous == FREE {
                self.row_of_column[column] = start;
                break;
            }
            self.row_of_column[column] = self.row_of_column[previous];
            column = previous;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Cost of the best assignment of the rows from `row` on, by trying all.
    fn best_by_trying(
        costs: &[f64],
        n_columns: usize,
        unassigned: f64,
        row: usize,
        used: u32,
    ) -> f64 {
        if row * n_columns >= costs.len() {
            return 0.0;
        }
        let rest = |used| best_by_trying(costs, n_columns, unassigned, row + 1, used);
        let mut best = unassigned + rest(used);
        for column in (0..n_columns).filter(|column| used & (1 << column) == 0) {
            let cost = costs[row * n_columns + column];
            if cost < unassigned {
                best = best.min(cost + rest(used | 1 << column));
            }
        }
        best
    }

    fn total(costs: &[f64], n_columns: usize, unassigned: f64, columns: &[Option<usize>]) -> f64 {
        let cost = |(row, column): (usize, &Option<usize>)| {
            column.map_or(unassigned, |column| costs[row * n_columns + column])
        };
        columns.iter().enumerate().map(cost).sum()
    }

    fn matrix() -> impl Strategy<Value = (Vec<f64>, usize)> {
        let entry = prop_oneof![8 => 0.0..12.0_f64, 1 => Just(f64::INFINITY), 1 => Just(f64::NAN), 1 => Just(3.0)];
        (1..=6_usize, 1..=6_usize).prop_flat_map(move |(rows, columns)| {
            (
                prop::collection::vec(entry.clone(), rows * columns),
                Just(columns),
            )
        })
    }

    proptest! {
        #[test]
        fn no_assignment_is_cheaper((costs, n_columns) in matrix(), unassigned in 1.0..15.0_f64) {
            let mut buffers = AssignmentBuffers::default();
            let columns = assign(&costs, n_columns, unassigned, &mut buffers);
            let mut used: Vec<usize> = columns.iter().flatten().copied().collect();
            let n_used = used.len();
            used.sort_unstable();
            used.dedup();
            prop_assert_eq!(used.len(), n_used);
            let best = best_by_trying(&costs, n_columns, unassigned, 0, 0);
            let found = total(&costs, n_columns, unassigned, columns);
            prop_assert!((found - best).abs() < 1e-9, "{} instead of {}", found, best);
        }
    }

    #[test]
    fn nothing_is_assigned_to_nothing() {
        let mut buffers = AssignmentBuffers::default();
        assert!(assign(&[], 0, 1.0, &mut buffers).is_empty());
        assert!(assign(&[], 3, 1.0, &mut buffers).is_empty());
        assert_eq!(assign(&[f64::NAN, 2.0], 2, 1.0, &mut buffers), [None]);
    }
}
