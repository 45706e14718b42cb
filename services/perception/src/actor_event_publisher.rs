//! Publisher of actor life-cycle events: to the log, to health, and on the topic
//! `actor/event`.

use crate::restart_backoff::RestartBackoff;
use actor::{Cause, Escalation, Events, LifecycleEvent, StopReason};
use channel::topic::{ActorEvents, Topic};
use channel::{Domain, Error, Publisher};
use message::{ActorEvent, ActorEventKind, PlainHeader, Text};
use service::{HealthCounters, monotonic_ns};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Period at which the newest events are delivered to new subscribers.
const HISTORY_PERIOD: Duration = Duration::from_secs(1);

/// Consumer of the supervisor's events that logs, counts and publishes them.
pub(crate) struct ActorEventPublisher {
    events: Events<u64>,
    publisher: Publisher<ActorEvents>,
    backoff: Arc<RestartBackoff>,
    health: Arc<HealthCounters>,
    n_abandoned: u64,
}

impl ActorEventPublisher {
    /// Publisher for the events of a supervisor.
    pub(crate) fn new(
        domain: &Domain,
        events: Events<u64>,
        backoff: Arc<RestartBackoff>,
        health: Arc<HealthCounters>,
    ) -> Result<Self, Error> {
        Ok(Self {
            events,
            publisher: Publisher::new(domain)?,
            backoff,
            health,
            n_abandoned: 0,
        })
    }

    /// Processes events until the actors have failed too often; returns the reason as a
    /// sentence.
    pub(crate) async fn watch(&mut self) -> String {
        let mut greet = tokio::time::interval(HISTORY_PERIOD);
        loop {
            let event = tokio::select! {
                event = self.events.recv() => event,
                _ = greet.tick() => {
                    log_unsent(self.publisher.deliver_history());
                    continue;
                }
            };
            let Some(event) = event else {
                return "the supervisor of the object actors has stopped".into();
            };
            self.take(&event);
            if matches!(event, LifecycleEvent::Escalated { .. }) {
                return sentence(&event);
            }
        }
    }

    fn take(&mut self, event: &LifecycleEvent<u64>) {
        match event {
            LifecycleEvent::Restarting { id, after, .. } => {
                self.backoff.extend(*id, *after);
                self.health.restarts.fetch_add(1, Ordering::Relaxed);
                tracing::warn!("{}", sentence(event));
            }
            LifecycleEvent::Stopped { id, reason } => {
                self.backoff.remove(*id);
                if matches!(reason, StopReason::Failed { .. }) {
                    tracing::warn!("{}", sentence(event));
                } else {
                    tracing::debug!("{}", sentence(event));
                }
            }
            LifecycleEvent::Abandoned { .. } => {
                self.n_abandoned += 1;
                tracing::warn!("{}", sentence(event));
            }
            // Logged as the failure that ends the process.
            LifecycleEvent::Escalated { .. } => {}
            _ => tracing::debug!("{}", sentence(event)),
        }
        if let Some(message) = self.message(event) {
            log_unsent(self.publisher.send_copy(PlainHeader::default(), &[message]));
        }
    }

    /// Wire message of an event; `None` for event kinds that are not published.
    fn message(&self, event: &LifecycleEvent<u64>) -> Option<ActorEvent> {
        let (kind, track_id, failure) = parts(event)?;
        let (cause, frame) = failure.unzip();
        let frame = frame.flatten();
        let after = match event {
            LifecycleEvent::Restarting { after, .. } => after.as_nanos() as u64,
            _ => 0,
        };
        Some(ActorEvent {
            kind: kind.code(),
            track_id,
            frame: frame.unwrap_or(0),
            has_frame: u32::from(frame.is_some()),
            pid: std::process::id(),
            stamp_ns: monotonic_ns(),
            restart_after_ns: after,
            n_actors: self.health.actors.load(Ordering::Relaxed),
            n_restarts: self.health.restarts.load(Ordering::Relaxed),
            n_abandoned: self.n_abandoned,
            n_lost: self.events.dropped(),
            cause: cause
                .map(|cause| Text::truncated(&cause.to_string()))
                .unwrap_or_default(),
            ..ActorEvent::default()
        })
    }
}

/// Cause of a failure, with the sequence number of the frame that was processed.
type FailureAtFrame<'a> = (&'a Cause, Option<u64>);

fn parts(event: &LifecycleEvent<u64>) -> Option<(ActorEventKind, u64, Option<FailureAtFrame<'_>>)> {
    Some(match event {
        LifecycleEvent::Started { id } => (ActorEventKind::Started, *id, None),
        LifecycleEvent::Restarting { id, cause, tag, .. } => {
            (ActorEventKind::Restarting, *id, Some((cause, *tag)))
        }
        LifecycleEvent::Stopped { id, reason } => {
            let failure = match reason {
                StopReason::Failed { cause, tag } => Some((cause, *tag)),
                _ => None,
            };
            (ActorEventKind::Stopped, *id, failure)
        }
        LifecycleEvent::Abandoned { id } => (ActorEventKind::Abandoned, *id, None),
        LifecycleEvent::Escalated(Escalation { id, cause, tag, .. }) => {
            (ActorEventKind::Escalated, *id, Some((cause, *tag)))
        }
        _ => return None,
    })
}

/// Human-readable sentence about an actor event.
fn sentence(event: &LifecycleEvent<u64>) -> String {
    let Some((kind, track_id, failure)) = parts(event) else {
        return event.to_string();
    };
    let why = match failure {
        None => String::new(),
        Some((cause, None)) => format!(": {cause}"),
        Some((cause, Some(frame))) => format!(": {cause} (at frame {frame}, which it loses)"),
    };
    let actor = format!("the actor of track {track_id}");
    match (kind, event) {
        (ActorEventKind::Started, _) => format!("{actor} is ready"),
        (_, LifecycleEvent::Restarting { after, .. }) => {
            format!("{actor} starts again in {} ms{why}", after.as_millis())
        }
        (ActorEventKind::Abandoned, _) => {
            format!("{actor} did not stop in time and was left behind")
        }
        (
            _,
            LifecycleEvent::Escalated(Escalation {
                max_restarts,
                window,
                ..
            }),
        ) => format!(
            "the object actors needed more than {max_restarts} restarts within {} s, the last one \
             {actor}{why}; this process ends, to begin anew. [perception] actor_restarts_max and \
             actor_restart_window_s set the limit",
            window.as_secs_f64()
        ),
        _ if failure.is_some() => format!("{actor} has stopped permanently{why}"),
        _ => format!("{actor} has stopped"),
    }
}

/// Logs a failed publication; perception continues without it.
fn log_unsent(sent: Result<(), Error>) {
    if let Err(error) = sent {
        tracing::warn!(
            "an event on {} was not published: {error}",
            ActorEvents::NAME
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_name_the_track_the_frame_and_the_cause() {
        let cause = || Cause::Panicked("out of luck".into());
        let restarting = sentence(&LifecycleEvent::Restarting {
            id: 7,
            cause: cause(),
            tag: Some(31),
            after: Duration::from_millis(50),
        });
        let escalated = sentence(&LifecycleEvent::Escalated(Escalation {
            id: 7,
            cause: cause(),
            tag: Some(31),
            max_restarts: 5,
            window: Duration::from_secs(60),
        }));
        for sentence in [restarting, escalated] {
            for word in ["track 7", "frame 31", "panicked: out of luck"] {
                assert!(sentence.contains(word), "{sentence}");
            }
        }
        let stopped = sentence(&LifecycleEvent::Stopped {
            id: 7,
            reason: StopReason::Requested,
        });
        assert_eq!(stopped, "the actor of track 7 has stopped");
    }

    #[test]
    fn each_event_has_its_kind() {
        let (kind, track_id, failure) = parts(&LifecycleEvent::Started { id: 4 }).unwrap();
        assert_eq!((kind, track_id), (ActorEventKind::Started, 4));
        assert!(failure.is_none());
        let failed = LifecycleEvent::Stopped {
            id: 4,
            reason: StopReason::Failed {
                cause: Cause::Finished,
                tag: None,
            },
        };
        let (kind, _, failure) = parts(&failed).unwrap();
        assert_eq!(kind, ActorEventKind::Stopped);
        assert!(matches!(failure, Some((Cause::Finished, None))));
    }
}
