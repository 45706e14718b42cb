//! Frames from the camera: the newest, checked.

use channel::topic::CameraCloud;
use channel::{Domain, Error, Received, SharedFrame, Subscriber};
use message::{CheckedFrame, InvalidFrame, frame_flag};
use pipeline::Frame;
use std::sync::Arc;

/// A frame that can be worked on, still in shared memory.
#[derive(Debug, Clone)]
pub(crate) struct Arrived {
    /// Header and points.
    pub(crate) frame: Arc<SharedFrame<CameraCloud>>,
    /// The header's numbers, checked.
    pub(crate) checked: CheckedFrame,
    /// When it was taken, monotonic.
    pub(crate) received_ns: u64,
}

impl Arrived {
    /// Whether the source waits for this frame to be finished.
    pub(crate) fn is_lockstep(&self) -> bool {
        self.frame.header().has(frame_flag::LOCKSTEP)
    }

    /// When and from where it was seen; without a pose the world is the camera's
    /// frame.
    pub(crate) fn circumstances(&self) -> Frame {
        Frame {
            capture_ns: self.frame.header().capture_stamp_ns,
            world_from_camera: self.checked.world_from_camera.unwrap_or_default(),
            camera: Some(self.checked.camera),
        }
    }
}

/// Takes frames and counts those it could not take.
pub(crate) struct Intake {
    subscriber: Subscriber<CameraCloud>,
    session: u64,
    next_sequence: u64,
    n_dropped: u64,
    is_invalid_told: bool,
}

impl Intake {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            subscriber: Subscriber::waiting(domain)?,
            session: 0,
            next_sequence: 0,
            n_dropped: 0,
            is_invalid_told: false,
        })
    }

    /// Returns when a frame may be there.
    pub(crate) async fn woken(&self) {
        self.subscriber.woken().await;
    }

    /// Takes the newest waiting frame; older ones, and unusable ones, count as
    /// dropped.
    pub(crate) fn newest(&mut self) -> Result<Option<Arrived>, Error> {
        let mut newest = None;
        while let Received::Message(frame) = self.subscriber.receive()? {
            newest = Some(frame);
        }
        let Some(frame) = newest else { return Ok(None) };
        let received_ns = service::monotonic_ns();
        self.count(&frame);
        match frame.header().checked(frame.items().len()) {
            Ok(checked) => Ok(Some(Arrived {
                frame: Arc::new(frame),
                checked,
                received_ns,
            })),
            Err(error) => {
                self.refuse(&error);
                Ok(None)
            }
        }
    }

    /// Frames of the current session that were not worked on.
    pub(crate) fn n_dropped(&self) -> u64 {
        self.n_dropped
    }

    /// Counts gaps in the sequence. The first frame of a session is wherever
    /// this process came to it.
    fn count(&mut self, frame: &SharedFrame<CameraCloud>) {
        let header = frame.header();
        if header.session == self.session {
            self.n_dropped += header.sequence.saturating_sub(self.next_sequence);
        } else {
            self.n_dropped = 0;
            self.session = header.session;
            self.is_invalid_told = false;
            tracing::info!(
                "frames come from {}",
                header.source_name.as_str().unwrap_or("an unknown source")
            );
        }
        self.next_sequence = header.sequence + 1;
    }

    fn refuse(&mut self, error: &InvalidFrame) {
        self.n_dropped += 1;
        if !self.is_invalid_told {
            tracing::error!("{error}; such frames are left out, further ones are only counted");
            self.is_invalid_told = true;
        }
    }
}
