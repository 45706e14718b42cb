//! Selection of categories withheld from training in a fold, for open-set questions.

use random::Random;

/// Random stream of the withheld categories.
const WITHHELD_STREAM: u64 = 6;

/// Open-set mask of a fold: `true` for each category withheld from its learner. `share` (0 to 1)
/// is rounded to the nearest number of categories, but to at least one if it is not 0; at least
/// one category remains for training.
pub fn withheld_categories(n_categories: usize, share: f64, fold: u32, seed: u64) -> Vec<bool> {
    let n = (share * n_categories as f64).round() as usize;
    let n = n.max(usize::from(share > 0.0));
    let n = n.min(n_categories.saturating_sub(1));
    let mut is_withheld: Vec<bool> = (0..n_categories).map(|category| category < n).collect();
    Random::substream(seed, WITHHELD_STREAM | u64::from(fold) << 16).shuffle(&mut is_withheld);
    is_withheld
}

#[cfg(test)]
mod tests {
    use super::*;

    fn n_withheld(n_categories: usize, share: f64) -> usize {
        let withheld = withheld_categories(n_categories, share, 0, 1);
        assert_eq!(withheld.len(), n_categories);
        withheld
            .into_iter()
            .filter(|&is_withheld| is_withheld)
            .count()
    }

    #[test]
    fn share_is_met_and_one_category_remains() {
        for (n_categories, share, expected) in [
            (51, 0.0, 0),
            (51, 0.5, 26),
            (10, 0.01, 1),
            (10, 0.9, 9),
            (2, 0.9, 1),
            (1, 0.9, 0),
        ] {
            assert_eq!(
                n_withheld(n_categories, share),
                expected,
                "{n_categories}, {share}"
            );
        }
    }

    #[test]
    fn folds_withhold_others_and_the_seed_chooses() {
        let of = |fold, seed| withheld_categories(40, 0.5, fold, seed);
        assert_eq!(of(3, 1), of(3, 1));
        assert_ne!(of(3, 1), of(4, 1));
        assert_ne!(of(3, 1), of(3, 2));
        // Over many folds every category is withheld in about half of them.
        let mut counts = [0; 40];
        for fold in 0..400 {
            for (count, is_withheld) in counts.iter_mut().zip(of(fold, 1)) {
                *count += usize::from(is_withheld);
            }
        }
        // Expected value 200, standard deviation 10.
        assert!(counts.iter().all(|n| (150..=250).contains(n)), "{counts:?}");
    }
}
