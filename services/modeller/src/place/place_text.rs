//! Plan of a transport as text for people.

use super::place_document::PlaceDocument;
use crate::transit_document::path_words;

/// Text of a plan.
pub(super) fn text(document: &PlaceDocument) -> String {
    let mut lines = Vec::new();
    match &document.transport {
        None => lines.push(document.sentence.clone().unwrap_or_default()),
        Some(transport) => {
            let place = &transport.placement;
            let [x, y, z] = place.foot_m;
            lines.push(format!(
                "object {} to {}: it stands on {} at {x:.3} {y:.3} {z:.3} m, turned by {:.0}°",
                document.track_id, document.place, place.surface, place.turn_deg
            ));
            lines.push(format!("to the grasp: {}", path_words(&transport.to_grasp)));
            lines.push(format!(
                "grasp {}, fingers open {:.0} mm and close to {:.0} mm; score {:.2}",
                transport.grasp.approach,
                transport.grasp.opening_mm,
                transport.grasp.width_mm,
                transport.grasp.score
            ));
            lines.push(format!("to the place: {}", path_words(&transport.to_place)));
        }
    }
    lines.extend(document.notes.iter().map(|note| format!("note: {note}")));
    lines.join("\n")
}
