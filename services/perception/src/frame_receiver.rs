//! Frame receiver: takes the newest frame of the camera and validates its header.

use crate::log_once::LogOnce;
use channel::topic::CameraCloud;
use channel::{Domain, Error, SharedMessage, Subscriber};
use message::{CheckedFrame, FrameHeader, InvalidFrame, frame_flag};
use pipeline::FramePose;
use std::sync::Arc;

/// Validated frame, still in shared memory.
#[derive(Debug, Clone)]
pub(crate) struct ReceivedFrame {
    /// Frame header and points in shared memory.
    pub(crate) frame: Arc<SharedMessage<CameraCloud>>,
    /// Frame header with validated values.
    pub(crate) checked: CheckedFrame,
    /// Time at which the frame was received, monotonic clock, nanoseconds.
    pub(crate) received_ns: u64,
}

impl ReceivedFrame {
    /// True if the source waits until this frame is finished.
    pub(crate) fn is_lockstep(&self) -> bool {
        self.frame.header().has(frame_flag::LOCKSTEP)
    }

    /// Capture time, camera pose, up direction and intrinsics. Without a pose the world frame is the
    /// camera frame.
    pub(crate) fn frame_pose(&self) -> FramePose {
        FramePose {
            capture_ns: self.frame.header().capture_stamp_ns,
            world_from_camera: self.checked.world_from_camera.unwrap_or_default(),
            up_in_camera: self.checked.up_in_camera,
            camera: Some(self.checked.camera),
        }
    }
}

/// Subscriber to frames that keeps the newest and counts dropped ones.
pub(crate) struct FrameReceiver {
    subscriber: Subscriber<CameraCloud>,
    counter: FrameCounter,
    invalid_log: LogOnce,
}

impl FrameReceiver {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            subscriber: Subscriber::owner(domain)?,
            counter: FrameCounter::default(),
            invalid_log: LogOnce::default(),
        })
    }

    /// Waits until a frame may have arrived.
    pub(crate) async fn woken(&self) {
        self.subscriber.wake_event().await;
    }

    /// Takes the newest waiting frame; older and invalid ones count as dropped.
    pub(crate) fn newest(&mut self) -> Result<Option<ReceivedFrame>, Error> {
        let Some(frame) = self.subscriber.latest()? else {
            return Ok(None);
        };
        let received_ns = service::monotonic_ns();
        self.begin_session(frame.header());
        match frame.header().checked(frame.items().len(), received_ns) {
            Ok(checked) => {
                self.counter.accept(frame.header().sequence);
                Ok(Some(ReceivedFrame {
                    frame: Arc::new(frame),
                    checked,
                    received_ns,
                }))
            }
            Err(error) => {
                self.reject(&error);
                Ok(None)
            }
        }
    }

    /// Frames of the current session that were not processed.
    pub(crate) fn n_dropped(&self) -> u64 {
        self.counter.n_dropped
    }

    fn begin_session(&mut self, header: &FrameHeader) {
        if self.counter.begin_session(header.session) {
            self.invalid_log.reset();
            tracing::info!(
                "frames come from {}",
                header.source_name.as_str().unwrap_or("an unknown source")
            );
        }
    }

    fn reject(&mut self, error: &InvalidFrame) {
        self.counter.reject();
        if self.invalid_log.is_first() {
            tracing::error!("{error}; such frames are left out, further ones are only counted");
        }
    }
}

/// Counter of dropped frames, from the gaps in a session's sequence numbers.
///
/// Only the sequence number of a checked header is believed, and no number overflows.
#[derive(Debug, Default)]
struct FrameCounter {
    session: u64,
    /// Sequence number after the last frame; `None` before the first valid frame.
    next_sequence: Option<u64>,
    n_dropped: u64,
}

impl FrameCounter {
    /// Resets the count when a frame is of another session, and returns true then. The
    /// first valid frame of a session may have any sequence number.
    fn begin_session(&mut self, session: u64) -> bool {
        let is_new = session != self.session;
        if is_new {
            *self = Self {
                session,
                ..Self::default()
            };
        }
        is_new
    }

    /// Counts the gap before a valid frame as dropped frames.
    fn accept(&mut self, sequence: u64) {
        let gap = self
            .next_sequence
            .map_or(0, |next| sequence.saturating_sub(next));
        self.n_dropped = self.n_dropped.saturating_add(gap);
        self.next_sequence = Some(sequence.saturating_add(1));
    }

    /// Counts an invalid frame as dropped; it takes one number of the sequence.
    fn reject(&mut self) {
        self.n_dropped = self.n_dropped.saturating_add(1);
        self.next_sequence = self.next_sequence.map(|next| next.saturating_add(1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_and_invalid_frames_count_once_as_dropped() {
        let mut counter = FrameCounter::default();
        assert!(counter.begin_session(7) && !counter.begin_session(7));
        counter.accept(40);
        counter.accept(41);
        assert_eq!(counter.n_dropped, 0);
        counter.accept(44);
        counter.reject();
        counter.accept(46);
        assert_eq!(counter.n_dropped, 3);
        assert!(counter.begin_session(8));
        assert_eq!(counter.n_dropped, 0);
    }

    #[test]
    fn the_largest_sequence_number_does_not_overflow() {
        let mut counter = FrameCounter::default();
        counter.accept(0);
        counter.accept(u64::MAX);
        counter.accept(u64::MAX);
        counter.reject();
        counter.accept(u64::MAX);
        assert_eq!(counter.n_dropped, u64::MAX);
    }
}
