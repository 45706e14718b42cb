//! Synchronised point-to-point trajectory of all joints.

use crate::trapezoidal_profile::TrapezoidalProfile;
use crate::{JointVector, KinematicChain, N_JOINTS};

/// Joint angles and velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointState {
    /// Joint angles, radians.
    pub angles_rad: JointVector,
    /// Joint velocities, rad/s.
    pub velocities_rad_s: JointVector,
}

impl JointState {
    /// Joint state at rest: given angles, zero velocities.
    pub fn at_rest(angles_rad: JointVector) -> Self {
        Self {
            angles_rad,
            velocities_rad_s: JointVector::zeros(),
        }
    }

    /// True if all joint velocities are zero.
    pub fn is_at_rest(&self) -> bool {
        self.velocities_rad_s == JointVector::zeros()
    }
}

/// Point-to-point motion in which all joints arrive together, in the time that the slowest joint
/// needs.
///
/// Each joint accelerates, cruises and brakes within its own limits (Kröger and Wahl 2010, type
/// II: velocity and acceleration are bounded), from any initial velocity. Position and velocity
/// are continuous in time. Since braking uses the same acceleration in every motion, a motion
/// that ends within the joint limits can be replaced at any time by another one that stays within
/// them. From rest all joints keep step (phase synchronisation): the way is straight in joint space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointTrajectory {
    profiles: [TrapezoidalProfile; N_JOINTS],
    duration_s: f64,
}

impl JointTrajectory {
    /// Fastest motion from `start` to rest at `target_rad`. `speed`, in (0, 1], scales the
    /// maximum joint velocities; accelerations are the maximum at every speed.
    pub fn new(
        chain: &KinematicChain,
        start: &JointState,
        target_rad: &JointVector,
        speed: f64,
    ) -> Self {
        if start.is_at_rest() {
            return Self::straight(chain, &start.angles_rad, target_rad, speed);
        }
        let fastest = std::array::from_fn(|i| {
            let joint = &chain.joints[i];
            TrapezoidalProfile::fastest(
                start.angles_rad[i],
                start.velocities_rad_s[i],
                target_rad[i],
                joint.max_velocity_rad_s * speed,
                joint.max_acceleration_rad_s2,
            )
        });
        let longest = Self::synchronised(&fastest);
        Self {
            profiles: fastest.map(|profile| profile.stretched_to(longest.duration_s)),
            ..longest
        }
    }

    /// Motion from rest to rest in which all joints keep step, each within its limits.
    fn straight(
        chain: &KinematicChain,
        start_rad: &JointVector,
        target_rad: &JointVector,
        speed: f64,
    ) -> Self {
        let way_rad = target_rad - start_rad;
        // Shares of the way in a second, and in a second squared, that every joint can do.
        let (mut velocity, mut acceleration) = (f64::INFINITY, f64::INFINITY);
        for (joint, way_rad) in chain.joints.iter().zip(&way_rad) {
            if *way_rad != 0.0 {
                velocity = velocity.min(joint.max_velocity_rad_s * speed / way_rad.abs());
                acceleration = acceleration.min(joint.max_acceleration_rad_s2 / way_rad.abs());
            }
        }
        Self::synchronised(&std::array::from_fn(|i| {
            let (joint, way_rad) = (&chain.joints[i], way_rad[i].abs());
            let [max_speed, acceleration] = if way_rad > 0.0 {
                [velocity, acceleration].map(|share| share * way_rad)
            } else {
                [joint.max_velocity_rad_s, joint.max_acceleration_rad_s2]
            };
            TrapezoidalProfile::fastest(start_rad[i], 0.0, target_rad[i], max_speed, acceleration)
        }))
    }

    /// Braking trajectory: each joint comes to rest as soon as possible.
    pub fn braking(chain: &KinematicChain, start: &JointState) -> Self {
        Self::synchronised(&std::array::from_fn(|i| {
            TrapezoidalProfile::braking(
                start.angles_rad[i],
                start.velocities_rad_s[i],
                chain.joints[i].max_acceleration_rad_s2,
            )
        }))
    }

    fn synchronised(profiles: &[TrapezoidalProfile; N_JOINTS]) -> Self {
        let duration_s = profiles
            .iter()
            .map(TrapezoidalProfile::duration_s)
            .fold(0.0, f64::max);
        Self {
            profiles: *profiles,
            duration_s,
        }
    }

    /// Duration of the trajectory, seconds.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Joint state at a time since the start, seconds; from the end on exactly at the target and
    /// at rest.
    pub fn sample(&self, time_s: f64) -> JointState {
        // Durations agree only up to rounding; at the end every joint has arrived.
        let time_s = if time_s < self.duration_s {
            time_s
        } else {
            f64::INFINITY
        };
        let mut state = JointState::at_rest(JointVector::zeros());
        for (i, profile) in self.profiles.iter().enumerate() {
            (state.angles_rad[i], state.velocities_rad_s[i]) = profile.sample(time_s);
        }
        state
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Arm, test_joint_angles};
    use proptest::prelude::*;

    fn check(chain: &KinematicChain, motion: &JointTrajectory, start: &JointState) {
        let dt = (motion.duration_s() / 500.0).max(1e-6);
        let mut before = motion.sample(0.0);
        assert!((before.angles_rad - start.angles_rad).amax() < 1e-9);
        assert!((before.velocities_rad_s - start.velocities_rad_s).amax() < 1e-9);
        for k in 1..=502 {
            let now = motion.sample(dt * f64::from(k));
            for (i, joint) in chain.joints.iter().enumerate() {
                let (v0, v1) = (before.velocities_rad_s[i], now.velocities_rad_s[i]);
                let a = joint.max_acceleration_rad_s2;
                assert!(v1.abs() <= joint.max_velocity_rad_s + 1e-9);
                assert!((v1 - v0).abs() <= a * dt + 1e-7);
                let way = now.angles_rad[i] - before.angles_rad[i];
                assert!((way - 0.5 * (v0 + v1) * dt).abs() <= a * dt * dt + 1e-7);
            }
            before = now;
        }
        assert!(before.is_at_rest());
    }

    fn moving(chain: &KinematicChain, angles_rad: JointVector, shares: [f64; 6]) -> JointState {
        JointState {
            angles_rad,
            velocities_rad_s: JointVector::from_fn(|i, _| {
                shares[i] * chain.joints[i].max_velocity_rad_s
            }),
        }
    }

    proptest! {
        #[test]
        fn joints_arrive_together_within_limits_from_any_velocity(
            from in test_joint_angles(),
            shares in proptest::array::uniform6(-1.0..1.0_f64),
            to in test_joint_angles(),
            speed in 0.05..1.0_f64,
        ) {
            let arm = Arm::jaco_like();
            let start = moving(arm.chain(), from, shares);
            let motion = JointTrajectory::new(arm.chain(), &start, &to, speed);
            check(arm.chain(), &motion, &start);
            prop_assert_eq!(motion.sample(motion.duration_s()), JointState::at_rest(to));
        }

        #[test]
        fn motion_from_rest_is_straight_in_joint_space_and_as_fast_as_its_slowest_joint(
            from in test_joint_angles(),
            to in test_joint_angles(),
            speed in 0.05..1.0_f64,
        ) {
            let arm = Arm::jaco_like();
            let chain = arm.chain();
            let start = JointState::at_rest(from);
            let motion = JointTrajectory::new(chain, &start, &to, speed);
            check(chain, &motion, &start);
            let way = to - from;
            for k in 0..=50 {
                let state = motion.sample(f64::from(k) / 50.0 * motion.duration_s());
                let passed = state.angles_rad - from;
                let share = passed.dot(&way) / way.norm_squared();
                prop_assert!((passed - way * share).amax() < 1e-9);
            }
            let alone = (0..N_JOINTS).map(|i| {
                let joint = &chain.joints[i];
                let velocity = joint.max_velocity_rad_s * speed;
                let acceleration = joint.max_acceleration_rad_s2;
                TrapezoidalProfile::fastest(from[i], 0.0, to[i], velocity, acceleration).duration_s()
            });
            let slowest_s = alone.fold(0.0, f64::max);
            prop_assert!(motion.duration_s() >= slowest_s - 1e-9);
            prop_assert!(motion.duration_s() <= 1.2 * slowest_s + 1e-9);
        }

        #[test]
        fn a_replaced_motion_stays_within_the_joint_limits(
            from in test_joint_angles(),
            first in test_joint_angles(),
            second in test_joint_angles(),
            share in 0.0..1.0_f64,
        ) {
            let arm = Arm::jaco_like();
            let chain = arm.chain();
            let motion = JointTrajectory::new(chain, &JointState::at_rest(from), &first, 1.0);
            let midway = motion.sample(share * motion.duration_s());
            let replaced = JointTrajectory::new(chain, &midway, &second, 0.5);
            for k in 0..=300 {
                let state = replaced.sample(f64::from(k) / 300.0 * replaced.duration_s());
                prop_assert!((chain.clamped(&state.angles_rad) - state.angles_rad).amax() < 1e-9);
            }
        }

        #[test]
        fn braking_ends_within_the_time_of_the_slowest_joint(
            from in test_joint_angles(),
            shares in proptest::array::uniform6(-1.0..1.0_f64),
        ) {
            let arm = Arm::jaco_like();
            let start = moving(arm.chain(), from, shares);
            let motion = JointTrajectory::braking(arm.chain(), &start);
            check(arm.chain(), &motion, &start);
            prop_assert!(motion.duration_s() <= 0.4 + 1e-6);
        }
    }

    #[test]
    fn motion_to_the_current_position_takes_no_time() {
        let arm = Arm::jaco_like();
        let here = JointVector::from(crate::HOME);
        let motion = JointTrajectory::new(arm.chain(), &JointState::at_rest(here), &here, 1.0);
        assert_eq!(motion.duration_s(), 0.0);
        assert_eq!(motion.sample(0.0), JointState::at_rest(here));
    }
}
