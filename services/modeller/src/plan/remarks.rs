//! Remarks for people on what a plan leaves out.

use message::TrackState;
use scene_client::{HypothesisSource, ObjectHypothesis, Snapshot};

/// Remarks on objects without hypotheses, and on hypotheses without models.
pub(crate) fn remarks(snapshot: &Snapshot, hypotheses: &[ObjectHypothesis]) -> Vec<String> {
    let mut notes = Vec::new();
    if hypotheses.is_empty() {
        notes.push(
            "no object is seen: the views are rated by the unknown space around the middle of the \
             image alone"
                .to_owned(),
        );
    }
    let without: Vec<_> = snapshot
        .objects
        .iter()
        .filter(|o| o.points.is_empty())
        .collect();
    let ids = |is_seen: bool| {
        let of_kind = without
            .iter()
            .filter(|o| (o.state == TrackState::Tracked) == is_seen);
        let ids: Vec<String> = of_kind.map(|object| object.track.to_string()).collect();
        ids.join(", ")
    };
    let (lost, unseen) = (ids(true), ids(false));
    if !unseen.is_empty() {
        notes.push(format!("not seen now, and not planned for: {unseen}"));
    }
    if !lost.is_empty() {
        notes.push(format!(
            "the points of these objects did not come, so that they count as background: {lost}"
        ));
    }
    let is_measured = |h: &ObjectHypothesis| h.source == HypothesisSource::Measured;
    let has_no_model = |h: &ObjectHypothesis| is_measured(h) && h.note.is_empty();
    if !hypotheses.is_empty() && hypotheses.iter().all(has_no_model) {
        notes.push(without_models(hypotheses));
    }
    notes
}

/// Remark on seen objects of which none has a stored model.
fn without_models(hypotheses: &[ObjectHypothesis]) -> String {
    let mut labels: Vec<&str> = hypotheses
        .iter()
        .filter_map(|h| h.label.as_deref())
        .collect();
    labels.sort_unstable();
    labels.dedup();
    if labels.is_empty() {
        return "no seen object has a label, under which a model could be stored: only the measured \
                sides are known; `tabula teach TRACK NAME` gives a label, and `tabula model build \
                TRACK` makes the model"
            .to_owned();
    }
    format!(
        "no model is stored of what is seen ({}): only the measured sides are known; `tabula model \
         build TRACK` makes models",
        labels.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{PinholeCamera, RigidTransform};
    use nalgebra::Point3;
    use next_best_view::SurfaceModel;
    use scene_client::SnapshotObject;
    use std::rc::Rc;

    fn object(track: u64, state: TrackState, points: Vec<[f32; 3]>) -> SnapshotObject {
        SnapshotObject {
            track,
            label: None,
            categories: Vec::new(),
            state,
            middle_in_world: Point3::origin(),
            points,
        }
    }

    fn snapshot(objects: Vec<SnapshotObject>) -> Snapshot {
        Snapshot {
            objects,
            ..Snapshot::of_points(PinholeCamera::KINECT_V1, Vec::new())
        }
    }

    #[test]
    fn remarks_name_objects_that_are_not_planned_for() {
        let seen = object(1, TrackState::Tracked, vec![[0.0, 0.0, 1.0]]);
        let hidden = object(2, TrackState::Occluded, Vec::new());
        let lost = object(3, TrackState::Tracked, Vec::new());
        let surface = SurfaceModel::of_points(&[[0.0; 3]], 0.003).unwrap();
        let measured = ObjectHypothesis {
            track: 1,
            label: None,
            source: HypothesisSource::Measured,
            surface: Rc::new(surface),
            plan_from_object: RigidTransform::identity(),
            note: String::new(),
        };
        let all = snapshot(vec![seen, hidden, lost]);
        let notes = remarks(&all, std::slice::from_ref(&measured));
        assert_eq!(notes.len(), 3, "{notes:?}");
        assert_eq!(notes[0], "not seen now, and not planned for: 2");
        assert!(notes[1].ends_with("count as background: 3"), "{notes:?}");
        assert!(
            notes[2].starts_with("no seen object has a label"),
            "{notes:?}"
        );
        let labelled = ObjectHypothesis {
            label: Some("mug".to_owned()),
            ..measured.clone()
        };
        let of_both = remarks(&all, &[measured.clone(), labelled]);
        assert!(
            of_both[2].starts_with("no model is stored of what is seen (mug): "),
            "{of_both:?}"
        );
        let placed = ObjectHypothesis {
            source: HypothesisSource::Model {
                name: "mug".to_owned(),
                contradiction: 0.2,
            },
            ..measured
        };
        assert_eq!(remarks(&all, &[placed]).len(), 2);
        let none = remarks(&snapshot(Vec::new()), &[]);
        assert!(none[0].starts_with("no object is seen"), "{none:?}");
    }
}
