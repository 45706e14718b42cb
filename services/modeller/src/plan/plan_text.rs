//! Plan of the next best view as text for people.

use super::picture;
use super::plan_document::{HypothesisDocument, PlanDocument, ViewDocument};
use command_line::format_table;

/// Number of views in the table.
const N_SHOWN: usize = 5;

/// Text of a plan; with colours of the objects where there is a picture.
pub(crate) fn text(document: &PlanDocument, has_picture: bool) -> String {
    let mut parts = vec![headline(document), document.motion.clone()];
    parts.extend(document.notes.iter().map(|note| format!("note: {note}")));
    parts.push(String::new());
    parts.push(views_table(document));
    if !document.hypotheses.is_empty() {
        parts.push(String::new());
        parts.push(hypotheses_table(&document.hypotheses, has_picture));
    }
    let with_notes = document.hypotheses.iter().filter(|h| !h.note.is_empty());
    parts.extend(with_notes.map(|h| format!("object {}: {}", h.track_id, h.note)));
    parts.join("\n")
}

fn headline(document: &PlanDocument) -> String {
    let (chosen, present) = (&document.chosen, &document.present);
    let n_objects = document.hypotheses.len();
    let because = match document.reason {
        "information-gain" => "; chosen for the unknown space, since no view shows an object",
        "distance" => "; chosen for its distance, since no view shows anything new",
        _ => "",
    };
    format!(
        "next best view: {}, {:.2} m and {:.0}° from here; entropy {:.2} bit (now {:.2}), {:.0} % \
         of the unknown space, {} of {n_objects} objects seen (now {}){because}",
        place(chosen),
        chosen.distance_m,
        chosen.angle_deg,
        chosen.entropy,
        present.entropy,
        100.0 * chosen.gain,
        chosen.n_objects_seen,
        present.n_objects_seen
    )
}

fn place(view: &ViewDocument) -> String {
    let [x, y, z] = view.position_m;
    let way = if view.down_deg < 0.0 { "up" } else { "down" };
    format!(
        "{x:.3} {y:.3} {z:.3} m, looking {way} at {:.0}°",
        view.down_deg.abs()
    )
}

fn views_table(document: &PlanDocument) -> String {
    let mut best: Vec<&ViewDocument> = document.views.iter().filter(|v| v.rank.is_some()).collect();
    best.sort_by_key(|view| view.rank);
    let chosen = document.chosen.index;
    let shown = best.iter().enumerate();
    let shown = shown.filter(|(place, view)| *place < N_SHOWN || view.index == chosen);
    let row = |view: &ViewDocument| {
        let [x, y, z] = view.position_m;
        vec![
            view.rank.map_or("-".into(), |rank| rank.to_string()),
            view.index.map_or("now".into(), |index| index.to_string()),
            format!("{x:.3} {y:.3} {z:.3}"),
            format!("{:.2}", view.distance_m),
            format!("{:.2}", view.entropy),
            format!("{:.1}", 100.0 * view.gain),
            format!("{:.2}", view.weight),
            format!("{:.2}", view.utility),
            view.n_objects_seen.to_string(),
            if view.index.is_some() && view.index == chosen {
                "chosen"
            } else {
                ""
            }
            .into(),
        ]
    };
    let mut rows: Vec<_> = shown.map(|(_, view)| row(view)).collect();
    rows.push(row(&document.present));
    let heading = [
        "rank",
        "view",
        "position m",
        "way m",
        "entropy bit",
        "new space %",
        "weight",
        "utility",
        "objects seen",
        "",
    ];
    let n_others = document.views.len() - best.len();
    let table = format_table(&heading, &rows);
    if n_others == 0 {
        return table;
    }
    let states = ["visited", "blocked", "below-table"].map(|state| {
        let n = document.views.iter().filter(|v| v.state == state).count();
        (n, state)
    });
    let states = states.iter().filter(|(n, _)| *n > 0);
    let states: Vec<String> = states.map(|(n, state)| format!("{n} {state}")).collect();
    format!(
        "{table}\n{n_others} of {} views are left out: {}",
        document.views.len(),
        states.join(", ")
    )
}

fn hypotheses_table(hypotheses: &[HypothesisDocument], has_picture: bool) -> String {
    let row = |(index, hypothesis): (usize, &HypothesisDocument)| {
        let fit = hypothesis.contradiction;
        let mut cells = vec![
            hypothesis.track_id.to_string(),
            hypothesis.answer.shown(hypothesis.label.as_deref()),
            match hypothesis.source {
                "model" => "stored model".into(),
                _ => "measured points".into(),
            },
            fit.map_or("-".into(), |fit| format!("{fit:.2}")),
            format!("{:.0} %", 100.0 * hypothesis.visible_now),
            format!("{:.0} %", 100.0 * hypothesis.visible_then),
        ];
        if has_picture {
            cells.push(picture::color_name(index).into());
        }
        cells
    };
    let rows: Vec<_> = hypotheses.iter().enumerate().map(row).collect();
    let heading = [
        "id",
        "label",
        "hypothesis",
        "contradiction",
        "visible now",
        "then",
        "colour",
    ];
    format_table(&heading[..if has_picture { 7 } else { 6 }], &rows)
}
