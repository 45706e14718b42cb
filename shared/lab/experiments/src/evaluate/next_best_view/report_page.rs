//! Text and HTML page of the next best view.

use super::closed_loop::N_VIEWS_MAX;
use super::entropy_prediction::HypothesisSource;
use super::figures::{ENTROPY, LOOPS, PREDICTION};
use super::loop_method::Method;
use super::report::{NextBestViewReport, SceneReport, source_name};
use super::statistic_report::{self, CAPTION, STATISTIC, STATISTIC_HEADS};
use command_line::format_table;
use plot::figure_page::{PageFigure, PageTable, html};
use statistics::bootstrap::Estimate;

/// Column headings of the tables.
const METHOD_HEADS: [&str; 6] = [
    "method",
    "views to 95 %",
    "travel m",
    "complete %",
    "found after 5 views %",
    "found within 3 m %",
];
const PREDICTION_HEADS: [&str; 7] = [
    "hypotheses",
    "MAE bit",
    "RMSE bit",
    "bias bit",
    "rank correlation",
    "regret bit (random)",
    "among the ten best %",
];
const POSE_HEADS: [&str; 4] = ["segments", "number", "of them", "share %"];
const SCENE_HEADS: [&str; 9] = [
    "seed",
    "objects",
    "findable",
    "entropy bit",
    "visibility %",
    "F1",
    "F1 of detection",
    "Pearson r",
    "Spearman rho",
];

/// Report as text for the terminal.
pub(super) fn text(report: &NextBestViewReport) -> String {
    let mut lines = vec![
        format_table(&METHOD_HEADS, &method_rows(report)),
        String::new(),
        format_table(&PREDICTION_HEADS, &prediction_rows(report)),
        String::new(),
        format_table(&POSE_HEADS, &report.poses.rows()),
        String::new(),
        format_table(&SCENE_HEADS, &scene_rows(report)),
        String::new(),
        format_table(
            &STATISTIC_HEADS,
            &statistic_report::rows(&report.published_statistic),
        ),
        String::new(),
    ];
    lines.extend(notes(report));
    lines.join("\n")
}

/// HTML page with the tables, the figures and the pictures.
pub(super) fn page(report: &NextBestViewReport, pictures: &[String]) -> String {
    let mut tables = vec![
        PageTable::new("Closed loops", &METHOD_HEADS, method_rows(report)),
        PageTable::new(
            "Predicted entropy",
            &PREDICTION_HEADS,
            prediction_rows(report),
        ),
        PageTable::new(
            "Recognition and registration",
            &POSE_HEADS,
            report.poses.rows(),
        ),
        PageTable::new("Scenes", &SCENE_HEADS, scene_rows(report)),
    ];
    let statistic = statistic_report::rows(&report.published_statistic);
    if !statistic.is_empty() {
        tables.push(PageTable::new(
            "Published statistic",
            &STATISTIC_HEADS,
            statistic,
        ));
    }
    let figure = |picture: &String| PageFigure {
        caption: caption(picture),
        picture: picture.clone(),
    };
    let figures: Vec<PageFigure> = pictures.iter().map(figure).collect();
    html("Next best view", &notes(report), &tables, &figures)
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

fn method_rows(report: &NextBestViewReport) -> Vec<Vec<String>> {
    let rows = Method::ALL.into_iter().filter_map(|method| {
        let found = report.methods.get(method.name())?;
        Some(vec![
            method.name().to_owned(),
            interval(found.views_to_95_interval, 1),
            format!("{:.1}", found.travel_m),
            percent(found.complete_share),
            percent(found.found_after_5_views),
            percent(found.found_within_3_m),
        ])
    });
    rows.collect()
}

fn prediction_rows(report: &NextBestViewReport) -> Vec<Vec<String>> {
    let rows = HypothesisSource::ALL.into_iter().filter_map(|source| {
        let name = source_name(source);
        let score = report.predictions.get(&name)?;
        Some(vec![
            name,
            format!("{:.3}", score.mae),
            format!("{:.3}", score.rmse),
            format!("{:+.3}", score.bias),
            format!("{:.3}", score.spearman_rho),
            format!("{:.3} ({:.3})", score.regret, score.random_regret),
            percent(score.top_ten_share),
        ])
    });
    rows.collect()
}

fn scene_rows(report: &NextBestViewReport) -> Vec<Vec<String>> {
    let number = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.2}"));
    let row = |scene: &SceneReport| {
        vec![
            scene.seed.to_string(),
            scene.n_objects.to_string(),
            scene.n_findable.to_string(),
            format!("{:.2}", scene.entropy),
            percent(scene.visibility),
            format!("{:.2}", scene.f1),
            format!("{:.2}", scene.detection_f1),
            number(scene.pearson_r),
            number(scene.spearman_rho),
        ]
    };
    report.scenes.iter().map(row).collect()
}

fn percent(share: f64) -> String {
    format!("{:.1}", 100.0 * share)
}

fn interval(estimate: Option<Estimate>, n_decimals: usize) -> String {
    estimate.map_or("–".to_owned(), |Estimate { value, low, high }| {
        format!("{value:.n_decimals$} ({low:.n_decimals$} to {high:.n_decimals$})")
    })
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
    let n_thrown = NextBestViewReport::n_thrown();
    let intervals = &report.intervals;
    let mut notes = vec![
        format!(
            "{n_scenes} scenes of {n_thrown} models ({}) thrown into a bin, {n_views} views over \
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
