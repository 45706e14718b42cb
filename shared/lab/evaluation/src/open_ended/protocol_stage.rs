//! Stage of the protocol: questions between two introductions, with windowed accuracy.

use super::protocol::Protocol;
use super::record::Question;

/// Decision after a question of a stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum StageDecision {
    /// Ask the next question of the stage.
    Continue,
    /// Introduce the next category. The accuracy enters the APA; `None` if it equals the
    /// threshold, which ends a stage but does not count.
    Passed(Option<f64>),
    /// End the run; the accuracy enters the APA.
    Stalled(f64),
}

/// True and false positives and false negatives of an answer.
#[derive(Debug, Clone, Copy, Default)]
struct AnswerCounts {
    true_positives: u32,
    false_positives: u32,
    false_negatives: u32,
}

/// Answers given since the last category was introduced.
#[derive(Debug)]
pub(super) struct ProtocolStage {
    n_categories: usize,
    answers: Vec<AnswerCounts>,
    n_below: u32,
}

impl AnswerCounts {
    /// Counts of an answer: a wrong category is a false positive and a false negative, "unknown"
    /// only a false negative.
    fn of(question: &Question) -> Self {
        let is_right = question.is_right();
        let is_wrong_name = !is_right && question.answer.category.is_some();
        Self {
            true_positives: is_right.into(),
            false_positives: is_wrong_name.into(),
            false_negatives: (!is_right).into(),
        }
    }

    fn f1(answers: &[Self]) -> f64 {
        let sum = |of: fn(&Self) -> u32| answers.iter().map(of).sum::<u32>();
        let right = 2 * sum(|answer| answer.true_positives);
        let wrong = sum(|answer| answer.false_positives + answer.false_negatives);
        f64::from(right) / f64::from((right + wrong).max(1))
    }
}

impl ProtocolStage {
    pub(super) fn new(n_categories: usize) -> Self {
        Self {
            n_categories,
            answers: Vec::new(),
            n_below: 0,
        }
    }

    /// Counts an answer and decides. The protocol accuracy is the micro F1 of all answers of the
    /// stage, or of the window if there are more; `None` until every category could be asked
    /// once.
    pub(super) fn count(
        &mut self,
        question: &Question,
        protocol: &Protocol,
    ) -> (Option<f64>, StageDecision) {
        self.answers.push(AnswerCounts::of(question));
        let (n_asked, window) = (self.answers.len(), protocol.window * self.n_categories);
        if n_asked < self.n_categories {
            return (None, StageDecision::Continue);
        }
        let first = n_asked.saturating_sub(window);
        let accuracy = AnswerCounts::f1(&self.answers[first..]);
        let is_above = accuracy > protocol.tau;
        if n_asked > window && !is_above {
            self.n_below += 1;
            if self.n_below > protocol.stall_limit {
                return (Some(accuracy), StageDecision::Stalled(accuracy));
            }
        }
        let verdict = if accuracy < protocol.tau {
            StageDecision::Continue
        } else {
            StageDecision::Passed(is_above.then_some(accuracy))
        };
        (Some(accuracy), verdict)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recogniser::Answer;

    fn question(answer: Option<u32>) -> Question {
        Question {
            iteration: 1,
            n_categories: 2,
            view: 0,
            truth: 1,
            is_open_set: false,
            answer: Answer {
                category: answer,
                distance: 0.0,
                novelty: 0.0,
                probability: None,
                known_probability: None,
                best: [None; 3],
            },
            accuracy: None,
        }
    }

    /// Outcomes of a stage with two categories; answers are `r` right, `w` wrong, `u` unknown.
    fn play(answers: &str, tau: f64) -> Vec<(Option<f64>, StageDecision)> {
        let protocol = Protocol {
            tau,
            stall_limit: 2,
            ..Protocol::default()
        };
        let mut stage = ProtocolStage::new(2);
        let answer = |letter| match letter {
            'r' => Some(1),
            'w' => Some(0),
            _ => None,
        };
        answers
            .chars()
            .map(|letter| stage.count(&question(answer(letter)), &protocol))
            .collect()
    }

    #[test]
    fn a_stage_needs_as_many_questions_as_categories() {
        assert_eq!(
            play("rr", 0.67),
            [
                (None, StageDecision::Continue),
                (Some(1.0), StageDecision::Passed(Some(1.0)))
            ]
        );
    }

    #[test]
    fn accuracy_at_the_threshold_ends_a_stage_uncounted() {
        assert_eq!(play("rw", 0.5)[1], (Some(0.5), StageDecision::Passed(None)));
        assert_eq!(play("rw", 0.49)[1].1, StageDecision::Passed(Some(0.5)));
        assert_eq!(play("rw", 0.51)[1].1, StageDecision::Continue);
    }

    #[test]
    fn unknown_costs_less_than_a_wrong_category() {
        assert_eq!(play("rw", 0.9)[1].0, Some(0.5));
        assert_eq!(play("ru", 0.9)[1].0, Some(2.0 / 3.0));
    }

    #[test]
    fn stall_counting_begins_beyond_the_window() {
        let stage = play("wwrrrrwww", 0.9);
        let accuracies: Vec<f64> = stage.iter().filter_map(|(accuracy, _)| *accuracy).collect();
        // The window holds six answers: the two wrong ones at the start leave it.
        let expected = [0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 4.0, 3.0];
        let sizes = [2.0, 3.0, 4.0, 5.0, 6.0, 6.0, 6.0, 6.0];
        let expected: Vec<f64> = expected.iter().zip(sizes).map(|(r, n)| r / n).collect();
        assert!(
            accuracies
                .iter()
                .zip(&expected)
                .all(|(a, b)| (a - b).abs() < 1e-12)
        );
        // With a stall limit of two, the third answer beyond the window ends the run.
        assert_eq!(stage[7].1, StageDecision::Continue);
        assert_eq!(stage[8].1, StageDecision::Stalled(0.5));
    }
}
