//! Prior probability of novelty: the share of objects that are of no taught category, learned from
//! what people correct.
//!
//! Right answers leave no trace of novelty: nobody corrects them. A new object that was given a
//! name is corrected, and only about one new object in eight is given one, so such a correction
//! counts as eight new objects. A known object counts once, whether its answer was corrected or
//! stood while a person corrected something else.

/// Prior of novelty before anything is learned. Chosen: one object in four.
const INITIAL: f32 = 0.25;

/// Number of objects that the initial prior counts as. Chosen.
const N_INITIAL: f32 = 12.0;

/// Number of objects that count at most; earlier ones fade. Chosen: a person's afternoon.
const N_COUNTED_MAX: f32 = 60.0;

/// Number of new objects that a corrected one stands for: the inverse share of new objects that are
/// given a name (inverse propensity weighting, Horvitz and Thompson 1952).
const N_NEW_PER_FALSE_NAME: f32 = 8.0;

/// Least and greatest prior, so that neither answer is ever excluded.
const RANGE: (f32, f32) = (0.02, 0.6);

/// Feedback of a person about an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feedback {
    /// The object is of a category that was taught before.
    Known,
    /// The object was given a name, and is of no category that was taught before.
    FalseName,
}

/// Beta-Bernoulli estimate of the share of new objects, in which earlier feedback fades.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoveltyPrior {
    n_new: f32,
    n_known: f32,
}

impl Default for NoveltyPrior {
    fn default() -> Self {
        Self {
            n_new: N_INITIAL * INITIAL,
            n_known: N_INITIAL * (1.0 - INITIAL),
        }
    }
}

impl NoveltyPrior {
    /// Prior of counts of new and of known objects, as [`counts`](Self::counts) gives them; `None`
    /// for counts that no feedback gives.
    pub fn from_counts([n_new, n_known]: [f32; 2]) -> Option<Self> {
        let are_counts = [n_new, n_known].iter().all(|n| *n >= 0.0);
        let n = n_new + n_known;
        (are_counts && n > 0.0 && n <= N_COUNTED_MAX + 1.0).then_some(Self { n_new, n_known })
    }

    /// Counts of new and of known objects, with those of the initial prior.
    pub fn counts(&self) -> [f32; 2] {
        [self.n_new, self.n_known]
    }

    /// Learns from one object.
    pub fn learn(&mut self, feedback: Feedback) {
        let n = match feedback {
            Feedback::Known => 1.0,
            Feedback::FalseName => N_NEW_PER_FALSE_NAME,
        };
        let fading = ((N_COUNTED_MAX - n) / (self.n_new + self.n_known)).min(1.0);
        self.n_new *= fading;
        self.n_known *= fading;
        match feedback {
            Feedback::Known => self.n_known += n,
            Feedback::FalseName => self.n_new += n,
        }
    }

    /// Prior probability that an object is of no taught category.
    pub fn probability(&self) -> f32 {
        let share = self.n_new / (self.n_new + self.n_known);
        share.clamp(RANGE.0, RANGE.1)
    }
}

/// Growth of the odds of a new object in a memory with one category, of which most objects are
/// none; it falls with the number of categories. Chosen.
const FEW_CATEGORIES: f32 = 6.0;

/// Prior of novelty in a memory with some categories.
pub(crate) fn prior_with(novelty_prior: f32, n_categories: usize) -> f32 {
    let growth = 1.0 + FEW_CATEGORIES / n_categories.max(1) as f32;
    let grown = growth * odds(novelty_prior);
    grown / (1.0 + grown)
}

/// Odds of a probability; finite for 1.
fn odds(probability: f32) -> f32 {
    probability / (1.0 - probability).max(f32::MIN_POSITIVE)
}

/// Probability of a category under another prior of novelty than the initial one, given the
/// probability that the object is of any taught category under the initial one.
///
/// *Source*: another prior multiplies the odds by the ratio of the two priors' odds (Saerens,
/// Latinne and Decaestecker, "Adjusting the outputs of a classifier to new a priori
/// probabilities", Neural Computation 14, 2002).
pub fn under_prior(probability: f32, known_probability: f32, novelty_prior: f32) -> f32 {
    let unknown = (1.0 - known_probability) * odds(novelty_prior) / odds(INITIAL);
    probability / (known_probability + unknown).max(f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odds_of_the_prior_multiply_those_of_a_new_object() {
        assert_eq!(under_prior(0.3, 0.5, INITIAL), 0.3);
        // Odds of 1 to 1 that it is new become 3 to 1.
        let [best, known] = [0.3, 0.5].map(|probability| under_prior(probability, 0.5, 0.5));
        assert!((best - 0.15).abs() < 1e-6 && (known - 0.25).abs() < 1e-6);
        assert_eq!(under_prior(0.0, 0.0, 0.0), 0.0);
    }

    #[test]
    fn few_categories_make_new_objects_more_probable() {
        let prior = |n_categories| prior_with(0.25, n_categories);
        assert!((prior(1) - 0.7).abs() < 1e-6, "odds of 7 to 3");
        assert!(prior(3) > prior(20) && prior(1000) < 0.26);
    }

    #[test]
    fn begins_with_one_new_object_in_four() {
        assert_eq!(NoveltyPrior::default().probability(), 0.25);
    }

    #[test]
    fn counts_give_the_prior_again() {
        let mut prior = NoveltyPrior::default();
        for i in 0..100 {
            assert_eq!(NoveltyPrior::from_counts(prior.counts()), Some(prior));
            prior.learn(if i % 7 == 0 {
                Feedback::FalseName
            } else {
                Feedback::Known
            });
        }
        for wrong in [[f32::NAN, 1.0], [-1.0, 3.0], [0.0; 2], [1e9, 1.0]] {
            assert_eq!(NoveltyPrior::from_counts(wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn follows_what_is_corrected_and_forgets() {
        let mut prior = NoveltyPrior::default();
        for _ in 0..200 {
            prior.learn(Feedback::Known);
        }
        assert_eq!(prior.probability(), RANGE.0);
        for _ in 0..10 {
            prior.learn(Feedback::FalseName);
        }
        assert!(prior.probability() > 0.5, "{prior:?}");
    }

    #[test]
    fn false_names_stand_for_new_objects_that_were_not_named() {
        let mut prior = NoveltyPrior::default();
        for i in 0..300 {
            let is_false = i % 11 == 0;
            prior.learn(if is_false {
                Feedback::FalseName
            } else {
                Feedback::Known
            });
        }
        // Eight new objects for ten known ones.
        assert!((prior.probability() - 0.44).abs() < 0.06, "{prior:?}");
    }
}
