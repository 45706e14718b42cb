//! View summaries: metadata of stored views without descriptor and point cloud.

use std::ops::Bound;

use geometry::OrientedBox;
use learning::ViewId;

use crate::digest::Digest;
use crate::error::Error;
use crate::index_row::IndexedView;
use crate::keys;
use crate::label_status::{DecisionStamp, LabelStatus};
use crate::model::Target;
use crate::perceptual_memory::PerceptualMemory;
use crate::record_reader::read_record;
use crate::view::Origin;
use crate::view_record::ViewMetadata;

/// Stored view without its descriptor and point cloud.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewSummary {
    /// Id of the view in this store.
    pub view: ViewId,
    /// Content digest of the view, equal on every robot.
    pub identity: Digest,
    /// Provenance: memory and id under which the view was first stored.
    pub origin: Origin,
    /// Label status of the view.
    pub standing: LabelStatus,
    /// Author and time of the label status; `None` for a view that was never labelled.
    pub decided: Option<DecisionStamp>,
    /// Sequence number of the last history entry that touched the view.
    pub sequence: u64,
    /// Oriented bounding box of the object in the world frame, metres.
    pub box_in_world: OrientedBox,
    /// Capture time of the view, nanoseconds since 1970, UTC.
    pub captured_ns: u64,
    /// Sequence number of the camera frame.
    pub frame_sequence: u64,
    /// Name of the camera or recording.
    pub source: String,
    /// Kind of the descriptor.
    pub descriptor_kind: String,
    /// Mean colour of the object: red, green, blue.
    pub mean_rgb: Option<[u8; 3]>,
    /// Size of the descriptor, bytes.
    pub n_descriptor_bytes: u64,
    /// Size of the point cloud, bytes; zero without one.
    pub n_cloud_bytes: u64,
}

impl PerceptualMemory {
    /// Up to `max` view summaries after `after` in id order, of one target or of all. Forgotten
    /// views are left out.
    ///
    /// # Errors
    ///
    /// [`StorageError::Damaged`](crate::StorageError::Damaged) or [`Error::Failed`].
    pub fn views(
        &mut self,
        of: Option<&Target>,
        after: Option<ViewId>,
        max: usize,
    ) -> Result<Vec<ViewSummary>, Error> {
        let from = after.map_or(Bound::Unbounded, Bound::Excluded);
        let category = match of {
            Some(Target::Category(name)) => Some(self.index.stored_name(name)),
            _ => None,
        };
        let is_meant = |view: ViewId, entry: &IndexedView| match of {
            None => true,
            Some(Target::View(meant)) => view == *meant,
            Some(Target::Track(track_id)) => view.track_id == *track_id,
            Some(Target::Category(_)) => entry.register.standing.category() == category,
        };
        let views: Vec<(ViewId, IndexedView)> = self
            .index
            .range(from)
            .filter(|(_, entry)| entry.register.standing != LabelStatus::Forgotten)
            .filter(|(view, entry)| is_meant(*view, entry))
            .take(max)
            .map(|(view, entry)| (view, entry.clone()))
            .collect();
        self.read(|reader| {
            let summary = |(view, entry): (ViewId, IndexedView)| {
                let metadata: ViewMetadata =
                    read_record(reader, &keys::view_key(keys::VIEW, view))?;
                Ok(summary(view, entry, metadata))
            };
            views.into_iter().map(summary).collect()
        })
    }
}

fn summary(view: ViewId, entry: IndexedView, metadata: ViewMetadata) -> ViewSummary {
    let is_decided = entry.register.decided.stamp_ns > 0;
    let n_descriptor_bytes = entry.descriptor.n_bytes as u64;
    ViewSummary {
        view,
        identity: entry.identity,
        origin: entry.origin,
        n_cloud_bytes: entry.n_bytes() - n_descriptor_bytes,
        n_descriptor_bytes,
        standing: entry.register.standing,
        decided: is_decided.then_some(entry.register.decided),
        sequence: entry.register.sequence,
        box_in_world: metadata.box_in_world(),
        captured_ns: metadata.captured_ns,
        frame_sequence: metadata.frame_sequence,
        source: metadata.source,
        descriptor_kind: metadata.descriptor_kind,
        mean_rgb: metadata.mean_rgb,
    }
}
