//! Lower bounds of Euclidean distances from a few values of each view.
//!
//! With x₁ and y₁ the leading values of a reading and a view, and x₂ and y₂ the
//! rest, `|x - y|² >= |x|² + |y|² - 2 (x₁ · y₁ + |x₂| |y₂|)` by Cauchy's and
//! Schwarz's inequality. So a view's sketch is y₁, |y₂| and |y|². It has two levels:
//! a coarse one with few leading values, and a fine one with more.

use super::view_table::BLOCK;

/// Leading values of the coarse and of the fine level.
const N_COARSE: usize = 16;
const N_FINE: usize = 64;
/// Values of a sketch: the leading ones, then for each level the length of the rest.
const N_VALUES: usize = N_FINE + 2;
/// Most values of a level's product: the leading ones and the length of the rest.
const N_PRODUCT: usize = N_FINE + 1;

/// Views that are compared at once; eight vector registers of the baseline.
const LANES: usize = 32;
type Lanes = [f32; LANES];

/// Readings of an object that are compared at once.
pub(super) const N_TOGETHER: usize = 4;

/// Lower bounds of the squared distances of all views of a block, for each reading.
pub(super) type Bounds = [[f32; BLOCK]; N_TOGETHER];

/// Signs of the readings in Hadamard's matrix of order 4.
const HADAMARD: [[f32; N_TOGETHER]; N_TOGETHER] = [
    [1.0, 1.0, 1.0, 1.0],
    [1.0, 1.0, -1.0, -1.0],
    [1.0, -1.0, 1.0, -1.0],
    [1.0, -1.0, -1.0, 1.0],
];

/// The sketches of a block of views, value by value.
#[derive(Debug, Clone)]
pub(super) struct SketchBlock {
    values: Vec<[Lanes; BLOCK / LANES]>,
    /// Infinite where no view is, so that nothing is near.
    squared_lengths: [Lanes; BLOCK / LANES],
}

/// One value of a combination of readings that is not 0.
#[derive(Debug, Clone, Copy, Default)]
struct Term {
    value: usize,
    weight: f32,
}

/// Up to four readings of an object, ready to be compared with sketches.
///
/// Not the readings are multiplied with a view but their four combinations by
/// Hadamard's matrix, from which the readings' products follow by additions. What
/// is the same in all readings, or changes signs only, is in one combination and
/// costs one multiplication instead of four.
#[derive(Debug, Clone)]
pub(super) struct QuerySketch {
    terms: [[Term; N_PRODUCT]; N_TOGETHER],
    n_terms: [usize; N_TOGETHER],
    /// Factor of a view's squared length.
    scale: f32,
    /// Constant part of each reading's bound.
    offsets: [f32; N_TOGETHER],
}

impl SketchBlock {
    pub(super) fn new() -> Self {
        Self {
            values: vec![[[0.0; LANES]; BLOCK / LANES]; N_VALUES],
            squared_lengths: [[f32::INFINITY; LANES]; BLOCK / LANES],
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

    /// Forgets the sketch of a view.
    pub(super) fn clear(&mut self, place: usize) {
        self.squared_lengths[place / LANES][place % LANES] = f32::INFINITY;
    }
}

/// How much of the sketches is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Level {
    Coarse,
    Fine,
}

impl QuerySketch {
    /// Sketches of one to four readings of equal length; further ones are left out.
    pub(super) fn new(readings: &[&[f32]], level: Level) -> Self {
        let dimension = readings.first().map_or(0, |reading| reading.len());
        // Fewer readings are repeated; that changes no bound.
        let n_readings = readings.len().max(1);
        let sketches: [_; N_TOGETHER] =
            std::array::from_fn(|i| sketch(readings.get(i % n_readings).unwrap_or(&&[][..])));
        let slack = Slack::new(dimension);
        let longest = sketches.iter().map(|s| s.1).fold(0.0, f32::max);
        let error = 4.0 * slack.per_length * longest;
        let offset = |length: f32| slack.factor * (length - error) - slack.absolute;
        let mut query = Self {
            terms: [[Term::default(); N_PRODUCT]; N_TOGETHER],
            n_terms: [0; N_TOGETHER],
            scale: slack.factor * (1.0 - slack.per_length),
            offsets: sketches.map(|(_, length)| offset(length)),
        };
        let (n_leading, rest) = match level {
            Level::Coarse => (N_COARSE, N_FINE),
            Level::Fine => (N_FINE, N_FINE + 1),
        };
        for value in (0..n_leading).chain([rest]) {
            let of_readings = sketches.map(|(values, _)| values[value]);
            query.add(value, of_readings, -2.0 * slack.factor);
        }
        query
    }

    /// Adds a value of the four readings to the combinations.
    fn add(&mut self, value: usize, of_readings: [f32; N_TOGETHER], factor: f32) {
        for (combination, signs) in HADAMARD.iter().enumerate() {
            let products = std::array::from_fn(|i| signs[i] * of_readings[i]);
            let [a, b, c, d]: [f32; N_TOGETHER] = products;
            let weight = 0.25 * factor * ((a + b) + (c + d));
            if weight != 0.0 {
                let place = &mut self.n_terms[combination];
                self.terms[combination][*place] = Term { value, weight };
                *place += 1;
            }
        }
    }

    /// Lower bounds of the squared distances, as the metric computes them, between
    /// the readings and all views of a block; infinite where no view is. Returns the
    /// least.
    pub(super) fn bound(&self, block: &SketchBlock, bounds: &mut Bounds) -> f32 {
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
                for i in 0..N_TOGETHER {
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

    /// The products of a combination of readings with the views of a part.
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

/// How far rounding can bring a computed bound above a computed distance.
struct Slack {
    /// Error of a bound, of the sum of a view's squared length and four times the
    /// largest of the readings'.
    per_length: f32,
    /// What remains of a bound when the distance is rounded downwards.
    factor: f32,
    /// What is lost of squares too small for normal numbers.
    absolute: f32,
}

impl Slack {
    /// With the unit roundoff u = eps / 2 (Higham, "Accuracy and stability of
    /// numerical algorithms", 2002, chapter 3): a combination's value is off by
    /// 4 u A, A the readings' largest such value, and the values of the four add up
    /// to 2 A at most, so that a product of M values and the additions after it are
    /// off by `(2 M + 24) u Σ A |y|`; the bound is off by twice that, and by less
    /// than 8 u of each length. The distance's sum of D squares in 16 lanes is off by
    /// `(D / 16 + 8) u` of itself. Both are taken twice.
    fn new(dimension: usize) -> Self {
        Self {
            per_length: (2 * N_PRODUCT + 32) as f32 * f32::EPSILON,
            factor: 1.0 - (dimension as f32 / 16.0 + 8.0) * f32::EPSILON,
            absolute: (dimension + N_PRODUCT) as f32 * f32::MIN_POSITIVE,
        }
    }
}

/// The values of a sketch, zeros where the descriptor is shorter; and the squared
/// length of the whole.
fn sketch(descriptor: &[f32]) -> ([f32; N_VALUES], f32) {
    let (leading, rest) = descriptor.split_at(descriptor.len().min(N_FINE));
    let (coarse, fine) = leading.split_at(leading.len().min(N_COARSE));
    let mut values = [0.0; N_VALUES];
    values[..leading.len()].copy_from_slice(leading);
    let of_rest = squared_length(rest);
    let of_coarse_rest = squared_length(fine) + of_rest;
    values[N_FINE] = of_coarse_rest.sqrt() as f32;
    values[N_FINE + 1] = of_rest.sqrt() as f32;
    (values, (squared_length(coarse) + of_coarse_rest) as f32)
}

/// In double precision, so that only the conversion rounds.
fn squared_length(values: &[f32]) -> f64 {
    values.iter().map(|&v| f64::from(v) * f64::from(v)).sum()
}
