//! Score of the three answers *is*, *probably* and *unknown*, with the prior of novelty learned
//! from corrections as the questions come, and the risk-coverage curve.

use crate::calibration_score::expected_calibration_error;
use crate::recogniser::Answer;
use learning::{Feedback, NoveltyPrior, under_prior};
use plot::diagram::{Axis, Color, Curve, Diagram, DrawingError, Legend, side_by_side};
use random::Random;
use scene_document::CategoryAnswer;
use serde::Serialize;

/// Answer to a question, and what is true.
#[derive(Debug, Clone, Copy)]
pub struct Question {
    /// Answer of the recogniser, with the initial prior of novelty.
    pub answer: Answer,
    /// True category of the object; `None` for one that was not taught.
    pub truth: Option<u32>,
}

/// Score of the three answers.
///
/// The questions of a run are asked in an order drawn by a seed, and a person corrects each wrong
/// answer: the prior of novelty is that learned from the questions before, as the daemon learns it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AnswerScore {
    /// Number of questions about taught categories.
    pub n_known: usize,
    /// Number of questions about other categories.
    pub n_new: usize,
    /// Share of the known objects of which a name is said without doubt.
    pub is_share: f64,
    /// Share of these names that is right; null without any.
    pub is_right: Option<f64>,
    /// Share of the known objects that are given a name, without doubt or probably.
    pub named_share: f64,
    /// Share of these names that is right; null without any.
    pub named_right: Option<f64>,
    /// Share of the new objects of which a name is said without doubt; null without new objects.
    pub new_is_share: Option<f64>,
    /// Share of the new objects that are given a name; null without new objects.
    pub new_named_share: Option<f64>,
    /// Expected calibration error of the probabilities.
    pub calibration_error: f64,
    /// Prior of novelty after the last question, mean over the runs.
    pub novelty_prior: f64,
    /// Risk-coverage curve of the known objects: shares of named objects and of wrong names among
    /// them, as the least probability falls.
    pub risk_coverage: Vec<[f64; 2]>,
}

/// Probability that the best category is right, what is said, and the question.
#[derive(Debug, Clone, Copy)]
struct Said {
    probability: f32,
    answer: CategoryAnswer,
    is_known: bool,
    is_right: bool,
}

impl AnswerScore {
    /// Score over some runs, each of which begins with the initial prior; a name is said from a
    /// probability of `known_probability_min`. `None` without known objects, or without
    /// probabilities.
    pub fn of(runs: &[Vec<Question>], known_probability_min: f32, seed: u64) -> Option<Self> {
        let mut priors = 0.0;
        let mut said = Vec::new();
        for (run, questions) in (0..).zip(runs) {
            let mut order: Vec<&Question> = questions.iter().collect();
            Random::substream(seed, run).shuffle(&mut order);
            let mut prior = NoveltyPrior::default();
            for question in order {
                said.extend(said_to(question, known_probability_min, &mut prior));
            }
            priors += f64::from(prior.probability()) / runs.len() as f64;
        }
        let pairs = said.iter().map(|said| (said.probability, said.is_right));
        let calibration_error = expected_calibration_error(pairs)?;
        let (known, new): (Vec<Said>, Vec<Said>) = said.into_iter().partition(|said| said.is_known);
        let is = |said: &Said| said.answer == CategoryAnswer::Is;
        let is_named = |said: &Said| said.answer != CategoryAnswer::Unknown;
        Some(Self {
            n_known: known.len(),
            n_new: new.len(),
            is_share: share(&known, is)?,
            is_right: share_of_right(&known, is),
            named_share: share(&known, is_named)?,
            named_right: share_of_right(&known, is_named),
            new_is_share: share(&new, is),
            new_named_share: share(&new, is_named),
            calibration_error,
            novelty_prior: priors,
            risk_coverage: risk_coverage(known),
        })
    }

    /// Sentence about the score.
    pub fn sentence(&self) -> String {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let right = |share: Option<f64>| share.map_or_else(|| "none".to_owned(), percent);
        let new = match (self.new_is_share, self.new_named_share) {
            (Some(is), Some(named)) => format!(
                "; of {} new objects {} get a name, {} without doubt",
                self.n_new,
                percent(named),
                percent(is)
            ),
            _ => String::new(),
        };
        format!(
            "with corrections, of {} known objects {} get a name, {} of these the right one; {} \
             without doubt, {} right{new}; expected calibration error {:.3}, prior of novelty {:.2}",
            self.n_known,
            percent(self.named_share),
            right(self.named_right),
            percent(self.is_share),
            right(self.is_right),
            self.calibration_error,
            self.novelty_prior
        )
    }
}

/// Answers a question, and learns from the correction.
fn said_to(question: &Question, least: f32, prior: &mut NoveltyPrior) -> Option<Said> {
    let Question { answer, truth } = question;
    let probability = under_prior(
        answer.probability?,
        answer.known_probability?,
        prior.probability(),
    );
    let name = answer.best[0].filter(|_| probability >= least);
    match (truth, name) {
        (Some(_), _) => prior.learn(Feedback::Known),
        (None, Some(_)) => prior.learn(Feedback::FalseName),
        (None, None) => {}
    }
    Some(Said {
        probability,
        answer: CategoryAnswer::of(name.is_some(), Some(f64::from(probability))),
        is_known: truth.is_some(),
        is_right: truth.is_some() && answer.best[0] == *truth,
    })
}

fn share(of: &[Said], is_counted: impl Fn(&Said) -> bool) -> Option<f64> {
    let n = of.iter().filter(|said| is_counted(said)).count();
    (!of.is_empty()).then(|| n as f64 / of.len() as f64)
}

fn share_of_right(of: &[Said], is_counted: impl Fn(&Said) -> bool) -> Option<f64> {
    let counted: Vec<Said> = of.iter().copied().filter(is_counted).collect();
    share(&counted, |said| said.is_right)
}

/// Draws the risk-coverage curve, with the shares that are named and that are said without doubt.
///
/// # Errors
/// When the picture cannot be drawn.
pub fn risk_coverage_svg(score: &AnswerScore) -> Result<String, DrawingError> {
    let percent = |share: f64| 100.0 * share;
    let curve = score.risk_coverage.iter();
    let curve = curve.map(|&[coverage, risk]| (percent(coverage), percent(risk)));
    let at =
        |share: f64, right: Option<f64>| right.map(|right| (percent(share), percent(1.0 - right)));
    let curves = [
        Curve::line("least probability falls", Color::of_series(0), curve),
        Curve::marked(
            "is",
            Color::of_series(1),
            at(score.is_share, score.is_right),
        ),
        Curve::marked(
            "is or probably",
            Color::of_series(2),
            at(score.named_share, score.named_right),
        ),
    ];
    let highest = score.risk_coverage.iter().map(|[_, risk]| percent(*risk));
    let highest = highest.fold(10.0, f64::max);
    side_by_side(&[Diagram {
        title: "Risk and coverage",
        x: Axis::linear("known objects that are named, %", 0.0..100.0),
        y: Axis::linear("wrong names among them, %", 0.0..highest),
        curves: curves.into(),
        legend: Legend::UpperLeft,
    }])
}

/// Number of points of a risk-coverage curve.
const N_POINTS: usize = 100;

/// Risk-coverage curve (El-Yaniv and Wiener 2010), most probable first.
fn risk_coverage(mut known: Vec<Said>) -> Vec<[f64; 2]> {
    known.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let mut n_wrong = 0;
    let wrong: Vec<usize> = known
        .iter()
        .map(|said| {
            n_wrong += usize::from(!said.is_right);
            n_wrong
        })
        .collect();
    let point = |i: usize| {
        let n = (i * known.len()).div_ceil(N_POINTS).max(1);
        [
            n as f64 / known.len() as f64,
            wrong[n - 1] as f64 / n as f64,
        ]
    };
    (1..=N_POINTS).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn question(probability: f32, known_probability: f32, truth: Option<u32>) -> Question {
        let answer = Answer {
            category: Some(1),
            distance: 1.0,
            novelty: 1.0,
            probability: Some(probability),
            known_probability: Some(known_probability),
            best: [Some(1), None, None],
        };
        Question { answer, truth }
    }

    #[test]
    fn prior_follows_the_corrections() {
        let known = vec![question(0.5, 0.6, Some(1)); 200];
        let score = AnswerScore::of(&[known], 0.6, 1).unwrap();
        // With the initial prior none is named, with the learned one all are.
        assert!(
            score.named_share > 0.9 && score.named_share < 1.0,
            "{score:?}"
        );
        assert_eq!((score.named_right, score.new_is_share), (Some(1.0), None));
        assert!(score.novelty_prior < 0.03);
        let mixed: Vec<Question> = (0..400)
            .map(|i| question(0.65, 0.7, (i % 2 == 0).then_some(1)))
            .collect();
        let score = AnswerScore::of(&[mixed], 0.6, 1).unwrap();
        assert!(score.novelty_prior > 0.25, "{score:?}");
        assert!(score.new_named_share.unwrap() < 0.5, "{score:?}");
    }

    #[test]
    fn risk_falls_with_the_coverage_where_probabilities_are_good() {
        let questions = (0..100).map(|i| {
            let probability = 0.005 + i as f32 / 100.0;
            question(probability, 1.0, Some(u32::from(i >= 40)))
        });
        let score = AnswerScore::of(&[questions.collect()], 0.6, 1).unwrap();
        assert_eq!(score.risk_coverage[59], [0.6, 0.0]);
        assert_eq!(score.risk_coverage[99], [1.0, 0.4]);
        assert_eq!((score.is_right, score.named_right), (Some(1.0), Some(1.0)));
        assert!((score.named_share - 0.4).abs() < 1e-9);
    }

    #[test]
    fn answers_without_probabilities_have_no_score() {
        let mut without = question(0.5, 0.6, Some(1));
        without.answer.probability = None;
        assert_eq!(AnswerScore::of(&[vec![without]], 0.6, 1), None);
        assert_eq!(
            AnswerScore::of(&[vec![question(0.5, 0.6, None)]], 0.6, 1),
            None
        );
    }
}
