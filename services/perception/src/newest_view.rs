//! What the scene tells of an object's newest view beyond its track.

use crate::object_actor::Observed;
use message::ActorStamps;

/// The newest view, as the frame loop remembers it for the scene.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct NewestView {
    /// History sequence of the memory its label was made with.
    pub(crate) memory_sequence: u64,
    /// Whether it is of this frame, and key.
    pub(crate) is_key_view: bool,
    /// When it passed the actor.
    pub(crate) stamps: ActorStamps,
}

impl From<&Observed> for NewestView {
    fn from(observed: &Observed) -> Self {
        Self {
            memory_sequence: observed.memory_sequence,
            is_key_view: observed.posterior.is_key_view,
            stamps: observed.stamps,
        }
    }
}
