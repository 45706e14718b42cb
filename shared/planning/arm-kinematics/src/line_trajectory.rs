//! Cartesian straight-line trajectory of the tool.

use geometry::RigidTransform;
use nalgebra::UnitQuaternion;

use crate::damped_least_squares::solve_least_squares;
use crate::inverse_kinematics::check_pose;
use crate::trapezoidal_profile::TrapezoidalProfile;
use crate::{Arm, Error, IkConfig, JointState, JointVector, N_JOINTS};

/// Greatest distance between two poses on the line, metres. Chosen.
const KNOT_SPACING_M: f64 = 0.005;

/// Greatest rotation between two poses on the line, radians. Chosen.
const KNOT_SPACING_RAD: f64 = 0.03;

/// Greatest number of steps on a line: 10 m, far beyond reach.
const MAX_STEPS: usize = 2000;

/// Greatest change of a joint between two poses, radians; beyond it the arm passes a singularity
/// so closely that it would swing round. Chosen.
const MAX_JOINT_STEP_RAD: f64 = 0.25;

/// Tolerance of inverse kinematics at each pose on the line. Chosen.
const KNOT_TOLERANCE: IkConfig = IkConfig {
    tolerance_m: 1e-5,
    tolerance_rad: 1e-4,
    max_iterations: 40,
};

/// Cartesian trajectory from rest to rest: the tool moves on a straight line and rotates evenly
/// about one axis.
///
/// The joint angles at poses on the line, at most 5 mm and 1.7° apart, are joined by cubic
/// Hermite curves (Catmull and Rom 1974), so that joint velocities are continuous. One
/// trapezoidal velocity profile over the whole line keeps every joint within its limits.
#[derive(Debug, Clone, PartialEq)]
pub struct LineTrajectory {
    /// Joint angles at the integer path parameters; at least two.
    knots: Vec<JointVector>,
    profile: TrapezoidalProfile,
}

impl LineTrajectory {
    /// Plans the line from the tool's pose at `start_rad` to `base_from_tool`. `speed`, in (0,
    /// 1], scales the maximum joint velocities.
    ///
    /// # Errors
    ///
    /// [`Error::LineLeavesWorkspace`], [`Error::LineJumps`], or [`Error::BadNumber`] for an
    /// invalid pose.
    pub fn plan(
        arm: &Arm,
        start_rad: &JointVector,
        base_from_tool: &RigidTransform,
        speed: f64,
    ) -> Result<Self, Error> {
        check_pose(base_from_tool)?;
        arm.chain().check(start_rad)?;
        let knots = trace_line(arm, start_rad, base_from_tool)?;
        let (velocity, acceleration) = path_limits(arm, &knots, speed);
        let end = (knots.len() - 1) as f64;
        Ok(Self {
            profile: TrapezoidalProfile::fastest(0.0, 0.0, end, velocity, acceleration),
            knots,
        })
    }

    /// Duration of the trajectory, seconds.
    pub fn duration_s(&self) -> f64 {
        self.profile.duration_s()
    }

    /// Joint angles at the end of the trajectory, radians.
    pub fn target_rad(&self) -> JointVector {
        self.knots[self.knots.len() - 1]
    }

    /// Joint state at a time since the start, seconds.
    pub fn sample(&self, time_s: f64) -> JointState {
        let (along, velocity) = self.profile.sample(time_s);
        let n_segments = self.knots.len() - 1;
        if along >= n_segments as f64 {
            return JointState::at_rest(self.target_rad());
        }
        let segment = along.max(0.0) as usize;
        let curve = HermiteSegment::between_knots(&self.knots, segment);
        let u = along - segment as f64;
        JointState {
            angles_rad: curve.angles(u),
            velocities_rad_s: curve.slope(u) * velocity,
        }
    }
}

/// Inverse kinematics along the line: joint angles at evenly spaced poses from the start to the
/// target.
fn trace_line(
    arm: &Arm,
    start: &JointVector,
    base_from_tool: &RigidTransform,
) -> Result<Vec<JointVector>, Error> {
    let from = arm.tool_pose(start);
    let shift = base_from_tool.translation.vector - from.translation.vector;
    let turn = (from.rotation.inverse() * base_from_tool.rotation).scaled_axis();
    let length_m = shift.norm();
    let n_steps = (length_m / KNOT_SPACING_M)
        .max(turn.norm() / KNOT_SPACING_RAD)
        .ceil()
        .max(1.0);
    if n_steps > MAX_STEPS as f64 {
        return Err(Error::LineLeavesWorkspace {
            reached_m: 0.0,
            length_m,
        });
    }
    let mut knots = Vec::with_capacity(n_steps as usize + 1);
    knots.push(*start);
    let mut last = *start;
    for k in 1..=n_steps as usize {
        let share = k as f64 / n_steps;
        let pose = RigidTransform::from_parts(
            (from.translation.vector + shift * share).into(),
            from.rotation * UnitQuaternion::from_scaled_axis(turn * share),
        );
        let reached_m = length_m * (k - 1) as f64 / n_steps;
        let end = solve_least_squares(arm.chain(), &pose, &last, KNOT_TOLERANCE.max_iterations);
        if !end.residual.is_within(&KNOT_TOLERANCE) {
            return Err(Error::LineLeavesWorkspace {
                reached_m,
                length_m,
            });
        }
        let change = end.joints_rad - last;
        if change.amax() > MAX_JOINT_STEP_RAD {
            return Err(Error::LineJumps {
                reached_m,
                length_m,
                joint: change.iamax() + 1,
            });
        }
        last = end.joints_rad;
        knots.push(last);
    }
    Ok(knots)
}

/// Path parameter limits: greatest velocity and acceleration, 1/s and 1/s², that keep every joint
/// within its limits on the whole path.
///
/// A joint's acceleration is `q″ ṡ² + q′ s̈`; each term may use half of the limit.
fn path_limits(arm: &Arm, knots: &[JointVector], speed: f64) -> (f64, f64) {
    let (mut slope, mut curvature) = (JointVector::zeros(), JointVector::zeros());
    for segment in 0..knots.len() - 1 {
        let curve = HermiteSegment::between_knots(knots, segment);
        slope = slope.sup(&curve.max_slope());
        // The second derivative is linear: its extremes are at the ends.
        curvature = curvature
            .sup(&curve.curvature(0.0).abs())
            .sup(&curve.curvature(1.0).abs());
    }
    let (mut velocity, mut acceleration) = (f64::INFINITY, f64::INFINITY);
    for i in 0..N_JOINTS {
        let joint = &arm.chain().joints[i];
        let half = 0.5 * joint.max_acceleration_rad_s2;
        // A joint that does not move allows any speed; the lower bound keeps the numbers finite.
        let slope = slope[i].max(1e-9);
        velocity = velocity.min(speed * joint.max_velocity_rad_s / slope);
        velocity = velocity.min((half / curvature[i].max(1e-12)).sqrt());
        acceleration = acceleration.min(half / slope);
    }
    (velocity, acceleration)
}

/// Cubic Hermite segment `a + b u + c u² + d u³`, `u` in [0, 1].
struct HermiteSegment {
    coefficients: [JointVector; 4],
}

impl HermiteSegment {
    /// Segment from knot `k` to `k + 1` (Catmull–Rom): the slope at a knot is the one between its
    /// neighbours.
    fn between_knots(knots: &[JointVector], k: usize) -> Self {
        let slope_at = |i: usize| {
            let (before, after) = (i.saturating_sub(1), (i + 1).min(knots.len() - 1));
            (knots[after] - knots[before]) / (after - before) as f64
        };
        let (from, to) = (knots[k], knots[k + 1]);
        let (slope_from, slope_to) = (slope_at(k), slope_at(k + 1));
        let way = to - from;
        Self {
            coefficients: [
                from,
                slope_from,
                way * 3.0 - slope_from * 2.0 - slope_to,
                slope_from + slope_to - way * 2.0,
            ],
        }
    }

    fn angles(&self, u: f64) -> JointVector {
        let [a, b, c, d] = &self.coefficients;
        a + (b + (c + d * u) * u) * u
    }

    fn slope(&self, u: f64) -> JointVector {
        let [_, b, c, d] = &self.coefficients;
        b + (c * 2.0 + d * (3.0 * u)) * u
    }

    fn curvature(&self, u: f64) -> JointVector {
        let [_, _, c, d] = &self.coefficients;
        c * 2.0 + d * (6.0 * u)
    }

    /// Greatest absolute slope of each joint on the segment.
    fn max_slope(&self) -> JointVector {
        let [_, b, c, d] = &self.coefficients;
        let at_ends = self.slope(0.0).abs().sup(&self.slope(1.0).abs());
        JointVector::from_fn(|i, _| {
            let turning = -c[i] / (3.0 * d[i]);
            if (0.0..=1.0).contains(&turning) {
                at_ends[i].max((b[i] + c[i] * turning).abs())
            } else {
                at_ends[i]
            }
        })
    }
}

#[cfg(test)]
mod tests;
