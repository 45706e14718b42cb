//! Looking at what is stored, without the content.

use std::ops::Bound;

use geometry::OrientedBox;
use learning::ViewId;

use crate::catalogue::Entry;
use crate::digest::Digest;
use crate::error::Error;
use crate::facts::Facts;
use crate::keys;
use crate::mutation::Target;
use crate::perceptual_memory::PerceptualMemory;
use crate::reading::read_record;
use crate::standing::{Decided, Standing};
use crate::view::Origin;

/// A stored view without its descriptor and cloud.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewSummary {
    /// Its id.
    pub view: ViewId,
    /// Digest of everything in it: the same on every robot.
    pub identity: Digest,
    /// Where it was first stored.
    pub origin: Origin,
    /// What it stands for.
    pub standing: Standing,
    /// Who decided that; nobody yet when it was never named.
    pub decided: Option<Decided>,
    /// Sequence of the history entry that touched it last.
    pub sequence: u64,
    /// The object's box in the world frame, metres.
    pub box_in_world: OrientedBox,
    /// When it was captured, nanoseconds since 1970, UTC.
    pub captured_ns: u64,
    /// Number of the frame it was seen in.
    pub frame_sequence: u64,
    /// Name of the camera or recording.
    pub source: String,
    /// How its descriptor was made.
    pub descriptor_kind: String,
    /// Mean colour: red, green, blue.
    pub mean_rgb: Option<[u8; 3]>,
    /// Bytes of its descriptor.
    pub n_descriptor_bytes: u64,
    /// Bytes of its cloud; zero without one.
    pub n_cloud_bytes: u64,
}

impl PerceptualMemory {
    /// Up to `max` views behind `after`, in order: all, or those meant. Forgotten ones
    /// are left out.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] or [`Error::Failed`].
    pub fn views(
        &mut self,
        of: Option<&Target>,
        after: Option<ViewId>,
        max: usize,
    ) -> Result<Vec<ViewSummary>, Error> {
        let from = after.map_or(Bound::Unbounded, Bound::Excluded);
        let is_meant = |view: ViewId, entry: &Entry| match of {
            None => true,
            Some(Target::View(meant)) => view == *meant,
            Some(Target::Track(track_id)) => view.track_id == *track_id,
            Some(Target::Category(name)) => entry.register.standing.category() == Some(name),
        };
        let views: Vec<(ViewId, Entry)> = self
            .catalogue
            .range(from)
            .filter(|(_, entry)| entry.register.standing != Standing::Forgotten)
            .filter(|(view, entry)| is_meant(*view, entry))
            .take(max)
            .map(|(view, entry)| (view, entry.clone()))
            .collect();
        self.read(|reader| {
            let summary = |(view, entry): (ViewId, Entry)| {
                let facts: Facts = read_record(reader, &keys::view_key(keys::VIEW, view))?;
                Ok(summary(view, entry, facts))
            };
            views.into_iter().map(summary).collect()
        })
    }
}

fn summary(view: ViewId, entry: Entry, facts: Facts) -> ViewSummary {
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
        box_in_world: facts.box_in_world(),
        captured_ns: facts.captured_ns,
        frame_sequence: facts.frame_sequence,
        source: facts.source,
        descriptor_kind: facts.descriptor_kind,
        mean_rgb: facts.mean_rgb,
    }
}
