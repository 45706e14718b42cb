//! The cheapest assignment of rows to columns.

use pathfinding::kuhn_munkres::kuhn_munkres_min;
use pathfinding::matrix::Matrix;

/// Steps of a cost of one: the library wants whole numbers.
const STEPS: f64 = 1e6;

/// Dearer than any sum of allowed costs, and far from overflowing.
const FORBIDDEN: i64 = 1 << 40;

/// Greatest cost, so that sums stay below [`FORBIDDEN`].
const COST_MAX: f64 = 1e3;

/// Buffers of [`assign`], reused from call to call.
#[derive(Debug, Default)]
pub struct AssignmentBuffers {
    column_of_row: Vec<Option<usize>>,
    row_of_column: Vec<usize>,
    groups: Groups,
    rows: Vec<usize>,
    columns: Vec<usize>,
}

/// Assigns rows to columns, each at most once, at least total cost, where a
/// row left without a column costs `unassigned_cost` (below 1000). Returns each
/// row's column.
///
/// `costs` is `n_rows x n_columns`, row-major; an entry that is not a number,
/// or not below `unassigned_cost`, is never chosen. Costs are compared to a
/// millionth; of equally cheap assignments the same one is always chosen.
///
/// Rows and columns fall into groups that share no allowed pair. A group in
/// which every row's cheapest column is another one is decided by that; only
/// rows that compete go to the Hungarian method (Kuhn 1955, Munkres 1957) of the
/// library, which allocates: on a table that is a few rows now and then.
pub fn assign<'a>(
    costs: &[f64],
    n_columns: usize,
    unassigned_cost: f64,
    buffers: &'a mut AssignmentBuffers,
) -> &'a [Option<usize>] {
    let n_rows = costs.len().checked_div(n_columns).unwrap_or(0);
    let pairs = Pairs {
        costs,
        n_columns,
        unassigned_cost: unassigned_cost.min(COST_MAX),
    };
    buffers.column_of_row.clear();
    buffers.column_of_row.resize(n_rows, None);
    buffers.groups.refill(&pairs, n_rows);
    buffers.take_cheapest(&pairs);
    for root in 0..n_rows {
        if buffers.groups.root(root) == root && buffers.competes(root) {
            buffers.settle(root, &pairs);
        }
    }
    &buffers.column_of_row
}

/// The allowed pairs and their costs.
struct Pairs<'a> {
    costs: &'a [f64],
    n_columns: usize,
    unassigned_cost: f64,
}

impl Pairs<'_> {
    /// The cost of an allowed pair. Whatever is not a number is not allowed.
    fn cost(&self, row: usize, column: usize) -> Option<f64> {
        let cost = self.costs[row * self.n_columns + column];
        (cost < self.unassigned_cost).then_some(cost.max(-COST_MAX))
    }

    fn cheapest(&self, row: usize) -> Option<usize> {
        (0..self.n_columns)
            .filter_map(|column| Some((column, self.cost(row, column)?)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(column, _)| column)
    }
}

const NONE: usize = usize::MAX;

impl AssignmentBuffers {
    /// Gives each row its cheapest column; a column wanted twice marks its rows'
    /// group as one of competitors.
    fn take_cheapest(&mut self, pairs: &Pairs<'_>) {
        self.row_of_column.clear();
        self.row_of_column.resize(pairs.n_columns, NONE);
        for row in 0..self.column_of_row.len() {
            let Some(column) = pairs.cheapest(row) else {
                continue;
            };
            self.column_of_row[row] = Some(column);
            if std::mem::replace(&mut self.row_of_column[column], row) != NONE {
                let root = self.groups.root(row);
                self.groups.has_conflict[root] = true;
            }
        }
    }

    fn competes(&self, root: usize) -> bool {
        self.groups.has_conflict[root]
    }

    /// Decides among the rows of a group.
    fn settle(&mut self, root: usize, pairs: &Pairs<'_>) {
        let Self {
            rows,
            columns,
            groups,
            column_of_row,
            ..
        } = self;
        rows.clear();
        rows.extend((0..column_of_row.len()).filter(|row| groups.root(*row) == root));
        columns.clear();
        let is_wanted = |column: &usize| rows.iter().any(|row| pairs.cost(*row, *column).is_some());
        columns.extend((0..pairs.n_columns).filter(is_wanted));
        // Behind the columns each row has one of its own that stands for none.
        let (n_rows, n_columns) = (rows.len(), columns.len());
        let weight = |(row, column): (usize, usize)| {
            let cost = match columns.get(column) {
                Some(column) => pairs.cost(rows[row], *column),
                None => (column - n_columns == row).then_some(pairs.unassigned_cost),
            };
            cost.map_or(FORBIDDEN, |cost| (cost * STEPS).round() as i64)
        };
        let weights = Matrix::from_fn(n_rows, n_columns + n_rows, weight);
        let (_, chosen) = kuhn_munkres_min(&weights);
        for (row, column) in rows.iter().zip(chosen) {
            column_of_row[*row] = columns.get(column).copied();
        }
    }
}

/// Rows that share a column, directly or through others, by union-find.
#[derive(Debug, Default)]
struct Groups {
    parent: Vec<usize>,
    has_conflict: Vec<bool>,
}

impl Groups {
    fn refill(&mut self, pairs: &Pairs<'_>, n_rows: usize) {
        self.parent.clear();
        self.parent.extend(0..n_rows);
        self.has_conflict.clear();
        self.has_conflict.resize(n_rows, false);
        for column in 0..pairs.n_columns {
            let mut first = None;
            for row in (0..n_rows).filter(|row| pairs.cost(*row, column).is_some()) {
                match first {
                    None => first = Some(row),
                    Some(first) => self.join(first, row),
                }
            }
        }
    }

    fn root(&self, mut row: usize) -> usize {
        while self.parent[row] != row {
            row = self.parent[row];
        }
        row
    }

    /// The smaller number becomes the root, so that groups do not depend on order.
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
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
        let entry = prop_oneof![8 => 0.0..12.0_f64, 4 => Just(f64::INFINITY), 1 => Just(f64::NAN), 1 => Just(3.0)];
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
            prop_assert!((found - best).abs() < 2e-5, "{} instead of {}", found, best);
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
