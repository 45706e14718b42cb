//! World model updater: feeds the newest scene and the arm state to the working memory a
//! few times a second.

use crate::question_asker::QuestionAsker;
use crate::working_memory::{WorkingMemory, now_ns};
use channel::topic::{ArmStates, Scene};
use channel::{Domain, Error, SharedMessage, Subscriber};
use control_protocol::QuestionReport;
use message::{
    ArmActivity, ArmState, SceneObject, SceneSummary, Span, Stage, TrackState, frame_flag,
};
use scene_document::{CategoryAnswer, ObjectDocument};
use service::{Stopwatch, TracePublisher, monotonic_ns};
use std::sync::Arc;
use std::time::{Duration, Instant};
use working_memory::{BoxPose, Outcome, RobotSighting, Sighting, SurfaceSighting, WorldModel};

/// Time without arm states after which the arm counts as absent. Chosen.
const ARM_SILENCE: Duration = Duration::from_secs(5);

/// Periodic updater of the world model.
pub(crate) struct WorldModelUpdater {
    world: Arc<WorkingMemory>,
    arm: Subscriber<ArmStates>,
    arm_heard: Instant,
    /// Newest scene that the model has not seen.
    scene: Option<SharedMessage<Scene>>,
    /// Objects of a scene, copied out of shared memory: what is checked is what is used.
    objects: Vec<SceneObject>,
    /// Numbers of the surfaces of the scene in the world model; `None` before they are kept.
    surfaces: Vec<Option<u64>>,
    asker: QuestionAsker,
}

impl WorldModelUpdater {
    pub(crate) fn new(domain: &Domain, world: Arc<WorkingMemory>) -> Result<Self, Error> {
        Ok(Self {
            world,
            arm: Subscriber::polled(domain)?,
            arm_heard: Instant::now(),
            scene: None,
            objects: Vec::new(),
            surfaces: Vec::new(),
            asker: QuestionAsker::default(),
        })
    }

    /// Keeps a scene for the next update, and releases the one before.
    pub(crate) fn keep(&mut self, scene: SharedMessage<Scene>) {
        self.world.set_scene_time(scene.header().time());
        self.scene = Some(scene);
    }

    /// Updates the model with the newest scene and arm state, and traces the time.
    pub(crate) fn look(&mut self, trace: &mut TracePublisher) -> Result<(), Error> {
        if let Some(scene) = self.scene.take() {
            let mut watch = Stopwatch::start();
            let (summary, begin_ns) = (scene.header(), watch.begin_ns());
            let published_ns = summary.stamps.published_ns;
            self.objects.clear();
            self.objects.extend_from_slice(scene.items());
            self.show(summary);
            let waited = Span::waiting(Stage::WorldWait, 0, published_ns, begin_ns);
            trace.send(summary, &[waited, watch.lap(Stage::WorldUpdate, 0)]);
        }
        if let Some(arm) = self.arm.latest()? {
            self.arm_heard = Instant::now();
            if let Some(robot) = robot(arm.header()) {
                self.world
                    .with(|model| model.observe_robot(&robot, now_ns()));
            }
        } else if self.arm_heard.elapsed() > ARM_SILENCE {
            self.world.with(WorldModel::lose_robot);
        }
        Ok(())
    }

    fn show(&mut self, scene: &SceneSummary) {
        let captured_ns = now_ns().saturating_sub(age_ns(scene, monotonic_ns()));
        let is_whole = scene.n_objects_total as usize <= self.objects.len();
        let (objects, numbers) = (&self.objects, &mut self.surfaces);
        self.world.with(|model| {
            model.observe_surfaces(surface_sightings(scene), captured_ns, numbers);
            let seen = objects.iter().filter_map(|object| {
                let carrier = message::document::carrier(scene, object);
                let surface = carrier.and_then(|index| *numbers.get(index)?);
                let seen = sighting(object, scene.stamps.capture_ns, captured_ns)?;
                Some(Sighting { surface, ..seen })
            });
            model.observe(seen, is_whole, captured_ns);
        });
        self.ask(scene, captured_ns);
    }

    /// Records the question of the scene when it is due.
    fn ask(&mut self, scene: &SceneSummary, captured_ns: u64) {
        let objects = &self.objects;
        self.asker
            .retain(|track_id| objects.iter().any(|object| object.track_id == track_id));
        let asked = self.asker.asked();
        let unasked = objects
            .iter()
            .filter(|object| !asked.contains(&object.track_id));
        let reports: Vec<ObjectDocument> = unasked
            .map(|object| {
                message::document::object(object, scene.time(), scene.stamps.published_ns)
            })
            .collect();
        let question = QuestionReport::most_useful(&reports);
        if self
            .asker
            .is_due(question.as_ref(), scene.stamps.capture_ns)
            && let Some(question) = question
        {
            let category = question.categories.into_iter().next();
            let category = category.map(|near| near.label);
            let (track_id, sentence) = (question.track_id, question.sentence);
            self.world
                .with(|model| model.record_question(track_id, category, sentence, captured_ns));
        }
    }
}

/// Age of a scene since its capture, nanoseconds. In lockstep the stamps are of no clock
/// here, and the age is 0.
fn age_ns(scene: &SceneSummary, monotonic_ns: u64) -> u64 {
    if scene.frame_flags & frame_flag::LOCKSTEP != 0 {
        return 0;
    }
    monotonic_ns.saturating_sub(scene.stamps.capture_ns)
}

/// Valid surfaces of a scene as observations of the model.
fn surface_sightings(scene: &SceneSummary) -> impl Iterator<Item = SurfaceSighting<'_>> {
    let valid = scene.surfaces().iter();
    valid.filter_map(|surface| {
        let kind = surface.checked_kind()?;
        let corners_m = surface.corners_m();
        let are_finite = corners_m.iter().flatten().all(|value| value.is_finite());
        Some(SurfaceSighting {
            kind: kind.word(),
            plane: surface.plane,
            corners_m: if are_finite { corners_m } else { &[] },
        })
    })
}

/// Object of a scene as an observation of the model; `None` for invalid numbers. The stamps count
/// from `capture_ns`, which was at `captured_ns`.
fn sighting(object: &SceneObject, capture_ns: u64, captured_ns: u64) -> Option<Sighting<'_>> {
    let state = TrackState::from_code(object.state)?;
    object.pose.checked()?;
    let size_m = object.size_m.map(f64::from);
    if !size_m.iter().all(|side| side.is_finite()) {
        return None;
    }
    let wall_ns = |stamp_ns: u64| captured_ns.saturating_sub(capture_ns.saturating_sub(stamp_ns));
    Some(Sighting {
        track_id: object.track_id,
        state: state.word(),
        label: object.label(),
        is_probable: object.answer() == CategoryAnswer::Probably,
        place: BoxPose {
            position_m: object.pose.position_m,
            orientation_xyzw: object.pose.orientation_xyzw,
            size_m,
        },
        surface: None,
        first_seen_ns: wall_ns(object.first_seen_ns),
        last_seen_ns: wall_ns(object.last_seen_ns),
    })
}

/// Arm state as an observation of the model; `None` for invalid numbers.
fn robot(arm: &ArmState) -> Option<RobotSighting<'_>> {
    let activity = ArmActivity::from_code(arm.activity)?;
    arm.world_from_gripper.checked()?;
    let mut numbers = arm.joint_angles_rad.iter().chain([&arm.opening_m]);
    if !numbers.all(|number| number.is_finite()) {
        return None;
    }
    let outcome = match activity {
        ArmActivity::Idle => Some(Outcome::Succeeded),
        ArmActivity::Failed => Some(Outcome::Failed),
        ArmActivity::Stopped => Some(Outcome::Cancelled),
        ArmActivity::Moving | ArmActivity::Opening | ArmActivity::Closing => None,
    };
    Some(RobotSighting {
        activity: activity.word(),
        outcome,
        command_id: arm.command_id,
        note: arm.note.as_str().unwrap_or_default(),
        is_holding: arm.is_holding == 1,
        opening_m: arm.opening_m,
        joint_angles_rad: &arm.joint_angles_rad,
        position_m: arm.world_from_gripper.position_m,
        orientation_xyzw: arm.world_from_gripper.orientation_xyzw,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use message::WirePose;

    fn object() -> SceneObject {
        SceneObject {
            track_id: 7,
            state: TrackState::Tracked.code(),
            pose: WirePose {
                position_m: [0.1, 0.2, 0.3],
                orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            },
            first_seen_ns: 100,
            last_seen_ns: 900,
            ..SceneObject::default()
        }
    }

    #[test]
    fn stamps_are_converted_to_the_wall_clock() {
        let object = object();
        let seen = sighting(&object, 1_000, 50_000).unwrap();
        assert_eq!((seen.first_seen_ns, seen.last_seen_ns), (49_100, 49_900));
        let mut scene = SceneSummary::default();
        scene.stamps.capture_ns = 1_000;
        assert_eq!(age_ns(&scene, 1_500), 500);
        scene.frame_flags = frame_flag::LOCKSTEP;
        assert_eq!(age_ns(&scene, 1_500), 0);
    }

    #[test]
    fn invalid_objects_are_not_observed() {
        let seen = |change: &dyn Fn(&mut SceneObject)| {
            let mut object = object();
            change(&mut object);
            sighting(&object, 1_000, 1_000).is_some()
        };
        assert!(seen(&|_| ()));
        assert!(!seen(&|o| o.state = 77));
        assert!(!seen(&|o| o.pose.position_m[1] = f64::NAN));
        assert!(!seen(&|o| o.pose.orientation_xyzw = [0.0; 4]));
        assert!(!seen(&|o| o.size_m[2] = f32::INFINITY));
    }

    #[test]
    fn arm_activity_gives_the_outcome_of_a_command() {
        let arm = |activity: ArmActivity| ArmState {
            activity: activity.code(),
            world_from_gripper: object().pose,
            ..ArmState::default()
        };
        let outcome = |activity| robot(&arm(activity)).unwrap().outcome;
        assert_eq!(outcome(ArmActivity::Moving), None);
        assert_eq!(outcome(ArmActivity::Idle), Some(Outcome::Succeeded));
        assert_eq!(outcome(ArmActivity::Failed), Some(Outcome::Failed));
        assert_eq!(outcome(ArmActivity::Stopped), Some(Outcome::Cancelled));
        let broken = ArmState {
            opening_m: f64::NAN,
            ..arm(ArmActivity::Idle)
        };
        assert!(robot(&broken).is_none());
    }
}
