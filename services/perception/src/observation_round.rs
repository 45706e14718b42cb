//! Handing a frame's sightings to their actors, and collecting the answers.

use crate::detector::Detected;
#[cfg(feature = "fault-injection")]
use crate::fault::{Fault, FaultConfig};
use crate::intake::Arrived;
use crate::object_actor::{ObjectActor, Observe, Observed};
use crate::resting::Resting;
use actor::{Address, Answer, Supervisor};
use pipeline::{ObjectState, Sighting};
use point_cloud::Point;
use service::monotonic_ns;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::{Instant, timeout_at};

/// Who has lost a message rests at least this long; the supervisor says how long
/// in truth, a moment later.
const LEAST_REST: Duration = Duration::from_millis(50);

/// The actors, by track-id.
pub(crate) struct Actors {
    supervisor: Supervisor<u64, ObjectActor>,
    addresses: BTreeMap<u64, Address<ObjectActor>>,
    resting: Arc<Resting>,
    #[cfg(feature = "fault-injection")]
    fault: Fault,
    spare_descriptors: Vec<Vec<f32>>,
    spare_points: Vec<Vec<Point>>,
    asked: Vec<(Sighting, Option<Answer<Observed>>)>,
}

/// What came of a sighting; `None` when its actor did not answer in time.
pub(crate) type Outcome = (Sighting, Option<Observed>);

impl Actors {
    pub(crate) fn new(
        supervisor: Supervisor<u64, ObjectActor>,
        resting: Arc<Resting>,
        #[cfg(feature = "fault-injection")] fault: FaultConfig,
    ) -> Self {
        Self {
            supervisor,
            addresses: BTreeMap::new(),
            resting,
            #[cfg(feature = "fault-injection")]
            fault: Fault::new(fault),
            spare_descriptors: Vec::new(),
            spare_points: Vec::new(),
            asked: Vec::new(),
        }
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

    /// How many there are, those included that are about to stop.
    pub(crate) fn n_actors(&self) -> usize {
        self.supervisor.n_actors()
    }

    /// Stops the actor of a track that has ended.
    pub(crate) fn dismiss(&mut self, track_id: u64) {
        self.addresses.remove(&track_id);
        self.resting.forget(track_id);
        self.supervisor.dismiss(&track_id);
    }

    /// Stops all actors.
    pub(crate) async fn stop_all(&self) {
        let n_abandoned = self.supervisor.stop_all().await;
        if n_abandoned > 0 {
            tracing::warn!("{n_abandoned} actors did not stop in time");
        }
    }

    /// Gives each sighting to its actor and waits for the answers, at most until
    /// the deadline; without one until all have answered or are lost. With a deadline
    /// an actor that is about to start again is not asked: the others' frames do not
    /// wait for it.
    pub(crate) async fn observe(
        &mut self,
        arrived: &Arrived,
        detected: &Arc<Detected>,
        sightings: &[Sighting],
        deadline: Option<Duration>,
        outcomes: &mut Vec<Outcome>,
    ) {
        outcomes.clear();
        for sighting in sightings {
            let is_absent = deadline.is_some() && self.resting.is_resting(sighting.track_id);
            let answer = (!is_absent).then(|| self.ask(arrived, detected, sighting));
            self.asked.push((*sighting, answer.flatten()));
        }
        let until = deadline.map(|deadline| Instant::now() + deadline);
        for (sighting, answer) in self.asked.drain(..) {
            let observed = match (answer, until) {
                (None, _) => None,
                (Some(answer), None) => answer.await.ok(),
                (Some(answer), Some(until)) => match timeout_at(until, answer).await {
                    Ok(Err(_lost)) => {
                        self.resting.rest(sighting.track_id, LEAST_REST);
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

    /// Takes the memory of answers back for later ones.
    pub(crate) fn recycle(&mut self, outcomes: &mut Vec<Outcome>) {
        let observed = outcomes.drain(..).filter_map(|(_, observed)| observed);
        self.spare_descriptors
            .extend(observed.map(|observed| observed.descriptor));
    }

    /// Takes the memory of an older view's points back for later ones.
    pub(crate) fn recycle_points(&mut self, points: Vec<Point>) {
        self.spare_points.push(points);
    }

    fn ask(
        &mut self,
        arrived: &Arrived,
        detected: &Arc<Detected>,
        sighting: &Sighting,
    ) -> Option<Answer<Observed>> {
        let address = self.addresses.get(&sighting.track_id)?;
        let observe = Observe {
            arrived: arrived.clone(),
            detected: detected.clone(),
            candidate: sighting.candidate,
            track_id: sighting.track_id,
            measured: sighting.measured,
            descriptor: self.spare_descriptors.pop().unwrap_or_default(),
            points: self.spare_points.pop().unwrap_or_default(),
            asked_ns: monotonic_ns(),
            #[cfg(feature = "fault-injection")]
            is_to_panic: self.fault.strikes(sighting.track_id),
        };
        // An actor that has stopped for good has been reported by the supervisor.
        address.ask(arrived.frame.header().sequence, observe).ok()
    }
}
