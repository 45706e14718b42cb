//! Key-view selection: views of an object at rest after motion.

use geometry::RigidTransform;
use nalgebra::Vector3;

/// Time without motion after which an object is at rest, nanoseconds. Chosen.
const REST_NS: u64 = 700_000_000;

/// Smallest number of poses for the rest test. Chosen.
const N_POSES_MIN: usize = 8;

/// Capacity of the pose ring buffer, whose poses are at least `REST_NS / 24` apart.
const N_POSES_MAX: usize = 32;

/// Standard deviation of the centre below which an object is at rest, metres. Chosen.
const REST_POSITION_SIGMA_M: f64 = 0.004;

/// Standard deviation of the orientation below which an object is at rest, radians (4
/// degrees). Chosen.
const REST_ROTATION_SIGMA_RAD: f64 = 0.069_8;

/// Displacement between consecutive poses above which the object moves, metres. Chosen.
const STEP_MAX_M: f64 = 0.010;

/// Rotation between consecutive poses above which the object moves, radians (8 degrees).
/// Chosen.
const STEP_MAX_RAD: f64 = 0.14;

/// Displacement from the last key view above which the object was moved, metres. Chosen.
const MOVED_DISTANCE_M: f64 = 0.025;

/// Rotation from the last key view above which the object was moved, radians (15
/// degrees). Chosen.
const MOVED_ANGLE_RAD: f64 = 0.262;

/// Motion phase of an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionPhase {
    /// Object at rest at the pose of its last key view.
    Static,
    /// Object in motion.
    Moving,
    /// Object stopped, and is possibly coming to rest.
    Settling,
}

/// Key-view rule: the first view, and the first view at rest after each motion. The
/// first view counts even when the image border truncates it, so that every object can
/// be taught. Later key views must show the whole object; after a truncated first view
/// the next whole view is key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeyViewRule {
    phase: MotionPhase,
    has_begun: bool,
    key_pose: Option<RigidTransform>,
    /// Ring buffer of the poses since the object stopped; `n_poses` are valid, the
    /// newest lies before `next`.
    poses: [(u64, RigidTransform); N_POSES_MAX],
    n_poses: usize,
    next: usize,
}

impl Default for KeyViewRule {
    fn default() -> Self {
        Self {
            phase: MotionPhase::Static,
            has_begun: false,
            key_pose: None,
            poses: [(0, RigidTransform::identity()); N_POSES_MAX],
            n_poses: 0,
            next: 0,
        }
    }
}

impl KeyViewRule {
    /// Next view; returns `true` for a key view. `pose` is the filtered pose of the
    /// object's box in the world, stamps are capture stamps.
    pub fn update(
        &mut self,
        stamp_ns: u64,
        pose: &RigidTransform,
        touches_image_border: bool,
    ) -> bool {
        let is_first = !std::mem::replace(&mut self.has_begun, true);
        let Some(key_pose) = self.key_pose else {
            return self.accept_key_view(pose, !touches_image_border) || is_first;
        };
        if self.phase == MotionPhase::Static {
            if differ_by_more_than(&key_pose, pose, MOVED_DISTANCE_M, MOVED_ANGLE_RAD) {
                self.phase = MotionPhase::Moving;
                self.restart(stamp_ns, pose);
            }
            return false;
        }
        if self
            .newest()
            .is_some_and(|last| differ_by_more_than(&last.1, pose, STEP_MAX_M, STEP_MAX_RAD))
        {
            self.phase = MotionPhase::Moving;
            self.restart(stamp_ns, pose);
            return false;
        }
        self.phase = MotionPhase::Settling;
        self.remember(stamp_ns, pose);
        let rests = self.is_at_rest(stamp_ns);
        rests && self.accept_key_view(pose, !touches_image_border)
    }

    /// Motion phase of the object.
    pub fn phase(&self) -> MotionPhase {
        self.phase
    }

    fn accept_key_view(&mut self, pose: &RigidTransform, is_whole: bool) -> bool {
        if is_whole {
            self.key_pose = Some(*pose);
            self.phase = MotionPhase::Static;
        }
        is_whole
    }

    fn restart(&mut self, stamp_ns: u64, pose: &RigidTransform) {
        (self.n_poses, self.next) = (0, 0);
        self.remember(stamp_ns, pose);
    }

    /// Stores a pose, unless the last one is too recent for the ring to cover the rest
    /// time.
    fn remember(&mut self, stamp_ns: u64, pose: &RigidTransform) {
        let due = |last: &(u64, RigidTransform)| stamp_ns.saturating_sub(last.0) >= REST_NS / 24;
        if self.newest().is_none_or(due) {
            self.poses[self.next] = (stamp_ns, *pose);
            self.next = (self.next + 1) % N_POSES_MAX;
            self.n_poses = (self.n_poses + 1).min(N_POSES_MAX);
        }
    }

    fn newest(&self) -> Option<&(u64, RigidTransform)> {
        self.newest_first().next()
    }

    fn newest_first(&self) -> impl Iterator<Item = &(u64, RigidTransform)> {
        (1..=self.n_poses).map(|back| &self.poses[(self.next + N_POSES_MAX - back) % N_POSES_MAX])
    }

    /// True if the poses of the last 0.7 s, and at least eight, have a small standard
    /// deviation.
    fn is_at_rest(&self, stamp_ns: u64) -> bool {
        let is_recent = |stamp: u64| stamp_ns.saturating_sub(stamp) <= REST_NS;
        let n_recent = self
            .newest_first()
            .take_while(|pose| is_recent(pose.0))
            .count();
        let n_judged = n_recent.max(N_POSES_MIN);
        // The rest interval begins with a pose at least as old as the rest time.
        let covers = self
            .newest_first()
            .any(|pose| stamp_ns.saturating_sub(pose.0) >= REST_NS);
        if self.n_poses < n_judged || !covers {
            return false;
        }
        let Some((_, reference)) = self.newest() else {
            return false;
        };
        let judged = || self.newest_first().take(n_judged).map(|(_, pose)| pose);
        let position = standard_deviation(
            judged().map(|pose| pose.translation.vector - reference.translation.vector),
        );
        let rotation = standard_deviation(
            judged().map(|pose| reference.rotation.rotation_to(&pose.rotation).scaled_axis()),
        );
        position < REST_POSITION_SIGMA_M && rotation < REST_ROTATION_SIGMA_RAD
    }
}

/// True if two poses differ by more than a distance or an angle.
fn differ_by_more_than(a: &RigidTransform, b: &RigidTransform, metres: f64, radians: f64) -> bool {
    (a.translation.vector - b.translation.vector).norm() > metres
        || a.rotation.angle_to(&b.rotation) > radians
}

/// Standard deviation of vectors about their mean, all axes combined.
fn standard_deviation(vectors: impl Iterator<Item = Vector3<f64>>) -> f64 {
    let (mut n, mut sum, mut squares) = (0.0, Vector3::zeros(), 0.0);
    for vector in vectors {
        n += 1.0;
        sum += vector;
        squares += vector.norm_squared();
    }
    (squares / n - (sum / n).norm_squared()).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FRAME_NS: u64 = 33_333_333;

    fn at(x: f64, yaw_rad: f64) -> RigidTransform {
        RigidTransform::new(Vector3::new(x, 0.0, 0.0), Vector3::z() * yaw_rad)
    }

    /// Indices of the key frames at 30 frames per second.
    fn key_frames(poses: &[(RigidTransform, bool)]) -> Vec<usize> {
        let mut rule = KeyViewRule::default();
        let mut stamps = (0..).map(|frame| frame * FRAME_NS);
        let mut is_key =
            |&(pose, cut): &(RigidTransform, bool)| rule.update(stamps.next().unwrap(), &pose, cut);
        (0..poses.len()).filter(|&i| is_key(&poses[i])).collect()
    }

    fn rest(x: f64, n: usize) -> Vec<(RigidTransform, bool)> {
        vec![(at(x, 0.0), false); n]
    }

    fn slide(from: f64, to: f64, n: usize) -> Vec<(RigidTransform, bool)> {
        (0..n)
            .map(|i| (at(from + (to - from) * i as f64 / n as f64, 0.0), false))
            .collect()
    }

    #[test]
    fn the_first_view_is_key_and_rest_adds_none() {
        assert_eq!(key_frames(&rest(0.0, 200)), [0]);
    }

    #[test]
    fn lasting_rest_after_motion_is_key_once() {
        let story = [rest(0.0, 30), slide(0.0, 0.4, 20), rest(0.4, 60)].concat();
        let keys = key_frames(&story);
        assert_eq!(keys.len(), 2, "{keys:?}");
        // The slide ends at frame 50, rest is 0.7 s or 21 frames.
        assert!((70..=74).contains(&keys[1]), "{keys:?}");
        let short = [
            rest(0.0, 30),
            slide(0.0, 0.4, 20),
            rest(0.4, 15),
            slide(0.4, 0.8, 20),
        ]
        .concat();
        assert_eq!(key_frames(&short), [0]);
    }

    #[test]
    fn a_rotation_in_place_is_motion() {
        let turn = (0..20)
            .map(|i| (at(0.0, 0.05 * f64::from(i)), false))
            .collect();
        let turned = vec![(at(0.0, 1.0), false); 40];
        assert_eq!(key_frames(&[rest(0.0, 10), turn, turned].concat()).len(), 2);
    }

    #[test]
    fn slow_motion_is_not_rest() {
        // 2 cm a second never stays below a standard deviation of 4 mm over 0.7 s.
        let creep = slide(0.0, 2.0, 3000);
        assert_eq!(key_frames(&creep), [0]);
    }

    #[test]
    fn a_truncated_view_is_key_only_as_the_first_and_then_the_next_whole_one() {
        let cut = |x: f64, n: usize| vec![(at(x, 0.0), true); n];
        assert_eq!(key_frames(&[cut(0.0, 10), rest(0.0, 10)].concat()), [0, 10]);
        let story = [
            rest(0.0, 5),
            slide(0.0, 0.4, 20),
            cut(0.4, 50),
            rest(0.4, 5),
        ]
        .concat();
        assert_eq!(key_frames(&story), [0, 75]);
    }

    #[test]
    fn a_slow_camera_needs_eight_poses() {
        let mut rule = KeyViewRule::default();
        let second = 1_000_000_000;
        assert!(rule.update(0, &at(0.0, 0.0), false));
        let keys: Vec<u64> = (1..20)
            .filter(|i| rule.update(i * second, &at(0.3, 0.0), false))
            .collect();
        assert_eq!(keys, [8]);
    }

    proptest! {
        #[test]
        fn a_replay_and_a_copy_decide_alike(
            steps in prop::collection::vec((0..200_000_000_u64, -0.02..0.02_f64, any::<bool>()), 1..200),
            cut in 0..200_usize,
        ) {
            let (mut stamp, mut x) = (0, 0.0);
            let mut rule = KeyViewRule::default();
            let mut copy = rule;
            for (i, (dt, dx, touches)) in steps.into_iter().enumerate() {
                stamp += dt;
                x += if i % 50 < 30 { dx * 0.01 } else { dx };
                if i == cut { copy = rule; }
                let is_key = rule.update(stamp, &at(x, 0.0), touches);
                prop_assert!(!(is_key && touches) || i == 0);
                prop_assert!(!is_key || rule.phase() == MotionPhase::Static);
                if i >= cut {
                    prop_assert_eq!(is_key, copy.update(stamp, &at(x, 0.0), touches));
                }
            }
        }
    }
}
