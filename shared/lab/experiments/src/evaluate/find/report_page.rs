//! Table and pictures of queries in words.

use super::report::{
    AskedQuery, FindReport, QueryCounts, QuerySource, SceneObjectReport, SceneReport,
};
use crate::evaluate::tabular_report::{ReportTable, TabularReport, figure};
use plot::figure_page::PageFigure;

/// Table of the queries that are wanted, notes, and pictures of the scenes.
pub(super) fn page(
    document: &FindReport,
    is_wanted: impl Fn(&AskedQuery) -> bool,
) -> TabularReport<'static> {
    let numbers = |ids: &[u16]| {
        let ids: Vec<String> = ids.iter().map(u16::to_string).collect();
        ids.join(" ")
    };
    let source = |asked: &AskedQuery| match asked.source {
        QuerySource::Generated => "generated".to_owned(),
        QuerySource::File => "file".to_owned(),
    };
    TabularReport {
        title: "Queries in words",
        tables: vec![ReportTable::of(
            "Queries",
            document.queries.iter().filter(|asked| is_wanted(asked)),
            &[
                ("scene", &|asked| asked.scene.to_string()),
                ("source", &|asked| source(asked)),
                ("words", &|asked| asked.words.clone()),
                ("objects meant", &|asked| numbers(&asked.expected)),
                ("objects found", &|asked| numbers(&asked.found)),
                ("not understood", &|asked| asked.not_understood.join(", ")),
                ("answer", &|asked| asked.sentence.clone()),
            ],
        )],
        notes: notes(document),
        figures: document.scenes.iter().enumerate().map(picture).collect(),
        ..TabularReport::default()
    }
}

fn picture((index, scene): (usize, &SceneReport)) -> PageFigure {
    let object = |object: &SceneObjectReport| {
        let colors: Vec<&str> = object.colors.iter().map(|(color, _)| *color).collect();
        let gone = if object.is_gone { ", gone" } else { "" };
        let colors = colors.join(", ");
        format!("{} {} ({colors}{gone})", object.id, object.category)
    };
    let objects: Vec<String> = scene.objects.iter().map(object).collect();
    figure(
        &scene.picture,
        format!("scene {}: {}", index + 1, objects.join("; ")),
    )
}

/// Notes, one sentence each.
fn notes(document: &FindReport) -> Vec<String> {
    let counts = |name: &str, counts: &QueryCounts| {
        let QueryCounts {
            n_asked,
            n_right,
            n_wrong_without_doubt,
        } = counts;
        format!(
            "{n_right} of {n_asked} {name} queries right, {:.1} %; a wrong object without a stated \
             doubt in {n_wrong_without_doubt}",
            100.0 * *n_right as f64 / (*n_asked).max(1) as f64
        )
    };
    let wordnet = if document.has_wordnet {
        "with"
    } else {
        "without"
    };
    let mut notes = vec![
        format!(
            "{} scenes, seed {}, {wordnet} WordNet",
            document.n_scenes, document.seed
        ),
        counts("generated", &document.generated),
    ];
    if document.from_file.n_asked > 0 {
        notes.push(counts("hand-written", &document.from_file));
    }
    if let (Some(p50), Some(p99), Some(max)) = (document.p50_ms, document.p99_ms, document.max_ms) {
        notes.push(format!(
            "a query takes {p50:.2} ms (median), {p99:.2} ms (99th percentile), {max:.2} ms at most"
        ));
    }
    notes
}
