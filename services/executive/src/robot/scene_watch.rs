//! Newest scene with the bodies of arm and people.

use arm_kinematics::GripperModel;
use arm_scene::{ArmAndPeople, ArmScene};
use channel::Domain;
use geometry::{Capsule, OrientedBox};
use message::SceneObject;
use nalgebra::{Isometry3, Point2, Quaternion, Translation3, UnitQuaternion, Vector3};
use scene_client::{DaemonModels, SnapshotReceiver, is_seen};
use service::{CommonArguments, Failure};
use std::time::{Duration, Instant};
use tasks::TableObject;

/// Age of the newest scene above which it says nothing about the present.
const STALE: Duration = Duration::from_millis(300);
/// Number of places along a link between which the distance to a person is taken.
const N_LINK_STEPS: u32 = 4;

/// Subscriptions of scene, arm and people.
pub(crate) struct SceneWatch {
    receiver: SnapshotReceiver,
    bodies: ArmAndPeople,
    /// Number of scenes received since the last [`begin_look`](Self::begin_look).
    n_scenes: u32,
    /// Begin of the time, but in lockstep.
    start: Instant,
    /// Time of the last look at the topics.
    now: Duration,
    /// Time of the newest scene.
    received: Option<Duration>,
}

impl SceneWatch {
    /// Joins the topics.
    ///
    /// # Errors
    /// When a topic has no room for another subscriber, or shared memory fails.
    pub(crate) fn new(domain: &Domain) -> Result<Self, Failure> {
        Ok(Self {
            receiver: SnapshotReceiver::new(domain)?,
            bodies: ArmAndPeople::new(domain)?,
            n_scenes: 0,
            start: Instant::now(),
            now: Duration::ZERO,
            received: None,
        })
    }

    /// Receives what has come.
    ///
    /// # Errors
    /// When shared memory fails.
    pub(crate) fn poll(&mut self) -> Result<(), Failure> {
        let is_new = self.receiver.receive()?;
        let lockstep = self.receiver.lockstep_ns().map(Duration::from_nanos);
        self.now = lockstep.unwrap_or_else(|| self.start.elapsed());
        if is_new {
            self.n_scenes += 1;
            self.received = Some(self.now);
        }
        self.bodies.receive()
    }

    /// Time of the last look, for differences: that of the frames in lockstep, so that a repetition
    /// decides the same.
    pub(crate) fn now(&self) -> Duration {
        self.now
    }

    /// True if the source waits for each frame to be finished.
    pub(crate) fn is_lockstep(&self) -> bool {
        self.receiver.lockstep_ns().is_some()
    }

    /// Begins to count scenes.
    pub(crate) fn begin_look(&mut self) {
        self.n_scenes = 0;
    }

    /// Number of scenes since the begin of the look.
    pub(crate) fn n_scenes(&self) -> u32 {
        self.n_scenes
    }

    /// True if the newest scene shows the present.
    pub(crate) fn is_fresh(&self) -> bool {
        self.received
            .is_some_and(|at| self.now.saturating_sub(at) <= STALE)
    }

    /// Objects of the newest scene; none without a scene.
    pub(crate) fn objects(&self) -> Vec<TableObject> {
        let objects = self.receiver.objects().unwrap_or_default().iter();
        objects.filter_map(table_object).collect()
    }

    /// Scene for the planning of the arm's motions; `None` while the points of an object are missing.
    ///
    /// # Errors
    /// When the image has no depth.
    pub(crate) fn arm_scene(
        &self,
        gripper: GripperModel,
        common: &CommonArguments,
    ) -> Result<Option<ArmScene>, Failure> {
        let Some(snapshot) = self.receiver.snapshot() else {
            return Ok(None);
        };
        let models = || DaemonModels::connect(common);
        ArmScene::new(snapshot, &self.bodies, gripper, models).map(Some)
    }

    /// True if the points of all seen objects have come.
    pub(crate) fn is_complete(&self) -> bool {
        self.receiver.is_complete()
    }

    /// Base of the arm seen from above: the foot of its first link, world, metres.
    pub(crate) fn arm_base(&self) -> Option<Point2<f64>> {
        let first = self.bodies.in_world.robot.first()?;
        Some(first.from.xy())
    }

    /// Distance between the arm and the nearest person, metres; `None` without a person or an arm.
    pub(crate) fn person_distance_m(&self) -> Option<f64> {
        let bodies = &self.bodies.in_world;
        let pairs = bodies
            .people
            .iter()
            .flat_map(|person| bodies.robot.iter().map(move |link| (person, link)));
        pairs
            .map(|(person, link)| distance_m(person, link))
            .min_by(f64::total_cmp)
    }
}

/// Distance between the surfaces of two capsules, metres, by places along both axes.
fn distance_m(person: &Capsule, link: &Capsule) -> f64 {
    let nearest = |of: &Capsule, from: &Capsule| {
        let places = (0..=N_LINK_STEPS).map(|step| {
            let share = f64::from(step) / f64::from(N_LINK_STEPS);
            of.from + (of.to - of.from) * share
        });
        let distances = places.map(|place| from.distance_m(&place) - of.radius_m);
        distances.fold(f64::INFINITY, f64::min)
    };
    nearest(link, person).min(nearest(person, link))
}

/// Object of a scene as a task sees it; `None` without a valid pose.
fn table_object(object: &SceneObject) -> Option<TableObject> {
    let [x, y, z, w] = object.pose.orientation_xyzw;
    let rotation = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-3)?;
    let translation = Translation3::from(object.pose.position_m);
    Some(TableObject {
        track: object.track_id,
        label: object.label().map(str::to_owned),
        answer: object.answer(),
        body: OrientedBox {
            frame_from_box: Isometry3::from_parts(translation, rotation),
            half_sides_m: 0.5 * Vector3::from(object.size_m.map(f64::from)),
        },
        is_seen: is_seen(object),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn distance_of_capsules_is_that_of_their_surfaces() {
        let capsule = |from: [f64; 3], to: [f64; 3]| Capsule {
            from: Point3::from(from),
            to: Point3::from(to),
            radius_m: 0.1,
        };
        let upright = capsule([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        let across = capsule([0.5, 0.0, 0.5], [1.5, 0.0, 0.5]);
        assert!((distance_m(&upright, &across) - 0.3).abs() < 1e-9);
        assert!((distance_m(&across, &upright) - 0.3).abs() < 1e-9);
    }
}
