//! Trapezoidal velocity profile of one joint.

/// Trapezoidal velocity profile (accelerate, cruise, brake) from any initial velocity to rest.
///
/// Along the direction from the stopping point of immediate braking to the target, acceleration
/// and braking use the whole acceleration limit, and the cruising speed determines the duration.
/// Every duration from the least one upwards has a cruising speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TrapezoidalProfile {
    start: f64,
    target: f64,
    /// Sign of the cruising velocity: +1 or -1.
    direction: f64,
    /// Initial velocity along the direction of motion.
    initial_speed: f64,
    cruise_speed: f64,
    acceleration: f64,
    speed_up_s: f64,
    cruise_s: f64,
    slow_down_s: f64,
}

impl TrapezoidalProfile {
    /// Time-optimal profile within a maximum speed and an acceleration, both > 0. An initial
    /// velocity above the maximum speed is reduced to it.
    pub(crate) fn fastest(
        start: f64,
        initial_velocity: f64,
        target: f64,
        max_speed: f64,
        acceleration: f64,
    ) -> Self {
        let braked = start + initial_velocity * initial_velocity.abs() / (2.0 * acceleration);
        let direction = if target >= braked { 1.0 } else { -1.0 };
        let initial_speed = direction * initial_velocity;
        let distance = direction * (target - start);
        let peak2 = acceleration * distance + 0.5 * initial_speed * initial_speed;
        let profile = Self {
            start,
            target,
            direction,
            initial_speed,
            cruise_speed: 0.0,
            acceleration,
            speed_up_s: 0.0,
            cruise_s: 0.0,
            slow_down_s: 0.0,
        };
        let mut profile = profile.with_cruise_speed(peak2.max(0.0).sqrt().min(max_speed));
        if profile.cruise_speed > 0.0 {
            let remaining = distance - profile.ramp_distance();
            profile.cruise_s = remaining.max(0.0) / profile.cruise_speed;
        }
        profile
    }

    /// Braking profile from a velocity to rest in the least time.
    pub(crate) fn braking(start: f64, initial_velocity: f64, acceleration: f64) -> Self {
        let way = initial_velocity * initial_velocity.abs() / (2.0 * acceleration);
        Self::fastest(
            start,
            initial_velocity,
            start + way,
            initial_velocity.abs(),
            acceleration,
        )
    }

    /// Same motion stretched to a longer duration, at a lower cruising speed; a duration below
    /// the least one changes nothing.
    pub(crate) fn stretched_to(self, duration_s: f64) -> Self {
        if duration_s <= self.duration_s() {
            return self;
        }
        let (a, v0) = (self.acceleration, self.initial_speed);
        let distance = self.direction * (self.target - self.start);
        // Accelerating first: v² - b v + c = 0; the smaller root is the cruising speed.
        let b = a * duration_s + v0;
        let c = (a * distance + 0.5 * v0 * v0).max(0.0);
        let root = 2.0 * c / (b + (b * b - 4.0 * c).max(0.0).sqrt());
        let cruise_speed = if root.is_nan() || root < v0 {
            ((distance - 0.5 * v0 * v0 / a) / (duration_s - v0 / a)).clamp(0.0, v0.max(0.0))
        } else {
            root
        };
        let mut profile = self.with_cruise_speed(cruise_speed);
        profile.cruise_s = (duration_s - profile.speed_up_s - profile.slow_down_s).max(0.0);
        profile
    }

    fn with_cruise_speed(mut self, cruise_speed: f64) -> Self {
        self.cruise_speed = cruise_speed;
        self.speed_up_s = (cruise_speed - self.initial_speed).abs() / self.acceleration;
        self.slow_down_s = cruise_speed / self.acceleration;
        self
    }

    /// Distance covered while the speed changes, along the direction.
    fn ramp_distance(&self) -> f64 {
        0.5 * (self.initial_speed + self.cruise_speed) * self.speed_up_s
            + 0.5 * self.cruise_speed * self.slow_down_s
    }

    /// Duration of the velocity profile, seconds.
    pub(crate) fn duration_s(&self) -> f64 {
        self.speed_up_s + self.cruise_s + self.slow_down_s
    }

    /// Position and velocity at a time, seconds: the start before the beginning, the target at
    /// rest after the end.
    pub(crate) fn sample(&self, time_s: f64) -> (f64, f64) {
        let left_s = self.duration_s() - time_s;
        if left_s.is_nan() || left_s <= 0.0 {
            return (self.target, 0.0);
        }
        let t = time_s.max(0.0);
        let (way, speed) = if t < self.speed_up_s {
            let a = self
                .acceleration
                .copysign(self.cruise_speed - self.initial_speed);
            (
                self.initial_speed * t + 0.5 * a * t * t,
                self.initial_speed + a * t,
            )
        } else if left_s > self.slow_down_s {
            let ramp = 0.5 * (self.initial_speed + self.cruise_speed) * self.speed_up_s;
            (
                ramp + self.cruise_speed * (t - self.speed_up_s),
                self.cruise_speed,
            )
        } else {
            let a = self.acceleration;
            let way_left = 0.5 * a * left_s * left_s;
            return (
                self.target - self.direction * way_left,
                self.direction * a * left_s,
            );
        };
        (self.start + self.direction * way, self.direction * speed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ACCELERATION: f64 = 2.0;
    const MAX_SPEED: f64 = 0.8;

    fn check(profile: &TrapezoidalProfile, start: f64, velocity: f64, target: f64) {
        let duration = profile.duration_s();
        assert_eq!(profile.sample(duration), (target, 0.0));
        let (q, v) = profile.sample(0.0);
        assert!((q - start).abs() < 1e-9 && (v - velocity).abs() < 1e-9);
        let dt = (duration / 997.0).max(1e-6);
        let mut before = (q, v);
        for i in 1..=998 {
            let now = profile.sample(dt * f64::from(i));
            assert!(now.1.abs() <= MAX_SPEED.max(velocity.abs()) + 1e-9);
            assert!(
                (now.1 - before.1).abs() <= ACCELERATION * dt + 1e-7,
                "{profile:?}"
            );
            let mean = 0.5 * (now.1 + before.1);
            assert!((now.0 - before.0 - mean * dt).abs() <= ACCELERATION * dt * dt + 1e-7);
            before = now;
        }
    }

    proptest! {
        #[test]
        fn motion_is_continuous_within_limits_and_ends_exactly(
            start in -3.0..3.0_f64,
            velocity in -MAX_SPEED..MAX_SPEED,
            target in -3.0..3.0_f64,
            extra_s in 0.0..5.0_f64,
        ) {
            let fastest =
                TrapezoidalProfile::fastest(start, velocity, target, MAX_SPEED, ACCELERATION);
            check(&fastest, start, velocity, target);
            let slower = fastest.stretched_to(fastest.duration_s() + extra_s);
            prop_assert!((slower.duration_s() - fastest.duration_s() - extra_s).abs() < 1e-9);
            check(&slower, start, velocity, target);
        }

        #[test]
        fn braking_is_over_after_velocity_by_acceleration(
            start in -3.0..3.0_f64,
            velocity in -MAX_SPEED..MAX_SPEED,
        ) {
            let braking = TrapezoidalProfile::braking(start, velocity, ACCELERATION);
            prop_assert!((braking.duration_s() - velocity.abs() / ACCELERATION).abs() < 1e-6);
            let (end, _) = braking.sample(10.0);
            check(&braking, start, velocity, end);
        }
    }

    #[test]
    fn least_time_from_rest_is_that_of_a_triangle_or_trapezoid() {
        let duration =
            |way| TrapezoidalProfile::fastest(0.0, 0.0, way, MAX_SPEED, ACCELERATION).duration_s();
        // Below 0.32 the maximum speed is not reached.
        assert!((duration(0.18) - 2.0 * (0.18_f64 / ACCELERATION).sqrt()).abs() < 1e-12);
        let cruise = (1.0 - MAX_SPEED * MAX_SPEED / ACCELERATION) / MAX_SPEED;
        assert!((duration(-1.0) - (cruise + 2.0 * MAX_SPEED / ACCELERATION)).abs() < 1e-12);
    }

    #[test]
    fn target_behind_the_braking_point_is_reached_on_the_way_back() {
        let profile = TrapezoidalProfile::fastest(0.0, 0.8, 0.0, MAX_SPEED, ACCELERATION);
        let furthest = (0..1000)
            .map(|i| {
                profile
                    .sample(f64::from(i) * profile.duration_s() / 1000.0)
                    .0
            })
            .fold(0.0, f64::max);
        assert!((furthest - 0.8 * 0.8 / (2.0 * ACCELERATION)).abs() < 1e-5);
    }
}
