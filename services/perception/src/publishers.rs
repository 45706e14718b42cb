//! Publishers of the perception topics: scene, object views, object clouds, finished
//! frames.

use crate::detector::DetectedFrame;
use crate::frame_receiver::ReceivedFrame;
use crate::object_actors::SightingOutcome;
use crate::scene_report;
use channel::topic::{FinishedFrames, ObjectCloud, ObjectView, Scene, Topic};
use channel::{Domain, Error, Publisher};
use message::ObjectCloudHeader;
use pipeline::Track;

/// Publishers of the frame loop's topics.
pub(crate) struct Publishers {
    pub(crate) scene: Publisher<Scene>,
    views: Publisher<ObjectView>,
    clouds: Publisher<ObjectCloud>,
    pub(crate) finished: Publisher<FinishedFrames>,
}

impl Publishers {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            scene: Publisher::new(domain)?,
            views: Publisher::new(domain)?,
            clouds: Publisher::new(domain)?,
            finished: Publisher::new(domain)?,
        })
    }

    pub(crate) fn reserved_bytes(&self) -> u64 {
        self.scene.reservation().bytes()
            + self.views.reservation().bytes()
            + self.clouds.reservation().bytes()
            + self.finished.reservation().bytes()
    }

    /// Publishes views and clouds of the objects, where there are subscribers.
    pub(crate) fn publish_objects(
        &mut self,
        received: &ReceivedFrame,
        detected: &DetectedFrame,
        outcomes: &[SightingOutcome],
        tracks: &[Track],
    ) {
        let wants_views = self.views.has_subscribers();
        let wants_clouds = self.clouds.has_subscribers();
        for (sighting, observed) in outcomes {
            if wants_views && let Some(observed) = observed {
                let track = tracks.iter().find(|track| track.id == sighting.track_id);
                let mut header = scene_report::object_view(received, sighting, observed, track);
                header.detection_location = detected.location;
                log_unsent(self.views.send_copy(header, &observed.descriptor));
            }
            if wants_clouds {
                let indices = points_of(detected, sighting.candidate);
                let clouds = &mut self.clouds;
                log_unsent(publish_cloud(clouds, received, sighting.track_id, indices));
            }
        }
    }
}

fn points_of(detected: &DetectedFrame, candidate: usize) -> &[u32] {
    let candidate = detected.detection.candidates.get(candidate);
    candidate.map_or(&[], |candidate| detected.detection.points_of(candidate))
}

fn publish_cloud(
    clouds: &mut Publisher<ObjectCloud>,
    received: &ReceivedFrame,
    track_id: u64,
    indices: &[u32],
) -> Result<(), Error> {
    let indices = &indices[..indices.len().min(ObjectCloud::MAX_ITEMS)];
    let (header, points) = (received.frame.header(), received.frame.items());
    let mut loan = clouds.loan(indices.len())?;
    *loan.header_mut() = ObjectCloudHeader {
        track_id,
        session: header.session,
        sequence: header.sequence,
        capture_ns: header.capture_stamp_ns,
        ..ObjectCloudHeader::default()
    };
    for (item, index) in loan.items_mut().iter_mut().zip(indices) {
        *item = points[*index as usize];
    }
    clouds.send(loan)
}

/// Logs a failed publication; perception continues without it.
fn log_unsent(sent: Result<(), Error>) {
    if let Err(error) = sent {
        tracing::warn!("an object's view was not published: {error}");
    }
}
