//! Which views of an object are worth keeping.

use geometry::RigidTransform;
use nalgebra::Vector3;

/// An object is at rest when it has been for this long.
const REST_NS: u64 = 700_000_000;

/// Fewest poses from which rest is judged.
const N_POSES_MIN: usize = 8;

/// Poses kept; they are taken at least `REST_NS / 24` apart.
const N_POSES_MAX: usize = 32;

/// At rest the centre scatters less, metres.
const REST_POSITION_SIGMA_M: f64 = 0.004;

/// At rest the orientation scatters less, radians (4 degrees).
const REST_ROTATION_SIGMA_RAD: f64 = 0.069_8;

/// A larger step from one pose to the next is motion, metres.
const STEP_MAX_M: f64 = 0.010;

/// A larger turn from one pose to the next is motion, radians (8 degrees).
const STEP_MAX_RAD: f64 = 0.14;

/// An object this far from its last key view was moved, metres.
const MOVED_M: f64 = 0.025;

/// An object turned this far from its last key view was moved, radians
/// (15 degrees).
const MOVED_RAD: f64 = 0.262;

/// What an object does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionPhase {
    /// It stands where its last key view was taken.
    Static,
    /// It is being moved.
    Moving,
    /// It has stopped and may come to rest.
    Settling,
}

/// Decides which views are key views: the first one, and the first one at rest
/// after each motion. The very first is key even when the border of the image
/// cuts it, so that whatever is seen can be taught; of later ones only whole
/// views are, and after a cut first view the next whole one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeyViewRule {
    phase: MotionPhase,
    has_begun: bool,
    key_pose: Option<RigidTransform>,
    /// Poses since the object stopped, a ring; `n_poses` of them, newest before `next`.
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
    /// Takes the next view; returns whether it is a key view. The pose is that
    /// of the object's box in the world, filtered; stamps are those of capture.
    pub fn take(
        &mut self,
        stamp_ns: u64,
        pose: &RigidTransform,
        touches_image_border: bool,
    ) -> bool {
        let is_first = !std::mem::replace(&mut self.has_begun, true);
        let Some(key_pose) = self.key_pose else {
            return self.take_key(pose, !touches_image_border) || is_first;
        };
        if self.phase == MotionPhase::Static {
            if is_apart(&key_pose, pose, MOVED_M, MOVED_RAD) {
                self.phase = MotionPhase::Moving;
                self.restart(stamp_ns, pose);
            }
            return false;
        }
        if self
            .newest()
            .is_some_and(|last| is_apart(&last.1, pose, STEP_MAX_M, STEP_MAX_RAD))
        {
            self.phase = MotionPhase::Moving;
            self.restart(stamp_ns, pose);
            return false;
        }
        self.phase = MotionPhase::Settling;
        self.remember(stamp_ns, pose);
        let rests = self.is_at_rest(stamp_ns);
        rests && self.take_key(pose, !touches_image_border)
    }

    /// What the object does.
    pub fn phase(&self) -> MotionPhase {
        self.phase
    }

    fn take_key(&mut self, pose: &RigidTransform, is_whole: bool) -> bool {
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

    /// Keeps a pose, unless the last one is too recent for the ring to cover
    /// the time of rest.
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

    /// Whether the poses of the last 0.7 s, and at least eight, scatter little.
    fn is_at_rest(&self, stamp_ns: u64) -> bool {
        let is_recent = |stamp: u64| stamp_ns.saturating_sub(stamp) <= REST_NS;
        let n_recent = self
            .newest_first()
            .take_while(|pose| is_recent(pose.0))
            .count();
        let n_judged = n_recent.max(N_POSES_MIN);
        // Rest begins with a pose that is as old as the time of rest.
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
        let position =
            scatter(judged().map(|pose| pose.translation.vector - reference.translation.vector));
        let rotation = scatter(
            judged().map(|pose| reference.rotation.rotation_to(&pose.rotation).scaled_axis()),
        );
        position < REST_POSITION_SIGMA_M && rotation < REST_ROTATION_SIGMA_RAD
    }
}

/// Whether two poses differ by more than a distance or an angle.
fn is_apart(a: &RigidTransform, b: &RigidTransform, metres: f64, radians: f64) -> bool {
    (a.translation.vector - b.translation.vector).norm() > metres
        || a.rotation.angle_to(&b.rotation) > radians
}

/// Standard deviation of vectors around their mean, all axes together.
fn scatter(vectors: impl Iterator<Item = Vector3<f64>>) -> f64 {
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

    /// The frames, of 30 a second, whose views are key.
    fn key_frames(poses: &[(RigidTransform, bool)]) -> Vec<usize> {
        let mut rule = KeyViewRule::default();
        let mut stamps = (0..).map(|frame| frame * FRAME_NS);
        let mut is_key =
            |&(pose, cut): &(RigidTransform, bool)| rule.take(stamps.next().unwrap(), &pose, cut);
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
    fn rest_after_motion_is_key_once_and_only_when_it_lasts() {
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
    fn a_turn_in_place_is_motion() {
        let turn = (0..20)
            .map(|i| (at(0.0, 0.05 * f64::from(i)), false))
            .collect();
        let turned = vec![(at(0.0, 1.0), false); 40];
        assert_eq!(key_frames(&[rest(0.0, 10), turn, turned].concat()).len(), 2);
    }

    #[test]
    fn slow_creeping_is_no_rest() {
        // 2 cm a second never scatters less than 4 mm over 0.7 s.
        let creep = slide(0.0, 2.0, 3000);
        assert_eq!(key_frames(&creep), [0]);
    }

    #[test]
    fn of_cut_views_only_the_first_is_key_and_then_the_next_whole_one() {
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
        assert!(rule.take(0, &at(0.0, 0.0), false));
        let keys: Vec<u64> = (1..20)
            .filter(|i| rule.take(i * second, &at(0.3, 0.0), false))
            .collect();
        assert_eq!(keys, [8]);
    }

    proptest! {
        #[test]
        fn a_replay_decides_the_same_and_a_copy_goes_on_alike(
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
                let is_key = rule.take(stamp, &at(x, 0.0), touches);
                prop_assert!(!(is_key && touches) || i == 0);
                prop_assert!(!is_key || rule.phase() == MotionPhase::Static);
                if i >= cut {
                    prop_assert_eq!(is_key, copy.take(stamp, &at(x, 0.0), touches));
                }
            }
        }
    }
}
