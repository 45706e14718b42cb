//! Subscribers to the poses of the robot and of people, with time-stamped pose histories.

use crate::scene_priors::PriorBuffers;
use channel::topic::{ArmStates, PersonBodies, Topic};
use channel::{Domain, Error, Received, Subscriber};
use geometry::{Capsule, RigidTransform};
use message::{ArmState, PersonBody, SCHEMA_VERSION, WireCapsule};
use std::collections::VecDeque;

/// Largest time between a frame's capture and the nearest body sample, nanoseconds;
/// beyond it the body counts as absent. Chosen.
const MAX_GAP_NS: u64 = 500_000_000;

/// Capacity of a pose history, samples. Frames arrive later than the newest sample, so
/// older ones are needed.
const HISTORY_LENGTH: usize = 16;

/// Message header with a time stamp and a schema version.
pub(crate) trait Stamped {
    /// True if the schema version is the one of this program.
    fn is_readable(&self) -> bool;
    /// Time stamp on the clock of the frames' capture, nanoseconds.
    fn stamp_ns(&self) -> u64;
}

macro_rules! impl_stamped {
    ($($header:ty),*) => {$(
        impl Stamped for $header {
            fn is_readable(&self) -> bool {
                self.schema_version == SCHEMA_VERSION
            }
            fn stamp_ns(&self) -> u64 {
                self.stamp_ns
            }
        }
    )*};
}

impl_stamped!(ArmState, PersonBody);

/// Capsules of a body at one time stamp, world frame.
#[derive(Debug, Default)]
struct BodySample {
    stamp_ns: u64,
    capsules: Vec<Capsule>,
}

/// Ring buffer of the latest body samples, in the order of arrival.
#[derive(Debug, Default)]
struct PoseHistory(VecDeque<BodySample>);

impl PoseHistory {
    fn push(&mut self, stamp_ns: u64, capsules: &[WireCapsule]) {
        let is_full = self.0.len() >= HISTORY_LENGTH;
        let mut sample = is_full
            .then(|| self.0.pop_front())
            .flatten()
            .unwrap_or_default();
        sample.stamp_ns = stamp_ns;
        sample.capsules.clear();
        // Copied out of shared memory first: what is checked is what is used.
        let checked = capsules.iter().copied();
        let checked = checked.filter_map(|capsule| capsule.checked());
        sample.capsules.extend(checked);
        self.0.push_back(sample);
    }

    /// Nearest-in-time lookup: the sample nearest to a frame's capture, the latest of
    /// equals; `None` when all are farther than [`MAX_GAP_NS`].
    fn at(&self, capture_ns: u64) -> Option<&[Capsule]> {
        let distance = |sample: &&BodySample| sample.stamp_ns.abs_diff(capture_ns);
        let nearest = self.0.iter().rev().min_by_key(distance)?;
        (distance(&nearest) <= MAX_GAP_NS).then_some(&nearest.capsules)
    }
}

/// Subscriber to one body topic, with its pose history.
struct BodySubscriber<T: Topic> {
    subscriber: Subscriber<T>,
    history: PoseHistory,
}

impl<T: Topic<Item = WireCapsule, Header: Stamped>> BodySubscriber<T> {
    fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            subscriber: Subscriber::polled(domain)?,
            history: PoseHistory::default(),
        })
    }

    /// Moves all waiting messages into the history.
    fn receive(&mut self) -> Result<(), Error> {
        while let Received::Message(message) = self.subscriber.receive()? {
            let header = message.header();
            if header.is_readable() {
                self.history.push(header.stamp_ns(), message.items());
            }
        }
        Ok(())
    }
}

/// Subscribers to the robot's and to people's bodies.
pub(crate) struct BodySubscribers {
    robot: BodySubscriber<ArmStates>,
    people: BodySubscriber<PersonBodies>,
}

impl BodySubscribers {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            robot: BodySubscriber::new(domain)?,
            people: BodySubscriber::new(domain)?,
        })
    }

    /// Fills the priors with the bodies at a frame's capture. Bodies are published in the
    /// world frame, so they are unknown without the camera pose.
    pub(crate) fn priors_at(
        &mut self,
        capture_ns: u64,
        world_from_camera: Option<&RigidTransform>,
        priors: &mut PriorBuffers,
    ) -> Result<(), Error> {
        self.robot.receive()?;
        self.people.receive()?;
        let camera_from_world = world_from_camera.map(RigidTransform::inverse);
        for (history, body) in [
            (&self.robot.history, &mut priors.robot),
            (&self.people.history, &mut priors.people),
        ] {
            body.set(history.at(capture_ns), camera_from_world.as_ref());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    const FRAME_NS: u64 = 33_333_333;

    fn ball_at(x: f64) -> WireCapsule {
        WireCapsule::from(&Capsule {
            from: Point3::new(x, 0.0, 0.0),
            to: Point3::new(x, 0.0, 0.0),
            radius_m: 0.1,
        })
    }

    fn place(capsules: Option<&[Capsule]>) -> Option<f64> {
        capsules.and_then(|capsules| Some(capsules.first()?.from.x))
    }

    #[test]
    fn the_sample_nearest_to_the_capture_is_found() {
        let mut history = PoseHistory::default();
        assert_eq!(history.at(0), None);
        for i in 0..100_u32 {
            history.push(u64::from(i) * FRAME_NS, &[ball_at(f64::from(i))]);
        }
        assert_eq!(history.0.len(), HISTORY_LENGTH);
        assert_eq!(place(history.at(97 * FRAME_NS + 5)), Some(97.0));
        assert_eq!(place(history.at(99 * FRAME_NS + MAX_GAP_NS)), Some(99.0));
        assert_eq!(history.at(99 * FRAME_NS + MAX_GAP_NS + 1), None);
        // The latest of two samples of the same time counts.
        history.push(99 * FRAME_NS, &[ball_at(-1.0)]);
        assert_eq!(place(history.at(99 * FRAME_NS)), Some(-1.0));
        // An empty body is not an unknown body.
        history.push(100 * FRAME_NS, &[]);
        assert_eq!(history.at(100 * FRAME_NS), Some(&[][..]));
    }

    #[test]
    fn a_broken_capsule_is_left_out() {
        let mut history = PoseHistory::default();
        let broken = WireCapsule {
            radius_m: f64::NAN,
            ..ball_at(0.0)
        };
        history.push(0, &[broken, ball_at(0.5)]);
        assert_eq!(history.at(0).map(<[Capsule]>::len), Some(1));
    }
}
