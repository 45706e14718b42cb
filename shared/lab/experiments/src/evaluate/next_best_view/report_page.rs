//! Tables and figures of the next best view.

use super::closed_loop::N_VIEWS_MAX;
use super::figures::{ENTROPY, LOOPS, PREDICTION};
use super::loop_method::Method;
use super::prediction_source::PredictionSource;
use super::report::NextBestViewReport;
use super::simulated_bin::N_OBJECTS;
use super::statistic_report::{self, CAPTION, STATISTIC};
use crate::evaluate::tabular_report::{
    ReportTable, TabularReport, figure, interval, number, percent,
};

/// Tables, notes and pictures of the report.
pub(super) fn page(report: &NextBestViewReport, pictures: &[String]) -> TabularReport<'static> {
    let figures = pictures
        .iter()
        .map(|picture| figure(picture, caption(picture)));
    TabularReport {
        title: "Next best view",
        tables: vec![
            methods(report),
            predictions(report),
            report.poses.table(),
            scenes(report),
            statistic_report::table(&report.published_statistic),
        ],
        notes: notes(report),
        figures: figures.collect(),
        ..TabularReport::default()
    }
}

fn caption(picture: &str) -> String {
    match picture {
        ENTROPY => "Entropy, visibility and F1 of all views; one colour for each scene".to_owned(),
        PREDICTION => "Entropy predicted from the first view and its truth".to_owned(),
        STATISTIC => CAPTION.to_owned(),
        LOOPS => "Objects found in the closed loop, by views and by travel".to_owned(),
        _ => format!("First views of a loop: {picture}"),
    }
}

fn methods(report: &NextBestViewReport) -> ReportTable {
    let methods = Method::ALL.into_iter();
    let methods = methods.filter_map(|method| Some((method, report.methods.get(method.word())?)));
    ReportTable::of(
        "Closed loops",
        methods,
        &[
            ("method", &|(method, _)| method.word().to_owned()),
            ("views to 95 %", &|(_, found)| {
                interval(found.views_to_95_interval, 1)
            }),
            ("travel m", &|(_, found)| number(found.travel_m, 1)),
            ("complete %", &|(_, found)| percent(found.complete_share)),
            ("found after 5 views %", &|(_, found)| {
                percent(found.found_after_5_views)
            }),
            ("found within 3 m %", &|(_, found)| {
                percent(found.found_within_3_m)
            }),
        ],
    )
}

fn predictions(report: &NextBestViewReport) -> ReportTable {
    let sources = PredictionSource::ALL
        .into_iter()
        .map(PredictionSource::word);
    let scores = sources.filter_map(|name| {
        let score = report.predictions.get(name)?;
        Some((name, score))
    });
    ReportTable::of(
        "Predicted entropy",
        scores,
        &[
            ("hypotheses", &|(name, _)| (*name).to_owned()),
            ("MAE bit", &|(_, score)| number(score.mae, 3)),
            ("RMSE bit", &|(_, score)| number(score.rmse, 3)),
            ("bias bit", &|(_, score)| format!("{:+.3}", score.bias)),
            ("rank correlation", &|(_, score)| {
                number(score.spearman_rho, 3)
            }),
            ("regret bit (random)", &|(_, score)| score.regrets()),
            ("among the ten best %", &|(_, score)| {
                percent(score.top_ten_share)
            }),
        ],
    )
}

fn scenes(report: &NextBestViewReport) -> ReportTable {
    ReportTable::of(
        "Scenes",
        &report.scenes,
        &[
            ("seed", &|scene| scene.seed.to_string()),
            ("objects", &|scene| scene.n_objects.to_string()),
            ("findable", &|scene| scene.n_findable.to_string()),
            ("entropy bit", &|scene| number(scene.entropy, 2)),
            ("visibility %", &|scene| percent(scene.visibility)),
            ("F1", &|scene| number(scene.f1, 2)),
            ("F1 of detection", &|scene| number(scene.detection_f1, 2)),
            ("Pearson r", &|scene| number(scene.pearson_r, 2)),
            ("Spearman rho", &|scene| number(scene.spearman_rho, 2)),
        ],
    )
}

/// Notes below the tables, one sentence each.
fn notes(report: &NextBestViewReport) -> Vec<String> {
    let NextBestViewReport {
        n_scenes,
        n_views,
        n_starts,
        seed,
        ..
    } = report;
    let intervals = &report.intervals;
    let mut notes = vec![
        format!(
            "{n_scenes} scenes of {N_OBJECTS} models ({}) thrown into a bin, {n_views} views over \
             the upper hemisphere, {n_starts} first views for each method; seed {seed}",
            report.models
        ),
        format!(
            "entropy and F1 over the views of a scene: Pearson r {}, Spearman rho {}; with the \
             area of the objects alone r {}, mean visibility and F1 r {}, entropy and F1 of \
             detection alone r {}",
            interval(intervals.pearson_r, 2),
            interval(intervals.spearman_rho, 2),
            interval(intervals.pearson_r_objects_only, 2),
            interval(intervals.pearson_r_visibility, 2),
            interval(intervals.pearson_r_detection, 2)
        ),
        format!(
            "F1 is that of the project's segments over all objects of the scene, hidden ones \
             included; a segment is right with an intersection over union of one half and the right \
             object; objects were taught in {} other heaps of them",
            report.n_lesson_heaps
        ),
        format!(
            "a loop ends when 95 % of the objects that detection finds in at least one in twenty \
             views were found, or after {N_VIEWS_MAX} views; deviation of the weight by distance \
             {}, of the penalty near visited views {}, weight of the information gain {}",
            report.sigma_share, report.visited_share, report.gain_weight
        ),
    ];
    if !report.published_statistic.is_empty() {
        notes.extend(statistic_report::notes(&report.published_statistic));
    }
    notes
}
