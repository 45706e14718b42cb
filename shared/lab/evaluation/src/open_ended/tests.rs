use super::*;
use crate::novelty_score::NoveltyScore;
use crate::recogniser::{Answer, LabelledView, Recogniser};
use random::Random;
use statistics::spread::MeanAndStd;
use std::collections::{HashMap, HashSet};

/// Recogniser of fixed accuracy, independent of its training; records lessons and questions.
struct FixedAccuracyRecogniser<'a> {
    views: &'a [LabelledView],
    accuracy: f64,
    unknowns: f64,
    random: Random,
    taught: Vec<(u32, usize)>,
    known: HashSet<u32>,
    asked: Vec<usize>,
}

impl<'a> FixedAccuracyRecogniser<'a> {
    fn new(views: &'a [LabelledView], accuracy: f64, seed: u64) -> Self {
        Self {
            views,
            accuracy,
            unknowns: 0.0,
            random: Random::substream(seed, 99),
            taught: Vec::new(),
            known: HashSet::new(),
            asked: Vec::new(),
        }
    }
}

impl Recogniser for FixedAccuracyRecogniser<'_> {
    fn teach(&mut self, category: u32, view: usize) {
        self.taught.push((category, view));
        self.known.insert(category);
    }

    fn ask_sides(&mut self, views: &[usize]) -> Answer {
        let view = views[0];
        self.asked.push(view);
        let truth = self.views[view].category;
        let is_known = self.known.contains(&truth);
        let category = if self.random.unit() < self.accuracy {
            is_known.then_some(truth)
        } else {
            (self.random.unit() >= self.unknowns).then_some(truth + 1)
        };
        let novelty = if is_known { 0.2 } else { 0.8 };
        Answer {
            category,
            distance: 0.5,
            novelty,
            probability: None,
            known_probability: None,
            best: [None; 3],
        }
    }
}

fn data_set(n_categories: u32, n_views: u32, n_instances: Option<u32>) -> Vec<LabelledView> {
    let view = |category, view| LabelledView {
        category,
        instance: n_instances.map(|n| view % n),
    };
    (0..n_categories)
        .flat_map(|category| (0..n_views).map(move |i| view(category, i)))
        .collect()
}

fn play(views: &[LabelledView], protocol: &Protocol, accuracy: f64, seed: u64) -> OpenEndedRun {
    run(
        &mut FixedAccuracyRecogniser::new(views, accuracy, seed),
        views,
        protocol,
        seed,
    )
    .unwrap()
}

#[test]
fn perfect_recogniser_needs_each_question_once() {
    for (n_categories, qci) in [(51, 1325), (10, 54), (90, 4094)] {
        let views = data_set(n_categories, 200, None);
        let run = play(&views, &Protocol::default(), 1.0, 1);
        let metrics = run.metrics();
        assert_eq!(run.stop, StopReason::AllLearned);
        assert_eq!((metrics.qci, metrics.tlc), (qci, n_categories));
        let shares = (metrics.aic, metrics.gca, metrics.apa);
        assert_eq!(shares, (3.0, 1.0, Some(1.0)));
    }
}

/// Reference results for constant accuracy: TLC, QCI, AIC, GCA, APA, and the share of runs that
/// learn all 51 categories.
const EXPECTED: [(f64, [f64; 5], f64); 9] = [
    (0.62, [18.7, 683.0, 16.4, 0.616, 0.731], 0.0),
    (0.65, [26.8, 1035.0, 15.9, 0.643, 0.731], 0.02),
    (0.67, [38.2, 1554.0, 15.8, 0.667, 0.732], 0.28),
    (0.68, [43.6, 1769.0, 15.7, 0.678, 0.731], 0.54),
    (0.70, [49.0, 1772.0, 13.8, 0.700, 0.737], 0.84),
    (0.72, [50.6, 1620.0, 12.0, 0.720, 0.748], 0.98),
    (0.75, [51.0, 1459.0, 10.1, 0.751, 0.770], 1.0),
    (0.80, [51.0, 1356.0, 8.3, 0.801, 0.810], 1.0),
    (0.90, [51.0, 1328.0, 5.6, 0.899, 0.902], 1.0),
];

/// Expected and measured means are both over 200 runs, so their difference has a standard
/// deviation of sqrt(2 / 200) times that of a run; 4.5 of these plus the rounding of the table
/// are allowed.
#[test]
fn metrics_of_constant_accuracy_agree_with_the_reference() {
    let views = data_set(51, 200, None);
    for (accuracy, expected, all_learned) in EXPECTED {
        let runs: Vec<OpenEndedRun> = (0..200)
            .map(|seed| play(&views, &Protocol::default(), accuracy, seed))
            .collect();
        assert!(runs.iter().all(|run| run.stop != StopReason::LackOfData));
        let metrics: Vec<Metrics> = runs.iter().map(OpenEndedRun::metrics).collect();
        let summary = MetricsSummary::of(&metrics);
        let found = [
            summary.tlc,
            summary.qci,
            summary.aic,
            summary.gca,
            summary.apa,
        ];
        let rounding = [0.05, 0.5, 0.05, 0.0005, 0.0005];
        for ((found, expected), rounding) in found.into_iter().zip(expected).zip(rounding) {
            let MeanAndStd { mean, std } = found.unwrap();
            let allowed = 4.5 * std.unwrap() * (2.0_f64 / 200.0).sqrt() + rounding;
            let is_near = (mean - expected).abs() <= allowed;
            assert!(
                is_near,
                "{accuracy}: {mean:.3}, expected {expected} ± {allowed:.3}"
            );
        }
        let n_all = runs.iter().filter(|run| run.stop == StopReason::AllLearned);
        let share = n_all.count() as f64 / 200.0;
        let std = (all_learned * (1.0 - all_learned) * 2.0 / 200.0_f64).sqrt();
        assert!(
            (share - all_learned).abs() <= 4.5 * std + 0.005,
            "{accuracy}: {share}"
        );
    }
}

#[test]
fn taught_views_are_those_of_start_and_corrections() {
    for (split, n_instances) in [
        (LessonSplit::ByView, None),
        (LessonSplit::InstanceDisjoint, Some(4)),
    ] {
        let views = data_set(12, 300, n_instances);
        for seed in 0..20 {
            let mut recogniser = FixedAccuracyRecogniser::new(&views, 0.7, seed);
            recogniser.unknowns = 0.3;
            let protocol = Protocol {
                split,
                ..Protocol::default()
            };
            let run = run(&mut recogniser, &views, &protocol, seed).unwrap();
            let Metrics {
                qci, tlc, aic, gca, ..
            } = run.metrics();
            let corrections = f64::from(qci) * (1.0 - gca);
            assert_eq!(corrections.round() as u32, run.n_corrections());
            assert!((corrections - corrections.round()).abs() < 1e-9);
            assert!((aic - (3.0 + corrections / f64::from(tlc))).abs() < 1e-12);
            assert_eq!(
                recogniser.taught.len() as u32,
                3 * tlc + run.n_corrections()
            );
        }
    }
}

#[test]
fn views_are_used_once_and_corrected_at_once() {
    let views = data_set(8, 200, None);
    let mut recogniser = FixedAccuracyRecogniser::new(&views, 0.7, 3);
    let run = run(&mut recogniser, &views, &Protocol::default(), 3).unwrap();
    let n_asked = recogniser.asked.iter().collect::<HashSet<_>>().len();
    assert_eq!(n_asked, recogniser.asked.len());
    let wrong: Vec<(u32, usize)> = run
        .questions
        .iter()
        .filter(|question| !question.is_right())
        .map(|question| (question.truth, question.view))
        .collect();
    let corrections: Vec<(u32, usize)> = recogniser
        .taught
        .iter()
        .filter(|(_, view)| recogniser.asked.contains(view))
        .copied()
        .collect();
    assert_eq!(corrections, wrong);
    let n_taught = recogniser.taught.iter().collect::<HashSet<_>>().len();
    assert_eq!(n_taught, recogniser.taught.len());
    assert!(
        recogniser
            .taught
            .iter()
            .all(|&(c, view)| views[view].category == c)
    );
}

#[test]
fn categories_are_asked_in_the_order_of_their_introduction() {
    let views = data_set(6, 100, None);
    let run = play(&views, &Protocol::default(), 1.0, 5);
    let order: Vec<u32> = run.taught.iter().map(|(category, _)| *category).collect();
    let asked: Vec<u32> = run
        .questions
        .iter()
        .map(|question| question.truth)
        .collect();
    let expected: Vec<u32> = (2..=6).flat_map(|n| order[..n].to_vec()).collect();
    assert_eq!(asked, expected);
}

#[test]
fn failing_learner_stalls_101_questions_beyond_the_window() {
    let views = data_set(5, 200, None);
    let run = play(&views, &Protocol::default(), 0.0, 1);
    assert_eq!(run.stop, StopReason::Stalled);
    // The failed category and its accuracy are counted.
    let metrics = run.metrics();
    assert_eq!((metrics.tlc, metrics.qci), (2, 3 * 2 + 101));
    assert_eq!((metrics.apa, metrics.gca), (Some(0.0), 0.0));
}

#[test]
fn a_run_ends_without_fresh_views() {
    let views = data_set(5, 10, None);
    let run = play(&views, &Protocol::default(), 0.0, 1);
    assert_eq!(run.stop, StopReason::LackOfData);
    // Seven views of each of two categories remain after the lessons.
    let metrics = run.metrics();
    assert_eq!((metrics.tlc, metrics.qci, metrics.apa), (2, 14, None));
}

#[test]
fn instance_disjoint_split_separates_objects() {
    let views = data_set(6, 120, Some(5));
    let protocol = Protocol {
        split: LessonSplit::InstanceDisjoint,
        ..Protocol::default()
    };
    let mut recogniser = FixedAccuracyRecogniser::new(&views, 0.8, 2);
    let run = run(&mut recogniser, &views, &protocol, 2).unwrap();
    assert!(run.n_corrections() > 0);
    let mut taught: HashMap<u32, HashSet<u32>> = HashMap::new();
    for &(category, view) in &recogniser.taught {
        let instance = views[view].instance.unwrap();
        taught.entry(category).or_default().insert(instance);
    }
    for &view in &recogniser.asked {
        let LabelledView { category, instance } = views[view];
        assert!(!taught[&category].contains(&instance.unwrap()));
    }
    assert!(taught.values().all(|instances| instances.len() <= 2));
}

#[test]
fn a_seed_gives_the_same_run_and_another_seed_another() {
    let views = data_set(10, 200, None);
    let first = play(&views, &Protocol::default(), 0.75, 4);
    assert_eq!(first, play(&views, &Protocol::default(), 0.75, 4));
    let other = play(&views, &Protocol::default(), 0.75, 5);
    assert_ne!(first.taught, other.taught);
}

#[test]
fn open_set_questions_leave_the_figures_as_they_are() {
    let views = data_set(30, 200, None);
    let open = Protocol {
        open_set_share: 0.25,
        ..Protocol::default()
    };
    let (without, with) = (
        play(&views, &Protocol::default(), 1.0, 7),
        play(&views, &open, 1.0, 7),
    );
    assert_eq!(without.metrics(), with.metrics());
    assert_eq!(without.taught, with.taught);
    let novelty = |run: &OpenEndedRun| {
        let [open, known] = [true, false].map(|kind| run.answers(kind).collect::<Vec<_>>());
        NoveltyScore::of(&open, &known, 0.75)
    };
    assert_eq!(novelty(&without), None);
    let score = novelty(&with).unwrap();
    assert_eq!((score.auroc, score.false_alarms_at_95), (1.0, 0.0));
    assert_eq!((score.rejected, score.known_rejected), (1.0, 0.0));
    let share = score.n as f64 / (score.n + score.n_known) as f64;
    assert!((share - 0.25).abs() < 0.08, "{share}");
    let mut introduced = HashSet::new();
    for question in &with.questions {
        let order = with.taught.iter().take(question.n_categories as usize);
        introduced.extend(order.map(|(category, _)| *category));
        assert_eq!(question.is_open_set, !introduced.contains(&question.truth));
    }
}

#[test]
fn excluded_categories_have_a_reason() {
    let mut views = data_set(4, 20, Some(2));
    views.extend(
        [LabelledView {
            category: 4,
            instance: Some(0),
        }; 3],
    );
    views.extend(
        [LabelledView {
            category: 5,
            instance: Some(0),
        }; 9],
    );
    let by_view = usable_categories(&Protocol::default(), &views).unwrap();
    assert_eq!(by_view[4], (4, Some(Exclusion::TooFewViews { n_views: 3 })));
    assert_eq!(by_view[5], (5, None));
    let disjoint = Protocol {
        split: LessonSplit::InstanceDisjoint,
        ..Protocol::default()
    };
    let found = usable_categories(&disjoint, &views).unwrap();
    assert_eq!(found[5], (5, Some(Exclusion::TooFewInstances)));
    assert_eq!(play(&views, &disjoint, 1.0, 1).metrics().tlc, 4);
}

#[test]
fn invalid_parameters_are_refused() {
    let views = data_set(4, 20, None);
    let check = |protocol: Protocol, part: &str| {
        let error = usable_categories(&protocol, &views).unwrap_err();
        assert!(error.to_string().contains(part), "{error}");
    };
    let usual = Protocol::default;
    check(
        Protocol {
            tau: f64::NAN,
            ..usual()
        },
        "learned",
    );
    check(
        Protocol {
            tau: 1.1,
            ..usual()
        },
        "1.1",
    );
    check(
        Protocol {
            open_set_share: 1.0,
            ..usual()
        },
        "open-set",
    );
    check(
        Protocol {
            n_views_at_start: 0,
            ..usual()
        },
        "at least one",
    );
    check(
        Protocol {
            n_views_at_start: 20,
            ..usual()
        },
        "0 of the categories",
    );
    let split = LessonSplit::InstanceDisjoint;
    check(Protocol { split, ..usual() }, "needs two");
}
