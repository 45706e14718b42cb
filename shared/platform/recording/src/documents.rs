//! Documents of the recorded topics. Stamps are nanoseconds on the clock of the message that
//! they come from: the monotonic clock, or in lockstep the source's own.

mod actor_event;
mod bodies;
mod health;
mod memory_change;
mod object_view;
mod scene;

pub use actor_event::ActorEventDocument;
pub use bodies::{ArmDocument, CapsuleDocument, PersonDocument};
pub use health::HealthDocument;
pub use memory_change::MemoryChangeDocument;
pub use object_view::ObjectViewDocument;
pub use scene::{CategoryDocument, ObjectDocument, RejectedDocument, SceneDocument};

use message::{Text, WirePose};

/// Position and orientation of a pose in one array: x, y, z in metres, then the quaternion x, y,
/// z, w.
fn pose(pose: &WirePose) -> [f64; 7] {
    let ([x, y, z], [qx, qy, qz, qw]) = (pose.position_m, pose.orientation_xyzw);
    [x, y, z, qx, qy, qz, qw]
}

fn text(text: &Text) -> String {
    text.as_str().unwrap_or_default().to_owned()
}

/// Session as text: it has more digits than many readers of JSON keep.
fn session(session: u64) -> String {
    session.to_string()
}
