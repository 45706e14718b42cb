//! Which views of a category can be spared.
//!
//! Of the two views that are most alike one tells nearly nothing that the other
//! does not, and the newer one shows the object as it looks now. So the older of
//! the two goes, and so on: duplicates go first, and a view that is like no other
//! stays longest.

use crate::{Error, Metric};

const METRIC: Metric = Metric::Euclidean;

/// What of a category's views can be spared: the places in `descriptors` of the
/// `n_to_drop` that tell least, in the order in which they go; all places when there
/// are not as many.
///
/// `descriptors` are those of one category, the oldest first. Each time, of the two
/// that are left and have the least Euclidean distance, the older one goes; of
/// several such pairs the one whose older descriptor is oldest. The newest goes only
/// when all do.
///
/// *Complexity*: all pairs are compared once; when a descriptor goes, those whose
/// nearest it was are compared once more with what is left.
///
/// # Errors
/// When the descriptors differ in length, or a value is not finite or beyond 1e6.
pub fn least_telling(
    descriptors: &[impl AsRef<[f32]>],
    n_to_drop: usize,
) -> Result<Vec<usize>, Error> {
    let dimension = descriptors.first().map_or(0, |first| first.as_ref().len());
    for descriptor in descriptors {
        METRIC.check(descriptor.as_ref(), dimension)?;
    }
    if n_to_drop == 0 {
        return Ok(Vec::new());
    }
    let mut left = Left::new(descriptors);
    Ok((0..n_to_drop).map_while(|_| left.drop_one()).collect())
}

/// The descriptor nearest to one among those that are newer.
#[derive(Debug, Clone, Copy)]
struct Nearest {
    /// Orders as the distance does; infinite for the newest that is left.
    score: f32,
    place: Option<usize>,
}

/// The descriptors that are left.
struct Left<'a, D> {
    descriptors: &'a [D],
    /// `None` where the descriptor has gone. Each pair is known to its older
    /// descriptor only, the one that would go.
    nearest: Vec<Option<Nearest>>,
}

impl<'a, D: AsRef<[f32]>> Left<'a, D> {
    fn new(descriptors: &'a [D]) -> Self {
        let unknown = Nearest {
            score: f32::INFINITY,
            place: None,
        };
        let mut left = Self {
            descriptors,
            nearest: vec![Some(unknown); descriptors.len()],
        };
        for place in 0..descriptors.len() {
            left.nearest[place] = Some(left.nearest_newer(place));
        }
        left
    }

    /// The older one of the two nearest goes; `None` when nothing is left.
    fn drop_one(&mut self) -> Option<usize> {
        let left = (0..).zip(&self.nearest);
        let scores = left.filter_map(|(place, nearest)| Some((place, nearest.as_ref()?.score)));
        // The first of equal ones.
        let (dropped, _) = scores.min_by(|a, b| a.1.total_cmp(&b.1))?;
        self.nearest[dropped] = None;
        for place in 0..dropped {
            if self.nearest[place].is_some_and(|nearest| nearest.place == Some(dropped)) {
                self.nearest[place] = Some(self.nearest_newer(place));
            }
        }
        Some(dropped)
    }

    fn nearest_newer(&self, place: usize) -> Nearest {
        let of = self.descriptors[place].as_ref();
        let mut nearest = Nearest {
            score: f32::INFINITY,
            place: None,
        };
        for newer in place + 1..self.descriptors.len() {
            if self.nearest[newer].is_none() {
                continue;
            }
            let other = self.descriptors[newer].as_ref();
            let score = METRIC.bounded_score(of, other, nearest.score);
            if let Some(score) = score.filter(|score| *score < nearest.score) {
                nearest = Nearest {
                    score,
                    place: Some(newer),
                };
            }
        }
        nearest
    }
}

#[cfg(test)]
mod tests;
