//! Where the robot and people are, and what else is known before a frame is
//! searched.

use channel::topic::{ArmStates, PersonBodies, Topic};
use channel::{Domain, Error, Received, Subscriber};
use detection::{ExpectedTrack, Surroundings};
use geometry::{Capsule, RigidTransform};
use message::{ArmState, PersonBody, SCHEMA_VERSION, WireCapsule};
use std::collections::VecDeque;

/// A body that was told for no instant nearer to a frame's capture than this
/// counts as absent.
const SILENCE_NS: u64 = 500_000_000;

/// Instants of a channel that are kept: a frame is older than what was told last.
const N_INSTANTS: usize = 16;

/// A message that tells where a body was at an instant.
pub(crate) trait Told {
    /// Whether it is of this version.
    fn is_readable(&self) -> bool;
    /// The instant, on the clock of the frames' capture.
    fn stamp_ns(&self) -> u64;
}

macro_rules! told {
    ($($header:ty),*) => {$(
        impl Told for $header {
            fn is_readable(&self) -> bool {
                self.schema_version == SCHEMA_VERSION
            }
            fn stamp_ns(&self) -> u64 {
                self.stamp_ns
            }
        }
    )*};
}

told!(ArmState, PersonBody);

/// A body at an instant, world frame.
#[derive(Debug, Default)]
struct Instant {
    stamp_ns: u64,
    capsules: Vec<Capsule>,
}

/// The last instants of a body, in the order in which they were told.
#[derive(Debug, Default)]
struct Recent(VecDeque<Instant>);

impl Recent {
    fn take(&mut self, stamp_ns: u64, capsules: &[WireCapsule]) {
        let is_full = self.0.len() >= N_INSTANTS;
        let mut instant = is_full
            .then(|| self.0.pop_front())
            .flatten()
            .unwrap_or_default();
        instant.stamp_ns = stamp_ns;
        instant.capsules.clear();
        let checked = capsules.iter().filter_map(WireCapsule::checked);
        instant.capsules.extend(checked);
        self.0.push_back(instant);
    }

    /// The body at the instant nearest to a frame's capture, the one told last
    /// where several are; `None` when all are too far from it.
    fn at(&self, capture_ns: u64) -> Option<&[Capsule]> {
        let away = |instant: &&Instant| instant.stamp_ns.abs_diff(capture_ns);
        let nearest = self.0.iter().rev().min_by_key(away)?;
        (away(&nearest) <= SILENCE_NS).then_some(&nearest.capsules)
    }
}

/// A channel that tells where a body is.
struct Feed<T: Topic> {
    subscriber: Subscriber<T>,
    recent: Recent,
}

impl<T: Topic<Item = WireCapsule, Header: Told>> Feed<T> {
    fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            subscriber: Subscriber::polled(domain)?,
            recent: Recent::default(),
        })
    }

    /// Takes what was told since the last call.
    fn listen(&mut self) -> Result<(), Error> {
        while let Received::Message(message) = self.subscriber.receive()? {
            let header = message.header();
            if header.is_readable() {
                self.recent.take(header.stamp_ns(), message.items());
            }
        }
        Ok(())
    }
}

/// The channels that tell where the robot and people are.
pub(crate) struct Bodies {
    robot: Feed<ArmStates>,
    people: Feed<PersonBodies>,
}

impl Bodies {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            robot: Feed::new(domain)?,
            people: Feed::new(domain)?,
        })
    }

    /// Writes down where the bodies were when a frame was captured. They are told
    /// in the world's frame: without the camera's pose they are not known.
    pub(crate) fn at(
        &mut self,
        capture_ns: u64,
        world_from_camera: Option<&RigidTransform>,
        known: &mut Known,
    ) -> Result<(), Error> {
        self.robot.listen()?;
        self.people.listen()?;
        let camera_from_world = world_from_camera.map(RigidTransform::inverse);
        for (recent, body) in [
            (&self.robot.recent, &mut known.robot),
            (&self.people.recent, &mut known.people),
        ] {
            body.set(recent.at(capture_ns), camera_from_world.as_ref());
        }
        Ok(())
    }
}

/// A body in the camera's frame, or that nobody tells where it is.
#[derive(Debug, Default)]
struct Body {
    is_known: bool,
    capsules: Vec<Capsule>,
}

impl Body {
    fn set(
        &mut self,
        capsules_in_world: Option<&[Capsule]>,
        camera_from_world: Option<&RigidTransform>,
    ) {
        self.capsules.clear();
        self.is_known = capsules_in_world.is_some() && camera_from_world.is_some();
        if let (Some(capsules), Some(camera_from_world)) = (capsules_in_world, camera_from_world) {
            let in_camera = capsules
                .iter()
                .map(|capsule| capsule.transformed(camera_from_world));
            self.capsules.extend(in_camera);
        }
    }

    fn capsules(&self) -> Option<&[Capsule]> {
        self.is_known.then_some(&self.capsules)
    }
}

/// What is known to be there before a frame is searched, camera frame. Reused
/// from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Known {
    robot: Body,
    people: Body,
    /// The live tracks, predicted to the frame.
    pub(crate) tracks: Vec<ExpectedTrack>,
}

impl Known {
    /// The same as detection takes it.
    pub(crate) fn surroundings(&self) -> Surroundings<'_> {
        Surroundings {
            instructor: self.people.capsules(),
            robot: self.robot.capsules(),
            tracks: &self.tracks,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Vector3};

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
    fn the_instant_nearest_to_the_capture_counts() {
        let mut recent = Recent::default();
        assert_eq!(recent.at(0), None);
        for i in 0..100_u32 {
            recent.take(u64::from(i) * FRAME_NS, &[ball_at(f64::from(i))]);
        }
        assert_eq!(recent.0.len(), N_INSTANTS);
        assert_eq!(place(recent.at(97 * FRAME_NS + 5)), Some(97.0));
        assert_eq!(place(recent.at(99 * FRAME_NS + SILENCE_NS)), Some(99.0));
        assert_eq!(recent.at(99 * FRAME_NS + SILENCE_NS + 1), None);
        // What is told twice for an instant is as it was told last.
        recent.take(99 * FRAME_NS, &[ball_at(-1.0)]);
        assert_eq!(place(recent.at(99 * FRAME_NS)), Some(-1.0));
        // Nobody there is not the same as nobody telling.
        recent.take(100 * FRAME_NS, &[]);
        assert_eq!(recent.at(100 * FRAME_NS), Some(&[][..]));
    }

    #[test]
    fn a_broken_capsule_is_left_out() {
        let mut recent = Recent::default();
        let broken = WireCapsule {
            radius_m: f64::NAN,
            ..ball_at(0.0)
        };
        recent.take(0, &[broken, ball_at(0.5)]);
        assert_eq!(recent.at(0).map(<[Capsule]>::len), Some(1));
    }

    #[test]
    fn bodies_are_given_in_the_cameras_frame_or_are_not_known() {
        let mut recent = Recent::default();
        recent.take(0, &[ball_at(0.5)]);
        let camera_from_world = RigidTransform::new(Vector3::x() * 0.25, Vector3::zeros());
        let mut known = Known::default();
        known.robot.set(recent.at(0), Some(&camera_from_world));
        known.people.set(recent.at(0), None);
        let surroundings = known.surroundings();
        assert_eq!(place(surroundings.robot), Some(0.75));
        assert_eq!(surroundings.instructor, None);
        known.robot.set(None, Some(&camera_from_world));
        assert_eq!(known.surroundings().robot, None);
    }
}
