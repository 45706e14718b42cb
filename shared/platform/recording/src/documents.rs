//! Documents of the recorded topics other than scene and health, which are those of
//! `scene-document`. Stamps are nanoseconds on the clock of the message that
//! they come from: the monotonic clock, or in lockstep the source's own.

mod actor_event;
mod bodies;
mod memory_change;
mod object_view;

pub use actor_event::ActorEventDocument;
pub use bodies::{ArmDocument, CapsuleDocument, PersonDocument};
pub use memory_change::MemoryChangeDocument;
pub use object_view::ObjectViewDocument;

use message::Text;

fn text(text: &Text) -> String {
    text.as_str().unwrap_or_default().to_owned()
}
