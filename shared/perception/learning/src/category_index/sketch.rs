//! Sketches: lower bounds of Euclidean distances from a few values of each view.
//!
//! Let x₁ and y₁ be the leading values of a query and a view, and x₂ and y₂ the rest. By
//! the Cauchy-Schwarz inequality, `|x - y|² >= |x|² + |y|² - 2 (x₁ · y₁ + |x₂| |y₂|)`.
//! The sketch of a view is y₁, |y₂| and |y|², on two levels: coarse with few leading
//! values, fine with more.

/// Number of views of a block.
pub(super) const BLOCK_LEN: usize = 64;

/// Number of leading descriptor values in the coarse level.
const N_COARSE_VALUES: usize = 16;

/// Number of leading descriptor values in the fine level.
const N_FINE_VALUES: usize = 64;

/// Values of a sketch: the leading ones, then for each level the norm of the rest.
const N_VALUES: usize = N_FINE_VALUES + 2;

/// Largest number of terms of a level's inner product: the leading values and the norm
/// of the rest.
const N_TERMS_MAX: usize = N_FINE_VALUES + 1;

/// Views compared at once; eight vector registers of the baseline instruction set.
const LANES: usize = 32;
type Lanes = [f32; LANES];

/// Number of queries compared at once.
pub(super) const N_QUERIES_MAX: usize = 4;

/// Lower bounds of the squared distances of all views of a block, for each query.
pub(super) type DistanceBounds = [[f32; BLOCK_LEN]; N_QUERIES_MAX];

/// Hadamard matrix of order 4; its rows combine the queries.
const HADAMARD: [[f32; N_QUERIES_MAX]; N_QUERIES_MAX] = [
    [1.0, 1.0, 1.0, 1.0],
    [1.0, 1.0, -1.0, -1.0],
    [1.0, -1.0, 1.0, -1.0],
    [1.0, -1.0, -1.0, 1.0],
];

/// Sketches of a block of views, column by column.
#[derive(Debug, Clone)]
pub(super) struct SketchBlock {
    values: Vec<[Lanes; BLOCK_LEN / LANES]>,
    /// Squared norms; infinite for unused slots, so that nothing is near.
    squared_lengths: [Lanes; BLOCK_LEN / LANES],
}

/// Non-zero value of a combination of queries.
#[derive(Debug, Clone, Copy, Default)]
struct Term {
    value: usize,
    weight: f32,
}

/// Sketches of up to four queries for comparison with those of views.
///
/// Instead of the queries, their four combinations by the Hadamard matrix are multiplied
/// with a view; the inner products of the queries follow by additions. A value that is
/// equal in all queries, or differs in sign only, appears in one combination and costs
/// one multiplication instead of four.
#[derive(Debug, Clone)]
pub(super) struct QuerySketch {
    terms: [[Term; N_TERMS_MAX]; N_QUERIES_MAX],
    n_terms: [usize; N_QUERIES_MAX],
    /// Scale factor of a view's squared norm.
    scale: f32,
    /// Constant part of the bound of each query.
    offsets: [f32; N_QUERIES_MAX],
}

impl SketchBlock {
    pub(super) fn new() -> Self {
        Self {
            values: vec![[[0.0; LANES]; BLOCK_LEN / LANES]; N_VALUES],
            squared_lengths: [[f32::INFINITY; LANES]; BLOCK_LEN / LANES],
        }
    }

    /// Replaces the sketch of a view.
    pub(super) fn set(&mut self, place: usize, descriptor: &[f32]) {
        let (values, squared_length) = sketch(descriptor);
        for (column, value) in self.values.iter_mut().zip(values) {
            column[place / LANES][place % LANES] = value;
        }
        self.squared_lengths[place / LANES][place % LANES] = squared_length;
    }

    /// Removes the sketch of a view.
    pub(super) fn clear(&mut self, place: usize) {
        self.squared_lengths[place / LANES][place % LANES] = f32::INFINITY;
    }
}

/// Level of detail of a sketch: coarse or fine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SketchLevel {
    Coarse,
    Fine,
}

impl QuerySketch {
    /// Sketches of one to four queries of equal length; further queries are ignored.
    pub(super) fn new(queries: &[&[f32]], level: SketchLevel) -> Self {
        let dimension = queries.first().map_or(0, |query| query.len());
        // Fewer queries are repeated, which changes no bound.
        let n_queries = queries.len().max(1);
        let sketches: [_; N_QUERIES_MAX] =
            std::array::from_fn(|i| sketch(queries.get(i % n_queries).unwrap_or(&&[][..])));
        let margin = RoundingMargin::new(dimension);
        let longest = sketches.iter().map(|s| s.1).fold(0.0, f32::max);
        let error = 4.0 * margin.per_length * longest;
        let offset = |length: f32| margin.factor * (length - error) - margin.absolute;
        let mut query = Self {
            terms: [[Term::default(); N_TERMS_MAX]; N_QUERIES_MAX],
            n_terms: [0; N_QUERIES_MAX],
            scale: margin.factor * (1.0 - margin.per_length),
            offsets: sketches.map(|(_, length)| offset(length)),
        };
        let (n_leading, rest) = match level {
            SketchLevel::Coarse => (N_COARSE_VALUES, N_FINE_VALUES),
            SketchLevel::Fine => (N_FINE_VALUES, N_FINE_VALUES + 1),
        };
        for value in (0..n_leading).chain([rest]) {
            let of_readings = sketches.map(|(values, _)| values[value]);
            query.add(value, of_readings, -2.0 * margin.factor);
        }
        query
    }

    /// Adds one value of the four queries to the combinations.
    fn add(&mut self, value: usize, of_readings: [f32; N_QUERIES_MAX], factor: f32) {
        for (combination, signs) in HADAMARD.iter().enumerate() {
            let products = std::array::from_fn(|i| signs[i] * of_readings[i]);
            let [a, b, c, d]: [f32; N_QUERIES_MAX] = products;
            let weight = 0.25 * factor * ((a + b) + (c + d));
            if weight != 0.0 {
                let place = &mut self.n_terms[combination];
                self.terms[combination][*place] = Term { value, weight };
                *place += 1;
            }
        }
    }

    /// Computes lower bounds of the squared distances, as the metric computes them,
    /// between the queries and all views of a block; infinite for unused slots. Returns
    /// the least bound.
    pub(super) fn bound(&self, block: &SketchBlock, bounds: &mut DistanceBounds) -> f32 {
        let mut least = [f32::INFINITY; LANES];
        for (part, lengths) in block.squared_lengths.iter().enumerate() {
            let [a, b, c, d] = std::array::from_fn(|i| self.combination(i, block, part));
            for lane in 0..LANES {
                let length = self.scale * lengths[lane];
                let (sum, difference) = (a[lane] + b[lane], a[lane] - b[lane]);
                let (other_sum, other_difference) = (c[lane] + d[lane], c[lane] - d[lane]);
                let products = [
                    sum + other_sum,
                    sum - other_sum,
                    difference + other_difference,
                    difference - other_difference,
                ];
                for i in 0..N_QUERIES_MAX {
                    let bound = (length + self.offsets[i]) + products[i];
                    bounds[i][part * LANES + lane] = bound;
                    least[lane] = if bound < least[lane] {
                        bound
                    } else {
                        least[lane]
                    };
                }
            }
        }
        least.into_iter().fold(f32::INFINITY, f32::min)
    }

    /// Inner products of a combination of queries with the views of a part.
    #[inline]
    fn combination(&self, combination: usize, block: &SketchBlock, part: usize) -> Lanes {
        let mut sums = [0.0; LANES];
        for term in &self.terms[combination][..self.n_terms[combination]] {
            let column = &block.values[term.value][part];
            for lane in 0..LANES {
                sums[lane] += term.weight * column[lane];
            }
        }
        sums
    }
}

/// Margin for rounding errors by which a computed bound may exceed a computed distance.
struct RoundingMargin {
    /// Error of a bound relative to the sum of a view's squared norm and four times the
    /// largest one of the queries.
    per_length: f32,
    /// Factor for the downward rounding of a distance.
    factor: f32,
    /// Absolute error from underflowing squares.
    absolute: f32,
}

impl RoundingMargin {
    /// Error analysis with the unit roundoff u = eps / 2 (Higham, "Accuracy and
    /// stability of numerical algorithms", 2002, chapter 3). Let A be the largest
    /// magnitude of a value among the queries. A value of a combination has an error of
    /// 4 u A, and the values of the four add up to at most 2 A, so that an inner product
    /// of M values and the following additions have an error of `(2 M + 24) u Σ A |y|`.
    /// The bound has twice that error and less than 8 u of each squared norm. The
    /// distance, a sum of D squares in 16 lanes, has a relative error of `(D / 16 + 8)
    /// u`. Both errors are doubled for safety.
    fn new(dimension: usize) -> Self {
        Self {
            per_length: (2 * N_TERMS_MAX + 32) as f32 * f32::EPSILON,
            factor: 1.0 - (dimension as f32 / 16.0 + 8.0) * f32::EPSILON,
            absolute: (dimension + N_TERMS_MAX) as f32 * f32::MIN_POSITIVE,
        }
    }
}

/// Values of a sketch, zero-padded for short descriptors, and the squared norm of the
/// descriptor.
fn sketch(descriptor: &[f32]) -> ([f32; N_VALUES], f32) {
    let (leading, rest) = descriptor.split_at(descriptor.len().min(N_FINE_VALUES));
    let (coarse, fine) = leading.split_at(leading.len().min(N_COARSE_VALUES));
    let mut values = [0.0; N_VALUES];
    values[..leading.len()].copy_from_slice(leading);
    let of_rest = squared_length(rest);
    let of_coarse_rest = squared_length(fine) + of_rest;
    values[N_FINE_VALUES] = of_coarse_rest.sqrt() as f32;
    values[N_FINE_VALUES + 1] = of_rest.sqrt() as f32;
    (values, (squared_length(coarse) + of_coarse_rest) as f32)
}

/// Squared norm in double precision, so that only the conversion rounds.
fn squared_length(values: &[f32]) -> f64 {
    values.iter().map(|&v| f64::from(v) * f64::from(v)).sum()
}
