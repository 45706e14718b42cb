//! Expected calibration error of the probabilities of answers.

/// Number of bins of equal width. Usual value (Guo et al. 2017).
const N_BINS: usize = 15;

/// Expected calibration error (ECE; Naeini, Cooper and Hauskrecht 2015; Guo et al. 2017):
/// mean difference between the probability of an answer and the share of right answers,
/// over 15 bins of probability weighted by their answers. Each answer is its probability,
/// 0 to 1, with `true` if it is right. `None` without answers.
pub fn expected_calibration_error(answers: impl IntoIterator<Item = (f32, bool)>) -> Option<f64> {
    let mut bins = [(0.0_f64, 0_u32); N_BINS];
    let mut n = 0_u32;
    for (probability, is_right) in answers {
        let bin = (f64::from(probability) * N_BINS as f64) as usize;
        let (difference, count) = &mut bins[bin.min(N_BINS - 1)];
        *difference += f64::from(probability) - f64::from(u8::from(is_right));
        *count += 1;
        n += 1;
    }
    let sum: f64 = bins.iter().map(|(difference, _)| difference.abs()).sum();
    (n > 0).then(|| sum / f64::from(n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_is_the_gap_between_probability_and_share_of_right_answers() {
        let answers =
            |probability: f32, n_right: usize| (0..10).map(move |i| (probability, i < n_right));
        let error = |answers: Vec<(f32, bool)>| expected_calibration_error(answers).unwrap();
        assert!(error(answers(0.7, 7).collect()) < 1e-6);
        assert!((error(answers(0.9, 5).collect()) - 0.4).abs() < 1e-6);
        // Bins do not cancel each other.
        let both = answers(0.9, 8).chain(answers(0.2, 3)).collect();
        assert!((error(both) - 0.1).abs() < 1e-6);
        assert!(error(vec![(1.0, true), (0.0, false)]) < 1e-9);
        assert_eq!(expected_calibration_error([]), None);
    }
}
