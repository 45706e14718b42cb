//! Text and HTML page of queries in words.

use super::report::{AskedQuery, FindReport, QueryCounts, QuerySource, SceneReport};
use command_line::format_table;
use plot::figure_page::{PageFigure, PageTable, html};

/// Column headings of the table of queries.
const HEADS: [&str; 6] = [
    "scene",
    "source",
    "words",
    "objects meant",
    "objects found",
    "answer",
];

/// Report as text for the terminal: the wrong answers and the figures.
pub(super) fn text(document: &FindReport) -> String {
    let wrong: Vec<_> = document
        .queries
        .iter()
        .filter(|asked| !asked.is_right)
        .collect();
    let mut lines = Vec::new();
    if !wrong.is_empty() {
        let rows: Vec<_> = wrong.into_iter().map(row).collect();
        lines.extend([format_table(&HEADS, &rows), String::new()]);
    }
    lines.extend(notes(document));
    lines.join("\n")
}

/// HTML page with the pictures of the scenes and all queries.
pub(super) fn page(document: &FindReport) -> String {
    let table = PageTable::new(
        "Queries",
        &HEADS,
        document.queries.iter().map(row).collect(),
    );
    let figures: Vec<PageFigure> = document.scenes.iter().enumerate().map(figure).collect();
    html("Queries in words", &notes(document), &[table], &figures)
}

fn figure((index, scene): (usize, &SceneReport)) -> PageFigure {
    let object = |object: &super::report::SceneObjectReport| {
        let colors: Vec<&str> = object.colors.iter().map(|(color, _)| *color).collect();
        format!("{} {} ({})", object.id, object.category, colors.join(", "))
    };
    let objects: Vec<String> = scene.objects.iter().map(object).collect();
    PageFigure {
        caption: format!("scene {}: {}", index + 1, objects.join("; ")),
        picture: scene.picture.clone(),
    }
}

fn row(asked: &AskedQuery) -> Vec<String> {
    let numbers = |ids: &[u16]| {
        let ids: Vec<String> = ids.iter().map(u16::to_string).collect();
        ids.join(" ")
    };
    let source = match asked.source {
        QuerySource::Generated => "generated",
        QuerySource::File => "file",
    };
    vec![
        asked.scene.to_string(),
        source.to_owned(),
        asked.words.clone(),
        numbers(&asked.expected),
        numbers(&asked.found),
        asked.sentence.clone(),
    ]
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
