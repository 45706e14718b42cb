//! Guest of a running daemon that follows its scenes: prints the monotonic time in seconds of each
//! scene in which at least so many objects are tracked and recognised.
//!
//!     good_scenes MIN_OBJECTS

use channel::topic::Scene;
use channel::{Domain, DomainName, Role, RunFolder, Subscriber};
use message::{SceneObject, TrackState};
use std::io::Write;
use std::time::Duration;

/// Polling period.
const PERIOD: Duration = Duration::from_millis(5);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let min_objects: usize = std::env::args().nth(1).unwrap_or_default().parse()?;
    let domain = Domain::join(&DomainName::default(), &RunFolder::of_user(), Role::Guest)?;
    let mut subscriber = Subscriber::<Scene>::polled(&domain)?;
    let mut out = std::io::stdout().lock();
    loop {
        if let Ok(Some(scene)) = subscriber.latest()
            && scene
                .items()
                .iter()
                .filter(|object| is_recognised(object))
                .count()
                >= min_objects
        {
            let now = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
            writeln!(out, "{}.{:09}", now.tv_sec, now.tv_nsec)?;
        }
        std::thread::sleep(PERIOD);
    }
}

fn is_recognised(object: &SceneObject) -> bool {
    object.state == TrackState::Tracked.code()
        && object.label().is_some_and(|label| !label.is_empty())
}
