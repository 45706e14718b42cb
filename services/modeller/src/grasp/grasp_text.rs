//! Grasp plan as text for people.

use super::grasp_document::{GraspDocument, PlannedGrasp};
use crate::transit_document::path_words;
use command_line::format_table;

/// Number of grasps and of reasons in the tables.
const N_SHOWN: usize = 5;

/// Text of a plan.
pub(crate) fn text(document: &GraspDocument) -> String {
    let mut parts = vec![headline(document)];
    if let Some(path) = &document.path {
        parts.push(format!("way to it: {}", path_words(path)));
    }
    parts.extend(document.notes.iter().map(|note| format!("note: {note}")));
    if !document.grasps.is_empty() {
        parts.push(String::new());
        parts.push(grasps_table(&document.grasps));
    }
    if !document.reasons.is_empty() {
        parts.push(String::new());
        parts.push(reasons_table(document));
    }
    parts.join("\n")
}

fn headline(document: &GraspDocument) -> String {
    let Some(best) = document.grasps.first() else {
        return document.sentence.clone().unwrap_or_default();
    };
    let weakest = best.factors.iter().min_by(|a, b| a.1.total_cmp(b.1));
    let weakest = weakest.map_or_else(String::new, |(name, value)| {
        format!("; its weakest point is {name} ({value:.2})")
    });
    let [x, y, z] = best.position_m;
    format!(
        "best grasp of object {}: {} at {x:.3} {y:.3} {z:.3} m, fingers open {:.0} mm and close to \
         {:.0} mm; score {:.2}{weakest}",
        document.track_id, best.approach, best.opening_mm, best.width_mm, best.score
    )
}

fn grasps_table(grasps: &[PlannedGrasp]) -> String {
    let header = [
        "score",
        "approach",
        "x",
        "y",
        "z (m)",
        "open (mm)",
        "width (mm)",
        "evidence",
    ];
    let rows = grasps.iter().take(N_SHOWN).map(|grasp| {
        let [x, y, z] = grasp.position_m;
        vec![
            format!("{:.2}", grasp.score),
            grasp.approach.to_owned(),
            format!("{x:.3}"),
            format!("{y:.3}"),
            format!("{z:.3}"),
            format!("{:.0}", grasp.opening_mm),
            format!("{:.0}", grasp.width_mm),
            grasp.evidence.to_owned(),
        ]
    });
    format_table(&header, &rows.collect::<Vec<_>>())
}

fn reasons_table(document: &GraspDocument) -> String {
    let rows = document.reasons.iter().take(N_SHOWN);
    let rows = rows.map(|one| vec![one.n_grasps.to_string(), one.reason.clone()]);
    format_table(&["rejected", "because"], &rows.collect::<Vec<_>>())
}
