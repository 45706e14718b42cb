//! Linear assignment problem with a cost for unassigned rows.

use pathfinding::kuhn_munkres::kuhn_munkres_min;
use pathfinding::matrix::Matrix;
use union_find::{find_root, union};

/// Fixed-point scale of costs; the solver requires integers.
const COST_SCALE: f64 = 1e6;

/// Cost of a forbidden pair: larger than any sum of allowed costs, far from overflow.
const FORBIDDEN: i64 = 1 << 40;

/// Largest cost, so that sums stay below [`FORBIDDEN`].
const COST_MAX: f64 = 1e3;

/// Scratch buffers of [`assign`], reused from call to call.
#[derive(Debug, Default)]
pub struct AssignmentBuffers {
    column_of_row: Vec<Option<usize>>,
    row_of_column: Vec<usize>,
    groups: ConflictGroups,
    rows: Vec<usize>,
    columns: Vec<usize>,
}

/// Minimum-cost assignment: returns the column of each row. Each row and column is used
/// at most once, and a row without a column costs `unassigned_cost` (below 1000).
///
/// `costs` is `n_rows x n_columns`, row-major; an entry that is NaN or not below
/// `unassigned_cost` is forbidden. Costs are compared to a millionth; ties are broken
/// deterministically.
///
/// Rows and columns are split into connected components of allowed pairs. A component in
/// which every row prefers a different column is solved directly. Only competing rows
/// are solved by the Hungarian method (Kuhn 1955, Munkres 1957) of the library, which
/// allocates; on a table these are a few rows in rare frames.
pub fn assign<'a>(
    costs: &[f64],
    n_columns: usize,
    unassigned_cost: f64,
    buffers: &'a mut AssignmentBuffers,
) -> &'a [Option<usize>] {
    let n_rows = costs.len().checked_div(n_columns).unwrap_or(0);
    let pairs = AllowedPairs {
        costs,
        n_columns,
        unassigned_cost: unassigned_cost.min(COST_MAX),
    };
    buffers.column_of_row.clear();
    buffers.column_of_row.resize(n_rows, None);
    buffers.groups.refill(&pairs, n_rows);
    buffers.assign_cheapest(&pairs);
    for root in 0..n_rows {
        if buffers.groups.has_conflict[root] {
            buffers.solve_group(root, &pairs);
        }
    }
    &buffers.column_of_row
}

/// Sparse view of the cost matrix: the allowed pairs.
struct AllowedPairs<'a> {
    costs: &'a [f64],
    n_columns: usize,
    unassigned_cost: f64,
}

impl AllowedPairs<'_> {
    /// Cost of an allowed pair; `None` for NaN and forbidden entries.
    fn cost(&self, row: usize, column: usize) -> Option<f64> {
        let cost = self.costs[row * self.n_columns + column];
        (cost < self.unassigned_cost).then_some(cost.max(-COST_MAX))
    }

    fn cheapest_column(&self, row: usize) -> Option<usize> {
        (0..self.n_columns)
            .filter_map(|column| Some((column, self.cost(row, column)?)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(column, _)| column)
    }
}

const UNASSIGNED: usize = usize::MAX;

impl AssignmentBuffers {
    /// Assigns each row its cheapest column; a column chosen twice marks the component
    /// of its rows as conflicting.
    fn assign_cheapest(&mut self, pairs: &AllowedPairs<'_>) {
        self.row_of_column.clear();
        self.row_of_column.resize(pairs.n_columns, UNASSIGNED);
        for row in 0..self.column_of_row.len() {
            let Some(column) = pairs.cheapest_column(row) else {
                continue;
            };
            self.column_of_row[row] = Some(column);
            if std::mem::replace(&mut self.row_of_column[column], row) != UNASSIGNED {
                let root = self.groups.root(row);
                self.groups.has_conflict[root] = true;
            }
        }
    }

    /// Solves one conflicting component by the Hungarian method.
    fn solve_group(&mut self, root: usize, pairs: &AllowedPairs<'_>) {
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
        // Each row has an additional dummy column that stands for "unassigned".
        let (n_rows, n_columns) = (rows.len(), columns.len());
        let weight = |(row, column): (usize, usize)| {
            let cost = match columns.get(column) {
                Some(column) => pairs.cost(rows[row], *column),
                None => (column - n_columns == row).then_some(pairs.unassigned_cost),
            };
            cost.map_or(FORBIDDEN, |cost| (cost * COST_SCALE).round() as i64)
        };
        let weights = Matrix::from_fn(n_rows, n_columns + n_rows, weight);
        let (_, chosen) = kuhn_munkres_min(&weights);
        for (row, column) in rows.iter().zip(chosen) {
            column_of_row[*row] = columns.get(column).copied();
        }
    }
}

/// Union-find over rows that share an allowed column.
#[derive(Debug, Default)]
struct ConflictGroups {
    parents: Vec<u32>,
    /// Per row: `true` for the root of a group with a conflict.
    has_conflict: Vec<bool>,
}

impl ConflictGroups {
    fn refill(&mut self, pairs: &AllowedPairs<'_>, n_rows: usize) {
        self.parents.clear();
        self.parents.extend(0..n_rows as u32);
        self.has_conflict.clear();
        self.has_conflict.resize(n_rows, false);
        for column in 0..pairs.n_columns {
            let mut first = None;
            for row in (0..n_rows).filter(|row| pairs.cost(*row, column).is_some()) {
                union(
                    &mut self.parents,
                    *first.get_or_insert(row as u32),
                    row as u32,
                );
            }
        }
    }

    fn root(&mut self, row: usize) -> usize {
        find_root(&mut self.parents, row as u32) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Exhaustive minimum of the assignment cost of the rows from `row` on.
    fn exhaustive_minimum(
        costs: &[f64],
        n_columns: usize,
        unassigned: f64,
        row: usize,
        used: u32,
    ) -> f64 {
        if row * n_columns >= costs.len() {
            return 0.0;
        }
        let rest = |used| exhaustive_minimum(costs, n_columns, unassigned, row + 1, used);
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
        fn assignment_has_the_minimum_cost((costs, n_columns) in matrix(), unassigned in 1.0..15.0_f64) {
            let mut buffers = AssignmentBuffers::default();
            let columns = assign(&costs, n_columns, unassigned, &mut buffers);
            let mut used: Vec<usize> = columns.iter().flatten().copied().collect();
            let n_used = used.len();
            used.sort_unstable();
            used.dedup();
            prop_assert_eq!(used.len(), n_used);
            let best = exhaustive_minimum(&costs, n_columns, unassigned, 0, 0);
            let found = total(&costs, n_columns, unassigned, columns);
            prop_assert!((found - best).abs() < 2e-5, "{} instead of {}", found, best);
        }
    }

    #[test]
    fn assignment_of_an_empty_matrix_is_empty() {
        let mut buffers = AssignmentBuffers::default();
        assert!(assign(&[], 0, 1.0, &mut buffers).is_empty());
        assert!(assign(&[], 3, 1.0, &mut buffers).is_empty());
        assert_eq!(assign(&[f64::NAN, 2.0], 2, 1.0, &mut buffers), [None]);
    }
}
