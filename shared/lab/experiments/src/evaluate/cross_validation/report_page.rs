//! Table and figures of the cross-validation.

use super::end_to_end_score::EndToEndScore;
use super::fold_data::FoldData;
use super::report::{CategoryFigures, CrossValidationReport};
use crate::evaluate::open_set;
use crate::evaluate::tabular_report::{Column, ReportTable, TabularReport, figure, percent};
use evaluation::answer_score::AnswerScore;
use evaluation::new_side_score::NewSideScore;

/// Name of the picture of the risk-coverage curve.
pub(super) const RISK_COVERAGE_FILE: &str = "risk-coverage.svg";

/// Table, notes, confusion matrix and drawn scenes of the report.
pub(super) fn page(document: &CrossValidationReport, data: &FoldData) -> TabularReport<'static> {
    let confusion = figure(
        "confusion.svg",
        "A row for each category, a column for each answer, in percent; blue is right, red is wrong",
    );
    let scenes = data.scenes.iter().flat_map(|scenes| &scenes.pictures);
    let scenes = scenes.map(|(name, picture)| {
        let seen = "colour, ground truth and detection; striped regions are rejected";
        figure(picture, format!("{name}: {seen}"))
    });
    let curve = document.answers.is_some().then(|| {
        let meaning = "Risk-coverage curve: wrong names among those that are said, as less probable \
                       ones are said; the dots are where probably and is begin";
        figure(RISK_COVERAGE_FILE, meaning)
    });
    TabularReport {
        title: "Cross-validation",
        tables: vec![categories(document)],
        notes: notes(document),
        figures: std::iter::once(confusion)
            .chain(curve)
            .chain(scenes)
            .collect(),
        files: document.files.paths(),
        ..TabularReport::default()
    }
}

/// Table of the categories, worst first; those that were never asked, being withheld in all
/// folds, come last. The last two columns are only for scenes.
fn categories(document: &CrossValidationReport) -> ReportTable {
    type Row<'r> = (&'r String, &'r CategoryFigures);
    let right = |figures: &CategoryFigures| {
        (figures.n_asked > 0).then(|| f64::from(figures.n_right) / f64::from(figures.n_asked))
    };
    let count = |n: Option<u32>| n.map_or(String::new(), |n| n.to_string());
    let columns: [Column<'_, Row<'_>>; 6] = [
        ("category", &|(name, _)| (*name).clone()),
        ("views", &|(_, figures)| figures.n_asked.to_string()),
        ("right %", &|(_, figures)| percent(right(figures))),
        ("taken for", &|(_, figures)| {
            figures.taken_for.clone().unwrap_or_default()
        }),
        ("missed", &|(_, figures)| count(figures.n_missed)),
        ("parts", &|(_, figures)| count(figures.n_parts)),
    ];
    let mut categories: Vec<_> = document.categories.iter().collect();
    let order = |figures: &CategoryFigures| right(figures).unwrap_or(f64::INFINITY);
    categories.sort_by(|(_, a), (_, b)| order(a).total_cmp(&order(b)));
    let n_columns = if document.scenes.is_some() { 6 } else { 4 };
    ReportTable::of("Categories, worst first", categories, &columns[..n_columns])
}

/// Notes below the table, one sentence each.
fn notes(document: &CrossValidationReport) -> Vec<String> {
    let (settings, timing) = (&document.settings, &document.timing);
    let accuracies = document.folds.iter().filter_map(|fold| fold.accuracy);
    let (least, most) = accuracies.fold((1.0_f64, 0.0_f64), |(least, most), accuracy| {
        (least.min(accuracy), most.max(accuracy))
    });
    let mut notes = vec![
        format!(
            "accuracy {:.4} (macro {:.4}), F1 {:.4} (macro {:.4}); folds from {least:.4} to \
             {most:.4}",
            document.accuracy_micro, document.accuracy_macro, document.f1_micro, document.f1_macro
        ),
        format!(
            "{} categories, {} views in {} folds, {}; {}",
            document.header.n_categories,
            document.header.n_views,
            document.folds.len(),
            fold_assignment(document),
            settings.description.text()
        ),
        format!(
            "a view is described in {:.3} ms and compared in {:.3} ms on one thread, means; all \
             comparisons took {:.1} s",
            timing.describe_ms, timing.ask_ms, timing.test_s
        ),
    ];
    notes.push(best_and_calibration(document));
    notes.extend(document.answers.as_ref().map(AnswerScore::sentence));
    notes.extend(document.open_set.as_ref().map(open_set::sentence));
    notes.extend(document.new_sides.as_ref().map(new_sides));
    notes.extend(document.scenes.iter().flat_map(EndToEndScore::sentences));
    notes.extend(document.omissions.left_out.iter().cloned());
    notes
}

fn new_sides(score: &NewSideScore) -> String {
    format!(
        "unknown are {} questions about new objects and {} about new sides; of these {:.1} % and \
         {:.1} % are told as such, AUROC {:.3}; the best category of a new side is right in {:.1} %",
        score.n_new_objects,
        score.n_new_sides,
        100.0 * score.new_objects_told,
        100.0 * score.new_sides_told,
        score.auroc,
        100.0 * score.new_sides_named
    )
}

fn best_and_calibration(document: &CrossValidationReport) -> String {
    let sides = match document.settings.n_sides {
        1 => "each view is asked alone".to_owned(),
        n => format!("views of {n} sides of an object are asked together"),
    };
    let calibration = document
        .calibration_error
        .map_or_else(String::new, |error| {
            format!("; expected calibration error {error:.3}")
        });
    format!(
        "{sides}; the right category is among the three best in {:.4}{calibration}",
        document.top3
    )
}

fn fold_assignment(document: &CrossValidationReport) -> String {
    let settings = &document.settings;
    match settings.folds {
        "instance-disjoint" => format!(
            "the views of an object together in {} of the categories",
            settings.n_grouped
        ),
        "other-side" => "each side of the objects in one fold".to_owned(),
        "scene" => "scene by scene".to_owned(),
        "contiguous" => "in the order of their names".to_owned(),
        _ => "view by view: the same objects are taught and asked".to_owned(),
    }
}
