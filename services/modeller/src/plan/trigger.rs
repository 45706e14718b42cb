//! Trigger of a new plan: the camera has moved and stands still, or the objects have changed.

use geometry::RigidTransform;
use message::SceneObject;
use nalgebra::Point3;
use std::time::{Duration, Instant};

/// Motion from which on a pose is another view: metres and radians (5°). Chosen.
const MOVED_M: f64 = 0.05;
const MOVED_RAD: f64 = 0.087;
/// Motion up to which the camera stands still: metres and radians (1°), for a time. Chosen.
const STILL_M: f64 = 0.01;
const STILL_RAD: f64 = 0.0175;
const STILL_TIME: Duration = Duration::from_millis(400);
/// Motion from which on an object is at another place, metres. Chosen.
const OBJECT_MOVED_M: f64 = 0.03;

/// Pose of the camera and the objects as they were.
#[derive(Debug, Clone, PartialEq)]
struct Observed {
    world_from_camera: Option<RigidTransform>,
    objects: Vec<ObservedObject>,
}

#[derive(Debug, Clone, PartialEq)]
struct ObservedObject {
    track: u64,
    label: Option<String>,
    middle_in_world: Point3<f64>,
}

/// Trigger with what it has observed.
#[derive(Debug, Default)]
pub(crate) struct PlanTrigger {
    /// Observation at the last plan.
    planned: Option<Observed>,
    /// Observation from which on nothing has changed, and its time.
    still: Option<(Observed, Instant)>,
}

impl PlanTrigger {
    /// Notes a scene; true when a new plan is due. The first scene is due at once.
    pub(crate) fn note(
        &mut self,
        world_from_camera: Option<RigidTransform>,
        objects: &[SceneObject],
        now: Instant,
    ) -> bool {
        let object = |object: &SceneObject| ObservedObject {
            track: object.track_id,
            label: object.label().map(str::to_owned),
            middle_in_world: object.pose.position_m.into(),
        };
        let observed = Observed {
            world_from_camera,
            objects: objects.iter().map(object).collect(),
        };
        let Some(planned) = &self.planned else {
            self.still = Some((observed, now));
            return true;
        };
        let is_still = self
            .still
            .as_ref()
            .is_some_and(|(before, _)| is_near(before, &observed, [STILL_M, STILL_RAD]));
        if !is_still {
            self.still = Some((observed, now));
            return false;
        }
        let since = self.still.as_ref().map(|(_, since)| *since);
        let has_settled = since.is_some_and(|since| now.duration_since(since) >= STILL_TIME);
        has_settled && !is_near(planned, &observed, [MOVED_M, MOVED_RAD])
    }

    /// Notes that a plan of the newest scene was made.
    pub(crate) fn planned(&mut self) {
        self.planned = self.still.as_ref().map(|(observed, _)| observed.clone());
    }
}

/// True if the camera is within the bounds of its earlier pose and the objects are the same.
fn is_near(before: &Observed, now: &Observed, [way_m, turn_rad]: [f64; 2]) -> bool {
    let is_camera_near = match (before.world_from_camera, now.world_from_camera) {
        (Some(before), Some(now)) => {
            let way = now.translation.vector - before.translation.vector;
            way.norm() <= way_m && before.rotation.angle_to(&now.rotation) <= turn_rad
        }
        (None, None) => true,
        _ => false,
    };
    let is_same = |(a, b): (&ObservedObject, &ObservedObject)| {
        let way_m = (a.middle_in_world - b.middle_in_world).norm();
        a.track == b.track && a.label == b.label && way_m <= OBJECT_MOVED_M
    };
    is_camera_near
        && before.objects.len() == now.objects.len()
        && before.objects.iter().zip(&now.objects).all(is_same)
}

#[cfg(test)]
mod tests {
    use super::*;
    use message::Text;

    fn object(track_id: u64, label: &str, x: f64) -> SceneObject {
        let mut object = SceneObject {
            track_id,
            is_labelled: u32::from(!label.is_empty()),
            label: Text::truncated(label),
            ..SceneObject::default()
        };
        object.pose.position_m = [x, 0.0, 0.0];
        object
    }

    /// Times in tenths of a second at which plans are made, for scenes at these times.
    fn plans(scenes: &[(u64, Option<f64>, Vec<SceneObject>)]) -> Vec<u64> {
        let begun = Instant::now();
        let mut trigger = PlanTrigger::default();
        let mut times = Vec::new();
        for (tenths, x, objects) in scenes {
            let now = begun + Duration::from_millis(100 * tenths);
            let pose = x.map(|x| RigidTransform::translation(x, 0.0, 1.0));
            if trigger.note(pose, objects, now) {
                trigger.planned();
                times.push(*tenths);
            }
        }
        times
    }

    #[test]
    fn plan_is_made_at_once_and_when_a_moved_camera_stands_still() {
        let mug = vec![object(1, "", 0.0)];
        let at = |tenths: u64| {
            // From the tenth scene to the twentieth it moves by 2 cm each.
            let x = 0.02 * tenths.clamp(10, 20) as f64;
            (tenths, Some(x), mug.clone())
        };
        let scenes: Vec<_> = (0..40).map(at).collect();
        assert_eq!(plans(&scenes), [0, 24]);
        // A tremble of 4 mm, and a way of 4 cm, are no other view.
        let tremble = |tenths: u64| (tenths, Some(0.004 * (tenths % 2) as f64), mug.clone());
        assert_eq!(plans(&(0..40).map(tremble).collect::<Vec<_>>()), [0]);
        let near = |tenths: u64| (tenths, Some(0.004 * tenths.min(10) as f64), mug.clone());
        assert_eq!(plans(&(0..40).map(near).collect::<Vec<_>>()), [0]);
    }

    #[test]
    fn plan_is_made_when_the_objects_change_even_without_a_pose() {
        let scene = |tenths: u64| {
            let objects = match tenths {
                0..10 => vec![object(1, "", 0.0)],
                10..20 => vec![object(1, "", 0.0), object(2, "", 0.3)],
                20..30 => vec![object(1, "mug", 0.0), object(2, "", 0.3)],
                _ => vec![object(1, "mug", 0.1), object(2, "", 0.3)],
            };
            (tenths, None, objects)
        };
        let scenes: Vec<_> = (0..40).map(scene).collect();
        assert_eq!(plans(&scenes), [0, 14, 24, 34]);
    }
}
