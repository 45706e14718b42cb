//! Conversion between the types of the control protocol and of the store.

use control_protocol::DescriptorBytes;
use control_protocol::{
    ChangesPage, LearnedChange, LearnedView, PackedCloud, Refusal, RefusalKind, SnapshotCursor,
    SnapshotPage, StoredView, ViewId as WireViewId,
};
use geometry::OrientedBox;
use learning::{CategoryName, TeachingError as TeachingRefusal, ViewId};
use message::WirePose;
use nalgebra::Vector3;
use perceptual_memory::{
    CapturedView, Changes, Error, LabelledView, NameChange, StoreChange, StoredDescriptor,
};
use scene_document::CategoryDocument;

/// Validated category name.
pub(crate) fn category(name: &str) -> Result<CategoryName, Refusal> {
    CategoryName::new(name).map_err(|error| Refusal::new(RefusalKind::Invalid, error.to_string()))
}

/// Store change for a batch of key views.
pub(crate) fn store_views(views: Vec<StoredView>) -> Result<StoreChange, Refusal> {
    views
        .into_iter()
        .map(view)
        .collect::<Result<_, _>>()
        .map(StoreChange::StoreViews)
}

fn view(view: StoredView) -> Result<CapturedView, Refusal> {
    let refused = |rule: &str| {
        let WireViewId { track_id, view_id } = view.id;
        let sentence = format!("view {view_id} of track {track_id} cannot be stored: {rule}");
        Refusal::new(RefusalKind::Invalid, sentence)
    };
    let pose = WirePose {
        position_m: view.position_m,
        orientation_xyzw: view.orientation_xyzw,
    };
    let frame_from_box = pose
        .checked()
        .ok_or_else(|| refused("its pose is not a pose"))?;
    let values = view
        .descriptor
        .decode()
        .map_err(|error| refused(&error.to_string()))?;
    let points = Some(view.points).filter(|points| !points.is_empty());
    if let Some(Err(error)) = points.as_deref().map(PackedCloud::checked) {
        return Err(refused(&error.to_string()));
    }
    Ok(CapturedView {
        id: local_id(view.id),
        descriptor: StoredDescriptor {
            kind: view.descriptor_kind,
            values,
        },
        box_in_world: OrientedBox {
            frame_from_box,
            half_sides_m: Vector3::from(view.size_m) / 2.0,
        },
        captured_ns: view.captured_ns.max(0) as u64,
        frame_sequence: view.frame_sequence,
        source: view.source_name,
        mean_rgb: view.mean_rgb,
        points,
    })
}

fn learned(view: LabelledView) -> LearnedView {
    LearnedView {
        id: view_id(view.view),
        category: view.category.as_str().to_owned(),
        descriptor_kind: view.descriptor.kind,
        descriptor: DescriptorBytes::encode(&view.descriptor.values),
    }
}

/// Store id of a view.
pub(crate) fn local_id(id: WireViewId) -> ViewId {
    ViewId {
        track_id: id.track_id,
        view_id: id.view_id,
    }
}

/// Wire id of a view.
pub(crate) fn view_id(id: ViewId) -> WireViewId {
    WireViewId {
        track_id: id.track_id,
        view_id: id.view_id,
    }
}

/// Wire page of labelled views.
pub(crate) fn snapshot(page: perceptual_memory::SnapshotPage) -> SnapshotPage {
    SnapshotPage {
        store_id: page.position.store_id.0,
        sequence: page.position.sequence,
        views: page.views.into_iter().map(learned).collect(),
        next: page.next.map(|digest| SnapshotCursor(digest.0)),
    }
}

/// Wire page of label changes since `since`. If the changes of one entry exceed a message, the
/// reader has to load a new snapshot.
pub(crate) fn changes(since: u64, changes: Changes, max_bytes: usize) -> ChangesPage {
    let Changes::Entries {
        entries,
        last_sequence,
    } = changes
    else {
        return ChangesPage::Reload;
    };
    let bytes = |change: &NameChange| match change {
        NameChange::Assigned(view) => size_of_val(view.descriptor.values.as_slice()),
        NameChange::Unassigned(_) => size_of::<ViewId>(),
    };
    let changed = entries.iter().flat_map(|entry| &entry.names);
    if changed.map(bytes).sum::<usize>() > max_bytes {
        return ChangesPage::Reload;
    }
    let up_to = entries.last().map_or(since, |entry| entry.sequence);
    let change = |change| match change {
        NameChange::Assigned(view) => LearnedChange::Assigned(learned(view)),
        NameChange::Unassigned(key) => LearnedChange::Unassigned(view_id(key)),
    };
    let changes = entries
        .into_iter()
        .flat_map(|entry| entry.names)
        .map(change)
        .collect();
    ChangesPage::Changes {
        up_to,
        changes,
        more: up_to < last_sequence,
    }
}

/// Wire statistics of a category.
pub(crate) fn category_report(summary: &perceptual_memory::CategorySummary) -> CategoryDocument {
    CategoryDocument {
        category: summary.name.as_str().to_owned(),
        n_views: summary.n_views,
        bytes: summary.n_bytes,
        last_taught_ns: summary.last_taught_ns as i64,
    }
}

/// Wire refusal for a refusal or failure of the store.
pub(crate) fn refusal(error: &Error) -> Refusal {
    use perceptual_memory::StoreRefusal;
    let kind = match error {
        Error::Refused(
            StoreRefusal::Teaching(TeachingRefusal::LabelConflict { .. })
            | StoreRefusal::ViewDiffers { .. }
            | StoreRefusal::NameTaken { .. }
            | StoreRefusal::NameAlike { .. }
            | StoreRefusal::UndoneAlready { .. }
            | StoreRefusal::ChangedSince { .. }
            | StoreRefusal::GoneForGood { .. },
        ) => RefusalKind::Conflict,
        Error::Refused(
            StoreRefusal::Teaching(_)
            | StoreRefusal::UnknownView { .. }
            | StoreRefusal::UnknownDocument { .. }
            | StoreRefusal::UnknownEntry { .. }
            | StoreRefusal::NothingToUndo
            | StoreRefusal::NothingToRedo,
        ) => RefusalKind::NotFound,
        Error::Refused(StoreRefusal::OthersEntry { .. }) => RefusalKind::Forbidden,
        Error::Refused(_) => RefusalKind::Invalid,
        Error::QueueFull { .. }
        | Error::Failed { .. }
        | Error::ReadOnly { .. }
        | Error::Stopped => RefusalKind::Unavailable,
        _ => RefusalKind::Internal,
    };
    Refusal::new(kind, error.to_string())
}

/// Wire refusal for a refusal or failure of a change. A write that has failed may be on disk or
/// not.
pub(crate) fn change_refusal(error: &Error) -> Refusal {
    if !matches!(error, Error::Storage(_)) {
        return refusal(error);
    }
    let sentence = format!(
        "it is not known if the change was made ({error}); send it again with the same id until \
         it is answered"
    );
    Refusal::new(RefusalKind::UnknownOutcome, sentence)
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_protocol::pack_cloud;
    use geometry::RigidTransform;
    use point_cloud::Point;

    #[test]
    fn failed_write_of_a_change_has_an_unknown_outcome_and_a_failed_read_has_not() {
        let synced = perceptual_memory::StorageError::io("syncing", "database/000003.log");
        let error = Error::Storage(synced(std::io::Error::other("Input/output error")));
        let change = change_refusal(&error);
        assert_eq!(change.kind, RefusalKind::UnknownOutcome);
        assert!(change.sentence.contains("000003.log"), "{change}");
        assert!(change.sentence.contains("same id"), "{change}");
        assert_eq!(refusal(&error).kind, RefusalKind::Internal);
        let full = Error::QueueFull { capacity: 4 };
        assert_eq!(change_refusal(&full).kind, RefusalKind::Unavailable);
    }

    fn sent() -> StoredView {
        StoredView {
            id: WireViewId {
                track_id: 7,
                view_id: 2,
            },
            descriptor_kind: "good".into(),
            descriptor: DescriptorBytes::encode(&[1.0, 0.25]),
            position_m: [0.1, 0.2, 0.3],
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            size_m: [0.1, 0.1, 0.2],
            captured_ns: 5,
            frame_sequence: 9,
            source_name: "test".into(),
            points: Vec::new(),
            mean_rgb: None,
        }
    }

    #[test]
    fn view_values_are_kept() {
        let view = view(sent()).unwrap();
        assert_eq!(view.descriptor.values, [1.0, 0.25]);
        assert!((view.box_in_world.half_sides_m.z - 0.1).abs() < 1e-12);
        assert_eq!(view.points, None);
    }

    #[test]
    fn view_points_are_kept() {
        let point = Point {
            z: 1.0,
            ..Point::default()
        };
        let points = pack_cloud([point].iter(), &RigidTransform::identity());
        let sent = StoredView {
            points: points.clone(),
            ..sent()
        };
        assert_eq!(view(sent).unwrap().points, Some(points));
    }

    #[test]
    fn invalid_view_is_refused_with_its_id() {
        for wrong in [
            StoredView {
                descriptor: vec![1, 2, 3].into(),
                ..sent()
            },
            StoredView {
                orientation_xyzw: [0.0; 4],
                ..sent()
            },
            StoredView {
                position_m: [f64::NAN; 3],
                ..sent()
            },
            StoredView {
                points: vec![1, 2, 3],
                ..sent()
            },
        ] {
            let refusal = view(wrong).unwrap_err();
            assert!(refusal.sentence.contains("track 7"), "{refusal}");
        }
    }

    #[test]
    fn invalid_labels_are_refused() {
        for wrong in ["", "  ", "mu\u{7}g", &"x".repeat(300)] {
            assert_eq!(category(wrong).unwrap_err().kind, RefusalKind::Invalid);
        }
        assert!(category("coffee mug").is_ok());
    }
}
