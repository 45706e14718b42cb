//! Table and figures of the tracking evaluation.

use super::report::{Figures, SeedFigures, TrackingReport};
use crate::evaluate::tabular_report::{ReportTable, TabularReport, figure, number};
use plot::figure_page::PageFigure;
use statistics::spread::Spread;

/// Table, legend and the figure of each run, worst first within a scene.
pub(super) fn page(document: &TrackingReport) -> TabularReport<'static> {
    let runs = document.scenes.iter().flat_map(|(name, scene)| {
        let mut runs: Vec<&SeedFigures> = scene.per_seed.iter().collect();
        runs.sort_by(|a, b| rank(a).total_cmp(&rank(b)));
        runs.into_iter().map(|run| pictured(name, run))
    });
    TabularReport {
        title: "Tracking",
        tables: vec![scenes(document)],
        notes: legend().into(),
        figures: runs.collect(),
        figure_note: Some(
            "Left the table from above: true ways are grey, each track has a colour and stands \
             with its id where it begins. Right the tracks that were matched with each object; \
             light grey is where an object does not count.",
        ),
        files: document.files.paths(),
    }
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
    let caption = format!(
        "{name}{seed}: MOTA {}, IDF1 {}, {} switches, {} misses, {} false positives, {} lost",
        number(figures.mota, 3),
        number(figures.idf1, 3),
        figures.id_switches,
        figures.misses,
        figures.false_positives,
        figures.n_lost
    );
    figure(&run.picture, caption)
}

/// Legend of the tracking table's columns.
fn legend() -> [String; 3] {
    [
        "mota: 1 − (misses + false tracks + switches) / objects; idf1: F1 of identities; switches, \
         flips: jumps of an id, of a published orientation; lost: tracks lost by an object"
            .to_owned(),
        "centre: median, 95th and 99th percentile of the distance from the centre of the box of \
         the true surface seen so far, mm; at 1 m: its median there"
            .to_owned(),
        "turn: median and 95th percentile of the deviation of objects whose footprint has a \
         direction, degrees; ids: tracks of an object; parts, joined: tracks of parts of objects and \
         pairs of objects in one track, for more than half a second; person: frames with a track \
         made of a person"
            .to_owned(),
    ]
}

fn scenes(document: &TrackingReport) -> ReportTable {
    type Row<'r> = (&'r str, &'r Figures);
    let of =
        |spread: &Option<Spread>, value: fn(&Spread) -> f64| number(spread.as_ref().map(value), 1);
    let scenes = document.scenes.iter();
    let scenes = scenes.map(|(name, scene)| (name.as_str(), &scene.figures));
    ReportTable::of(
        "Scenes",
        std::iter::once(("all", &document.overall)).chain(scenes),
        &[
            ("scene", &|(name, _): &Row<'_>| (*name).to_owned()),
            ("runs", &|(_, f)| f.n_runs.to_string()),
            ("mota", &|(_, f)| number(f.mota, 4)),
            ("idf1", &|(_, f)| number(f.idf1, 4)),
            ("switches", &|(_, f)| f.id_switches.to_string()),
            ("misses", &|(_, f)| f.misses.to_string()),
            ("false", &|(_, f)| f.false_positives.to_string()),
            ("centre", &|(_, f)| of(&f.centre_error_mm, |p| p.median)),
            ("p95", &|(_, f)| of(&f.centre_error_mm, |p| p.p95)),
            ("p99", &|(_, f)| of(&f.centre_error_mm, |p| p.p99)),
            ("at 1 m", &|(_, f)| {
                of(&f.centre_error_at_1_m_mm, |p| p.median)
            }),
            ("turn", &|(_, f)| {
                of(&f.angular_orientation_error_deg, |p| p.median)
            }),
            ("p95", &|(_, f)| {
                of(&f.angular_orientation_error_deg, |p| p.p95)
            }),
            ("flips", &|(_, f)| f.flips.to_string()),
            ("lost", &|(_, f)| number(f.lost, 4)),
            ("ids", &|(_, f)| number(f.ids_per_object, 2)),
            ("parts", &|(_, f)| f.part_tracks.to_string()),
            ("joined", &|(_, f)| f.joined_pairs.to_string()),
            ("person", &|(_, f)| f.frames_with_person_track.to_string()),
        ],
    )
}
