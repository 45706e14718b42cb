//! Text and HTML page of the tracking evaluation.

use super::report::{Figures, SeedFigures, TrackingReport};
use command_line::format_table;
use plot::figure_page::{PageFigure, PageTable, html};
use statistics::spread::Spread;

/// Column headings of the tracking table.
const HEADS: [&str; 17] = [
    "scene", "runs", "mota", "idf1", "switches", "misses", "false", "centre", "p95", "p99",
    "at 1 m", "turn", "p95", "flips", "lost", "ids", "person",
];

/// Tracking report as text for the terminal.
pub(super) fn text(document: &TrackingReport) -> String {
    let mut lines = vec![format_table(&HEADS, &rows(document)), String::new()];
    lines.extend(legend());
    lines.extend([document.files.page.clone(), document.files.file.clone()]);
    lines.join("\n")
}

/// HTML page with the figure of each run, worst first within a scene.
pub(super) fn page(document: &TrackingReport) -> String {
    let table = PageTable::new("Scenes", &HEADS, rows(document));
    let mut notes = vec![
        "Left the table from above: true ways are grey, each track has a colour and stands with \
         its id where it begins. Right the tracks that were matched with each object; light grey \
         is where an object does not count."
            .to_owned(),
    ];
    notes.extend(legend());
    let runs = document.scenes.iter().flat_map(|(name, scene)| {
        let mut runs: Vec<&SeedFigures> = scene.per_seed.iter().collect();
        runs.sort_by(|a, b| rank(a).total_cmp(&rank(b)));
        runs.into_iter().map(|run| pictured(name, run))
    });
    html("Tracking", &notes, &[table], &runs.collect::<Vec<_>>())
}

/// Sort key of a run; lower is worse.
fn rank(run: &SeedFigures) -> f64 {
    let accuracy = run.figures.mota.unwrap_or(1.0) + run.figures.idf1.unwrap_or(1.0);
    accuracy - run.figures.id_switches as f64
}

fn pictured(name: &str, run: &SeedFigures) -> PageFigure {
    let figures = &run.figures;
    let seed = run
        .seed
        .map_or(String::new(), |seed| format!(", seed {seed}"));
    let share = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
    PageFigure {
        caption: format!(
            "{name}{seed}: MOTA {}, IDF1 {}, {} switches, {} misses, {} false positives, {} lost",
            share(figures.mota),
            share(figures.idf1),
            figures.id_switches,
            figures.misses,
            figures.false_positives,
            figures.n_lost
        ),
        picture: run.picture.clone(),
    }
}

fn rows(document: &TrackingReport) -> Vec<Vec<String>> {
    let mut rows = vec![row("all", &document.overall)];
    let scenes = document.scenes.iter();
    rows.extend(scenes.map(|(name, scene)| row(name, &scene.figures)));
    rows
}

/// Legend of the tracking table's columns.
fn legend() -> [String; 2] {
    [
        "centre: median, 95th and 99th percentile of the distance from the centre of the box of \
         the true surface seen so far, mm; at 1 m: its median there"
            .to_owned(),
        "turn: median and 95th percentile of the deviation of objects whose footprint has a \
         direction, degrees; ids: tracks of an object; person: frames with a track made of a person"
            .to_owned(),
    ]
}

fn row(name: &str, figures: &Figures) -> Vec<String> {
    let share = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.4}"));
    let of = |spread: &Option<Spread>, value: fn(&Spread) -> f64| {
        let value = spread.as_ref().map(value);
        value.map_or("-".to_owned(), |value| format!("{value:.1}"))
    };
    let Figures {
        centre_error_mm: centre,
        centre_error_at_1_m_mm: near,
        angular_orientation_error_deg: turn,
        ..
    } = figures;
    vec![
        name.to_owned(),
        figures.n_runs.to_string(),
        share(figures.mota),
        share(figures.idf1),
        figures.id_switches.to_string(),
        figures.misses.to_string(),
        figures.false_positives.to_string(),
        of(centre, |p| p.median),
        of(centre, |p| p.p95),
        of(centre, |p| p.p99),
        of(near, |p| p.median),
        of(turn, |p| p.median),
        of(turn, |p| p.p95),
        figures.flips.to_string(),
        share(figures.lost),
        figures
            .ids_per_object
            .map_or("-".to_owned(), |ids| format!("{ids:.2}")),
        figures.frames_with_person_track.to_string(),
    ]
}
