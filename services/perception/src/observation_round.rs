//! Handing a frame's sightings to their actors, and collecting the answers.

use crate::detector::Detected;
use crate::intake::Arrived;
use crate::object_actor::{ObjectActor, Observe, Observed};
use actor::{Address, Answer, Supervisor};
use pipeline::{ObjectState, Sighting};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::{Instant, timeout_at};

/// The actors, by track-id.
pub(crate) struct Actors {
    supervisor: Supervisor<u64, ObjectActor>,
    addresses: BTreeMap<u64, Address<ObjectActor>>,
    spare_descriptors: Vec<Vec<f32>>,
    asked: Vec<(Sighting, Option<Answer<Observed>>)>,
}

/// What came of a sighting; `None` when its actor did not answer in time.
pub(crate) type Outcome = (Sighting, Option<Observed>);

impl Actors {
    pub(crate) fn new(supervisor: Supervisor<u64, ObjectActor>) -> Self {
        Self {
            supervisor,
            addresses: BTreeMap::new(),
            spare_descriptors: Vec::new(),
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

    /// Stops the actor of a track that has ended.
    pub(crate) fn dismiss(&mut self, track_id: u64) {
        self.addresses.remove(&track_id);
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
    /// the deadline; without one until all have answered or are lost.
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
            let answer = self.ask(arrived, detected, sighting);
            self.asked.push((*sighting, answer));
        }
        let until = deadline.map(|deadline| Instant::now() + deadline);
        for (sighting, answer) in self.asked.drain(..) {
            let observed = match (answer, until) {
                (None, _) => None,
                (Some(answer), None) => answer.await.ok(),
                (Some(answer), Some(until)) => {
                    timeout_at(until, answer).await.ok().and_then(Result::ok)
                }
            };
            outcomes.push((sighting, observed));
        }
    }

    /// Takes the memory of answers back for later ones.
    pub(crate) fn recycle(&mut self, outcomes: &mut Vec<Outcome>) {
        let observed = outcomes.drain(..).filter_map(|(_, observed)| observed);
        self.spare_descriptors
            .extend(observed.map(|observed| observed.descriptor));
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
            measured: sighting.measured,
            descriptor: self.spare_descriptors.pop().unwrap_or_default(),
        };
        // An actor that has stopped for good has been reported by the supervisor.
        address.ask(arrived.frame.header().sequence, observe).ok()
    }
}
