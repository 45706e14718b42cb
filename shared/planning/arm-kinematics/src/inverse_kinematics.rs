//! Inverse kinematics: closed form first, damped least squares as a fallback.

#[cfg(test)]
mod tests;

use geometry::RigidTransform;

use crate::closed_form::{N_BRANCHES, solution_branches};
use crate::damped_least_squares::{LeastSquaresSolution, solve_least_squares};
use crate::{Arm, Error, IkConfig, JointVector, PoseResidual, link_capsules, self_clearance_m};

/// Solution of an inverse kinematics problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IkSolution {
    /// Joint angles of the solution, within the limits, radians.
    pub joints_rad: JointVector,
    /// Residual between the reached and the requested tool pose.
    pub residual: PoseResidual,
    /// Total number of least squares iterations; 0 when the closed form sufficed.
    pub n_iterations: usize,
}

/// Finds the joint angles of a tool pose that are nearest to `near` by travel time over all
/// joints. Self-colliding solutions are returned only when there are no others.
///
/// The closed form gives every solution, in all whole turns that the limits allow. When none of
/// them is within the limits, damped least squares starts from `near` and from each of them:
/// poses at the very edge of the workspace are still found, and otherwise the least residual is
/// known. The work is bounded by `config`; nothing is allocated.
///
/// # Errors
///
/// [`Error::Unreachable`] with the least residual; [`Error::BadNumber`] for an invalid pose.
pub fn inverse_kinematics(
    arm: &Arm,
    base_from_tool: &RigidTransform,
    near: &JointVector,
    config: &IkConfig,
) -> Result<IkSolution, Error> {
    check_pose(base_from_tool)?;
    let near = arm.chain().clamped(near);
    let seeds = solution_branches(arm.dimensions(), base_from_tool, &near);
    match nearest_branch(arm, base_from_tool, &near, &seeds, config) {
        Some(solution) => Ok(solution),
        None => search_from_seeds(arm, base_from_tool, &near, &seeds, config),
    }
}

impl Arm {
    /// All closed-form solutions of a tool pose within the joint limits, each in the turn nearest
    /// to `near`: at most eight. For callers that choose among them by other criteria than travel
    /// time.
    ///
    /// # Errors
    ///
    /// [`Error::BadNumber`] for an invalid pose.
    pub fn configurations(
        &self,
        base_from_tool: &RigidTransform,
        near: &JointVector,
    ) -> Result<impl Iterator<Item = JointVector>, Error> {
        check_pose(base_from_tool)?;
        let near = self.chain().clamped(near);
        let (pose, config) = (*base_from_tool, IkConfig::default());
        Ok(solution_branches(self.dimensions(), base_from_tool, &near)
            .into_iter()
            .filter_map(move |seed| unwrapped_near(self, &seed, &near))
            .filter(move |joints| {
                PoseResidual::between(&pose, &self.tool_pose(joints)).is_within(&config)
            }))
    }

    /// True if links that are not neighbours overlap, with the hand wide open.
    pub fn is_self_colliding(&self, joints_rad: &JointVector) -> bool {
        let capsules = link_capsules(self, joints_rad, self.gripper().max_opening_m);
        self_clearance_m(&capsules) < 0.0
    }

    /// True if the tool can reach a pose. Cheap: closed form only.
    pub fn can_reach(&self, base_from_tool: &RigidTransform) -> bool {
        self.configurations(base_from_tool, &JointVector::zeros())
            .is_ok_and(|mut found| found.next().is_some())
    }
}

/// Validates a pose: finite numbers and a unit quaternion.
pub(crate) fn check_pose(pose: &RigidTransform) -> Result<(), Error> {
    if !pose.translation.vector.iter().all(|x| x.is_finite()) {
        return Err(Error::BadNumber {
            what: "the position of the pose",
            rule: "its coordinates must be finite numbers",
        });
    }
    // This form makes NaN fail.
    let is_unit = (pose.rotation.as_ref().norm() - 1.0).abs() < 1e-3;
    if !is_unit {
        return Err(Error::BadNumber {
            what: "the quaternion of the pose",
            rule: "its length must be 1",
        });
    }
    Ok(())
}

/// Angle unwrapping: shifts each joint by whole turns into its limits, as near to `near` as
/// possible.
fn unwrapped_near(arm: &Arm, joints: &JointVector, near: &JointVector) -> Option<JointVector> {
    let mut unwrapped = *joints;
    for (i, joint) in arm.chain().joints.iter().enumerate() {
        unwrapped[i] = joint.equivalent_near(joints[i], near[i])?;
    }
    Some(unwrapped)
}

fn nearest_branch(
    arm: &Arm,
    base_from_tool: &RigidTransform,
    near: &JointVector,
    seeds: &[JointVector; N_BRANCHES],
    config: &IkConfig,
) -> Option<IkSolution> {
    seeds
        .iter()
        .filter_map(|seed| unwrapped_near(arm, seed, near))
        .map(|joints_rad| IkSolution {
            joints_rad,
            residual: PoseResidual::between(base_from_tool, &arm.tool_pose(&joints_rad)),
            n_iterations: 0,
        })
        .filter(|solution| solution.residual.is_within(config))
        .map(|solution| {
            let way_s = arm.chain().travel_time_norm_s(near, &solution.joints_rad);
            (
                (arm.is_self_colliding(&solution.joints_rad), way_s),
                solution,
            )
        })
        .min_by(|(a, _), (b, _)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)))
        .map(|(_, solution)| solution)
}

/// Least squares search from `near` and from every closed-form seed. Returns the nearest solution
/// within tolerance, or else the one with the least residual as an error.
fn search_from_seeds(
    arm: &Arm,
    base_from_tool: &RigidTransform,
    near: &JointVector,
    seeds: &[JointVector; N_BRANCHES],
    config: &IkConfig,
) -> Result<IkSolution, Error> {
    let chain = arm.chain();
    let rank = |end: &LeastSquaresSolution| {
        if end.residual.is_within(config) {
            (0, chain.travel_time_norm_s(near, &end.joints_rad))
        } else {
            (1, end.residual.weighted_norm_m())
        }
    };
    let mut best = solve_least_squares(chain, base_from_tool, near, config.max_iterations);
    let mut n_iterations = best.n_iterations;
    for seed in seeds {
        let start = JointVector::from_fn(|i, _| {
            chain.joints[i]
                .equivalent_near(seed[i], near[i])
                .unwrap_or(seed[i])
        });
        let end = solve_least_squares(chain, base_from_tool, &start, config.max_iterations);
        n_iterations += end.n_iterations;
        if rank(&end) < rank(&best) {
            best = end;
        }
    }
    if best.residual.is_within(config) {
        return Ok(IkSolution {
            joints_rad: best.joints_rad,
            residual: best.residual,
            n_iterations,
        });
    }
    Err(Error::Unreachable {
        distance_m: best.residual.distance_m,
        angle_rad: best.residual.angle_rad,
        n_iterations,
    })
}
