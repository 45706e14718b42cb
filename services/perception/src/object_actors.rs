//! Scatter-gather over the object actors: sends a frame's sightings and collects the
//! answers.

use crate::detector::DetectedFrame;
#[cfg(feature = "fault-injection")]
use crate::fault_injection::{FaultConfig, FaultInjector};
use crate::frame_receiver::ReceivedFrame;
use crate::memory_replica::CategorySnapshot;
use crate::object_actor::{ObjectActor, ObserveView, ObservedView};
use crate::restart_backoff::RestartBackoff;
use actor::{Address, PendingReply, RestartPolicy, Supervisor};
use pipeline::{Config, ObjectState, ObservedTracks, Sighting};
use service::monotonic_ns;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::{Instant, timeout_at};

/// Shortest assumed back-off of an actor that lost a message, until the supervisor
/// announces the real one.
const MIN_BACKOFF: Duration = Duration::from_millis(50);

/// The object actors by track-id.
pub(crate) struct ObjectActors {
    supervisor: Supervisor<u64, ObjectActor>,
    addresses: BTreeMap<u64, Address<ObjectActor>>,
    backoff: Arc<RestartBackoff>,
    config: Config,
    #[cfg(feature = "fault-injection")]
    fault: FaultInjector,
    spare_descriptors: Vec<Vec<f32>>,
    asked: Vec<(Sighting, Option<PendingReply<ObservedView>>)>,
}

/// Shared input of all observations of a frame.
pub(crate) struct ObservedFrame<'a> {
    /// Received frame, in shared memory.
    pub(crate) received: &'a ReceivedFrame,
    /// Detection result of the frame.
    pub(crate) detected: &'a Arc<DetectedFrame>,
    /// Taught views that the objects are recognised with.
    pub(crate) taught: &'a Arc<CategorySnapshot>,
    /// Tracks with their evidence before the frame.
    pub(crate) tracks: &'a ObservedTracks<'a>,
}

/// Sighting with its answer; `None` when the actor did not answer in time.
pub(crate) type SightingOutcome = (Sighting, Option<ObservedView>);

impl ObjectActors {
    pub(crate) fn new(
        supervisor: Supervisor<u64, ObjectActor>,
        backoff: Arc<RestartBackoff>,
        config: Config,
        #[cfg(feature = "fault-injection")] fault: FaultConfig,
    ) -> Self {
        Self {
            supervisor,
            addresses: BTreeMap::new(),
            backoff,
            config,
            #[cfg(feature = "fault-injection")]
            fault: FaultInjector::new(fault),
            spare_descriptors: Vec::new(),
            asked: Vec::new(),
        }
    }

    /// Replaces the settings of observations, between two frames.
    pub(crate) fn set_pipeline_config(&mut self, config: Config) {
        self.config = config;
    }

    /// Replaces the restart policy.
    pub(crate) fn set_restart_policy(&mut self, policy: RestartPolicy) {
        self.supervisor.set_policy(policy);
    }

    /// Starts an actor for a new track.
    pub(crate) fn spawn(&mut self, track_id: u64) {
        match self.supervisor.spawn(track_id, ObjectState::default()) {
            Ok(address) => {
                self.addresses.insert(track_id, address);
            }
            Err(error) => tracing::error!("track {track_id} has no actor: {error}"),
        }
    }

    /// Number of actors, including those that are stopping.
    pub(crate) fn n_actors(&self) -> usize {
        self.supervisor.n_actors()
    }

    /// Stops the actor of a track that has ended.
    pub(crate) fn dismiss(&mut self, track_id: u64) {
        self.addresses.remove(&track_id);
        self.backoff.remove(track_id);
        self.supervisor.request_stop(&track_id);
    }

    /// Stops all actors and waits for them.
    pub(crate) async fn stop_all(&self) {
        let n_abandoned = self.supervisor.stop_all().await;
        if n_abandoned > 0 {
            tracing::warn!("{n_abandoned} actors did not stop in time");
        }
    }

    /// Sends each sighting to its actor and collects the answers until the deadline;
    /// without a deadline until all have answered or are lost. With a deadline, an actor
    /// in restart back-off is skipped, so that it delays no frame.
    pub(crate) async fn observe(
        &mut self,
        frame: &ObservedFrame<'_>,
        sightings: &[Sighting],
        deadline: Option<Duration>,
        outcomes: &mut Vec<SightingOutcome>,
    ) {
        outcomes.clear();
        for sighting in sightings {
            let is_absent = deadline.is_some() && self.backoff.is_waiting(sighting.track_id);
            let answer = (!is_absent).then(|| self.ask(frame, sighting));
            self.asked.push((*sighting, answer.flatten()));
        }
        let until = deadline.map(|deadline| Instant::now() + deadline);
        for (sighting, answer) in self.asked.drain(..) {
            let observed = match (answer, until) {
                (None, _) => None,
                (Some(answer), None) => answer.await.ok(),
                (Some(answer), Some(until)) => match timeout_at(until, answer).await {
                    Ok(Err(_lost)) => {
                        self.backoff.extend(sighting.track_id, MIN_BACKOFF);
                        None
                    }
                    in_time => in_time.ok().and_then(Result::ok),
                },
            };
            let observed = observed.map(|mut observed| {
                observed.stamps.answered_ns = monotonic_ns();
                observed
            });
            outcomes.push((sighting, observed));
        }
    }

    /// Recycles the descriptor buffers of answers.
    pub(crate) fn recycle(&mut self, outcomes: &mut Vec<SightingOutcome>) {
        let observed = outcomes.drain(..).filter_map(|(_, observed)| observed);
        self.spare_descriptors
            .extend(observed.map(|observed| observed.descriptor));
    }

    fn ask(
        &mut self,
        frame: &ObservedFrame<'_>,
        sighting: &Sighting,
    ) -> Option<PendingReply<ObservedView>> {
        let address = self.addresses.get(&sighting.track_id)?;
        let observe = ObserveView {
            received: frame.received.clone(),
            detected: frame.detected.clone(),
            candidate: sighting.candidate,
            track_id: sighting.track_id,
            config: self.config,
            measured: sighting.measured,
            evidence: frame.tracks.evidence(sighting.track_id),
            taught: frame.taught.clone(),
            descriptor: self.spare_descriptors.pop().unwrap_or_default(),
            asked_ns: monotonic_ns(),
            #[cfg(feature = "fault-injection")]
            is_to_panic: self.fault.is_due(sighting.track_id),
        };
        // An actor that has stopped permanently has been reported by the supervisor.
        address
            .ask(frame.received.frame.header().sequence, observe)
            .ok()
    }
}
