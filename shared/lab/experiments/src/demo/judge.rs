//! Judge of a demonstration: the only reader of the simulation's truth.

use super::demo_table::{DemoTable, PLACES};
use super::run_record::{Collision, ObjectOutcome};
use channel::topic::TrueObjects;
use channel::{Domain, Error, Subscriber};
use evaluation::disturbance::is_disturbed;
use geometry::RigidTransform;
use message::{SceneObject, TrueState};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Distance between a track and the object that it shows at most, metres.
const SAME_M: f64 = 0.10;
/// Number of frames for which an object that was moved may come to rest.
const SETTLING_FRAMES: u32 = 20;

/// Object as it is in truth.
#[derive(Debug, Clone)]
struct TruthOfObject {
    category: String,
    name: String,
    state: Option<TrueState>,
    pose: RigidTransform,
    /// Pose from which it must not be moved.
    reference: RigidTransform,
    /// Number of frames for which it may move.
    n_free_frames: u32,
}

/// Judge with the newest truth.
pub(super) struct Judge {
    truth: Subscriber<TrueObjects>,
    objects: BTreeMap<u32, TruthOfObject>,
    /// Track of the object that the robot handles, with the object.
    target: Option<(u64, Option<u32>)>,
    pub(super) collisions: Vec<Collision>,
}

impl Judge {
    /// Judge in a domain.
    ///
    /// # Errors
    /// When the topic has no room for it, or shared memory fails.
    pub(super) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            truth: Subscriber::polled(domain)?,
            objects: BTreeMap::new(),
            target: None,
            collisions: Vec::new(),
        })
    }

    /// Takes the truth of a frame. `handled` is the track that the robot handles.
    ///
    /// # Errors
    /// When shared memory fails.
    pub(super) fn look(
        &mut self,
        time_s: f64,
        handled: Option<u64>,
        scene: &[SceneObject],
    ) -> Result<(), Error> {
        let newest = self.truth.latest()?;
        let all = newest.as_ref().map(channel::SharedMessage::items);
        for object in all.unwrap_or_default() {
            let Some(pose) = object.world_from_object.checked() else {
                continue;
            };
            let known = self
                .objects
                .entry(object.id)
                .or_insert_with(|| TruthOfObject {
                    category: object.category.as_str().unwrap_or_default().to_owned(),
                    name: object.name.as_str().unwrap_or_default().to_owned(),
                    state: None,
                    pose,
                    reference: pose,
                    n_free_frames: SETTLING_FRAMES,
                });
            known.pose = pose;
            known.state = TrueState::from_code(object.state);
        }
        self.follow(handled, scene);
        self.find_collisions(time_s);
        Ok(())
    }

    /// Follows which object the robot handles.
    fn follow(&mut self, handled: Option<u64>, scene: &[SceneObject]) {
        if self.target.map(|(track, _)| track) == handled {
            return;
        }
        let track = handled.and_then(|track| scene.iter().find(|one| one.track_id == track));
        let object = track.and_then(|track| self.object_of(track));
        self.target = handled.map(|track| (track, object));
    }

    /// True category of what a track shows; `None` when no object is near.
    pub(super) fn category_of(&self, track: &SceneObject) -> Option<&str> {
        let id = self.object_of(track)?;
        Some(self.objects[&id].category.as_str())
    }

    /// Number of the object nearest to the middle of a track.
    fn object_of(&self, track: &SceneObject) -> Option<u32> {
        let distance_m = |object: &TruthOfObject| {
            let middle_m = Vector3::from(track.pose.position_m);
            (object.pose.translation.vector - middle_m).norm()
        };
        let nearest = self
            .objects
            .iter()
            .min_by(|(_, a), (_, b)| distance_m(a).total_cmp(&distance_m(b)))?;
        (distance_m(nearest.1) <= SAME_M).then_some(*nearest.0)
    }

    /// Finds objects that were moved or tipped, and are not what the robot handles.
    fn find_collisions(&mut self, time_s: f64) {
        let target = self.target.and_then(|(_, object)| object);
        for (id, object) in &mut self.objects {
            if target == Some(*id) {
                object.n_free_frames = SETTLING_FRAMES;
            }
            if object.n_free_frames > 0 {
                object.n_free_frames -= 1;
                object.reference = object.pose;
            } else if is_disturbed(&object.reference, &object.pose) {
                object.n_free_frames = SETTLING_FRAMES;
                self.collisions.push(Collision {
                    time_s,
                    object: object.name.clone(),
                    category: object.category.clone(),
                    handled: self.target.map(|(track, _)| track),
                });
            }
        }
    }

    /// Outcome of each object of the table.
    pub(super) fn outcomes(&self, table: &DemoTable) -> Vec<ObjectOutcome> {
        let outcome = |put: &super::demo_table::DemoObject| {
            let found = self
                .objects
                .values()
                .find(|object| object.category == put.category);
            let at = found.map(|object| object.pose.translation.vector);
            let is_on_floor = found.is_none_or(|object| object.state == Some(TrueState::OnFloor));
            let is_in_place =
                !is_on_floor && at.is_some_and(|at| PLACES[put.place].contains([at.x, at.y]));
            ObjectOutcome {
                category: put.category.clone(),
                name: found.map_or_else(String::new, |object| object.name.clone()),
                is_wanted: put.is_wanted,
                place: PLACES[put.place].name.to_owned(),
                is_in_place,
                is_on_floor,
                position_m: at.map(|at| at.map(|m| (m * 1e4).round() / 1e4).into()),
            }
        };
        table.objects.iter().map(outcome).collect()
    }
}
