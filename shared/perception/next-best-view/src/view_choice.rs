//! Choice of the next view by the scores of the candidates.

use crate::error::Error;
use crate::view_planner::{CandidateState, ViewScore};
use random::Random;
use value_range::check_range;

/// Rule of the choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ViewSelection {
    /// Candidate with the greatest utility; the first one of equals.
    Greedy,
    /// Random candidate, with a probability proportional to its utility to the power of `beta`, 0
    /// to 100 (Kasaei et al. 2018, equation 4, with `beta` 1).
    Sampled {
        /// Exponent: 0 draws evenly, a large one is nearly greedy.
        beta: f64,
    },
    /// Candidate with the least positive utility, as the paper's text says in places; for ablation
    /// only.
    Least,
}

/// Reason for the choice of a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChoiceReason {
    /// Utility of the view.
    Utility,
    /// Information gain, since no candidate has a positive utility.
    InformationGain,
    /// Distance from the current camera, since no candidate has utility or information gain.
    Distance,
}

/// Chosen view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ViewChoice {
    /// Index of the chosen candidate.
    pub candidate: usize,
    /// Reason for the choice.
    pub reason: ChoiceReason,
}

/// Chooses among the open candidates. Where none shows an object, because there are no hypotheses
/// or all are hidden, the one with the greatest information gain is chosen, and without any gain
/// the one farthest from the current camera, which sees the scene from another side.
///
/// # Errors
/// No open candidate, or an exponent outside its range.
pub fn choose_view(
    scores: &[ViewScore],
    selection: ViewSelection,
    random: &mut Random,
) -> Result<ViewChoice, Error> {
    let best = |value: fn(&ViewScore) -> f64| {
        let positive = open(scores).filter(|(_, score)| value(score) > 0.0);
        // The first of equals: `max_by` would take the last one.
        positive
            .rev()
            .max_by(|a, b| value(a.1).total_cmp(&value(b.1)))
    };
    let by_utility = match selection {
        ViewSelection::Greedy => best(|score| score.utility),
        ViewSelection::Least => open(scores)
            .filter(|(_, score)| score.utility > 0.0)
            .min_by(|a, b| a.1.utility.total_cmp(&b.1.utility)),
        ViewSelection::Sampled { beta } => {
            check_range("beta", beta, 0.0, 100.0)?;
            sampled(scores, beta, random)
        }
    };
    let found = [
        (by_utility, ChoiceReason::Utility),
        (best(|score| score.gain), ChoiceReason::InformationGain),
        (best(|score| score.distance_m), ChoiceReason::Distance),
    ];
    let mut found = found.into_iter();
    let choice = found.find_map(|(candidate, reason)| Some((candidate?.0, reason)));
    let (candidate, reason) = choice.ok_or_else(|| none_left(scores))?;
    Ok(ViewChoice { candidate, reason })
}

fn open(scores: &[ViewScore]) -> impl DoubleEndedIterator<Item = (usize, &ViewScore)> {
    let numbered = scores.iter().enumerate();
    numbered.filter(|(_, score)| score.state == CandidateState::Open)
}

fn sampled<'a>(
    scores: &'a [ViewScore],
    beta: f64,
    random: &mut Random,
) -> Option<(usize, &'a ViewScore)> {
    let utilities = || open(scores).filter(|(_, score)| score.utility > 0.0);
    let greatest = utilities()
        .map(|(_, score)| score.utility)
        .fold(0.0, f64::max);
    // Relative to the greatest one, so that no power overflows or vanishes altogether.
    let power = |score: &ViewScore| (score.utility / greatest).powf(beta);
    let sum: f64 = utilities().map(|(_, score)| power(score)).sum();
    let mut left = random.unit() * sum;
    let drawn = utilities().find(|(_, score)| {
        left -= power(score);
        left < 0.0
    });
    // Rounding may leave a remainder behind the last one.
    drawn.or_else(|| utilities().next_back())
}

fn none_left(scores: &[ViewScore]) -> Error {
    let count = |state| scores.iter().filter(|score| score.state == state).count();
    if scores.is_empty() {
        return Error::NoCandidates;
    }
    Error::NoneLeft {
        n: scores.len(),
        n_visited: count(CandidateState::Visited),
        n_blocked: count(CandidateState::Blocked),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn score(utility: f64, gain: f64, distance_m: f64, state: CandidateState) -> ViewScore {
        ViewScore {
            entropy: utility,
            gain,
            distance_m,
            weight: 1.0,
            utility,
            state,
        }
    }

    fn chosen(scores: &[ViewScore], selection: ViewSelection) -> ViewChoice {
        choose_view(scores, selection, &mut Random::from_seed(1)).unwrap()
    }

    #[test]
    fn greatest_open_utility_is_chosen_and_the_first_of_equals() {
        let scores = [
            score(9.0, 0.0, 0.0, CandidateState::Visited),
            score(1.0, 0.0, 1.0, CandidateState::Open),
            score(2.0, 0.0, 1.0, CandidateState::Open),
            score(2.0, 0.0, 1.0, CandidateState::Open),
            score(8.0, 0.0, 0.0, CandidateState::Blocked),
        ];
        let choice = chosen(&scores, ViewSelection::Greedy);
        assert_eq!(
            (choice.candidate, choice.reason),
            (2, ChoiceReason::Utility)
        );
        assert_eq!(chosen(&scores, ViewSelection::Least).candidate, 1);
    }

    #[test]
    fn without_utility_gain_decides_and_without_gain_distance() {
        let open = CandidateState::Open;
        let gaining = [score(0.0, 0.1, 3.0, open), score(0.0, 0.4, 1.0, open)];
        let far = [score(0.0, 0.0, 1.0, open), score(0.0, 0.0, 3.0, open)];
        for selection in [ViewSelection::Greedy, ViewSelection::Sampled { beta: 1.0 }] {
            let choice = chosen(&gaining, selection);
            assert_eq!(
                (choice.candidate, choice.reason),
                (1, ChoiceReason::InformationGain)
            );
            let choice = chosen(&far, selection);
            assert_eq!(
                (choice.candidate, choice.reason),
                (1, ChoiceReason::Distance)
            );
        }
    }

    #[test]
    fn frequencies_are_proportional_to_powers_of_the_utility() {
        let mut scores = [1.0, 2.0, 4.0]
            .map(|u| score(u, 0.0, 1.0, CandidateState::Open))
            .to_vec();
        scores.push(score(50.0, 0.0, 0.0, CandidateState::Visited));
        for (beta, expected) in [
            (0.0, [1.0 / 3.0; 3]),
            (1.0, [1.0 / 7.0, 2.0 / 7.0, 4.0 / 7.0]),
            (2.0, [1.0 / 21.0, 4.0 / 21.0, 16.0 / 21.0]),
        ] {
            let mut random = Random::from_seed(7);
            let mut counts = [0_u32; 4];
            for _ in 0..10_000 {
                let selection = ViewSelection::Sampled { beta };
                counts[choose_view(&scores, selection, &mut random)
                    .unwrap()
                    .candidate] += 1;
            }
            assert_eq!(counts[3], 0);
            for (count, expected) in counts.iter().zip(expected) {
                // Four standard deviations of 10 000 draws.
                assert!(
                    (f64::from(*count) / 1e4 - expected).abs() < 0.02,
                    "{counts:?}"
                );
            }
        }
    }

    #[test]
    fn exhausted_candidates_are_counted_in_the_error() {
        let scores = [
            score(1.0, 0.0, 0.0, CandidateState::Visited),
            score(1.0, 0.0, 0.0, CandidateState::Blocked),
        ];
        let mut random = Random::from_seed(1);
        let error = choose_view(&scores, ViewSelection::Greedy, &mut random).unwrap_err();
        let (n, n_visited, n_blocked) = (2, 1, 1);
        assert_eq!(
            error,
            Error::NoneLeft {
                n,
                n_visited,
                n_blocked
            }
        );
        let error = choose_view(&[], ViewSelection::Greedy, &mut random).unwrap_err();
        assert_eq!(error, Error::NoCandidates);
        let selection = ViewSelection::Sampled { beta: f64::NAN };
        let error = choose_view(&scores, selection, &mut random).unwrap_err();
        assert!(error.to_string().contains("beta"), "{error}");
    }
}
