//! Publishers of the recorded states of arm and people.

use channel::topic::{ArmStates, PersonBodies};
use channel::{Domain, Error, Publisher};
use message::{ArmState, PersonBody};
use recording::PlayedFrame;

/// Publishers of `arm/state` and `person/body` in the place of those that were recorded.
pub(super) struct RecordedBodies {
    arm: Publisher<ArmStates>,
    people: Publisher<PersonBodies>,
}

impl RecordedBodies {
    pub(super) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            arm: Publisher::new(domain)?,
            people: Publisher::new(domain)?,
        })
    }

    /// Publishes the states before a frame, moved to the clock on which the frame has this
    /// capture time: their distances to the capture are those of the recording.
    pub(super) fn publish(&mut self, frame: &PlayedFrame, capture_ns: u64) -> Result<(), Error> {
        let moved = |stamp_ns: u64| {
            let before_ns = frame.capture_ns().saturating_sub(stamp_ns);
            capture_ns.saturating_sub(before_ns)
        };
        for (state, capsules) in &frame.arm {
            let state = ArmState {
                stamp_ns: moved(state.stamp_ns),
                ..*state
            };
            let n_capsules = capsules.len().min(message::MAX_CAPSULES);
            self.arm.send_copy(state, &capsules[..n_capsules])?;
        }
        for (body, capsules) in &frame.people {
            let body = PersonBody {
                stamp_ns: moved(body.stamp_ns),
                ..*body
            };
            let n_capsules = capsules.len().min(message::MAX_CAPSULES);
            self.people.send_copy(body, &capsules[..n_capsules])?;
        }
        Ok(())
    }
}
