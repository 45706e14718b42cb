//! Joint angles that bring the tool to a pose.

#[cfg(test)]
mod tests;

use geometry::RigidTransform;

use crate::closed_form::{N_BRANCHES, branches};
use crate::damped_least_squares::{Descent, descend};
use crate::{Arm, Error, JointVector, link_capsules, self_clearance_m};

/// How near a pose counts as reached, and how long to search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IkConfig {
    /// Allowed distance of the tool from the pose, metres.
    pub tolerance_m: f64,
    /// Allowed turn of the tool away from the pose, radians.
    pub tolerance_rad: f64,
    /// Most steps of one descent; there are at most nine descents.
    pub max_iterations: usize,
}

impl Default for IkConfig {
    fn default() -> Self {
        Self {
            tolerance_m: 0.001,
            tolerance_rad: 0.5_f64.to_radians(),
            max_iterations: 60,
        }
    }
}

/// What separates two poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseResidual {
    /// Distance of the origins, metres.
    pub distance_m: f64,
    /// Angle of the rotation between them, radians, 0 to π.
    pub angle_rad: f64,
}

impl PoseResidual {
    /// What separates `a` from `b`.
    pub fn between(a: &RigidTransform, b: &RigidTransform) -> Self {
        Self {
            distance_m: (a.translation.vector - b.translation.vector).norm(),
            angle_rad: a.rotation.angle_to(&b.rotation),
        }
    }

    pub(crate) fn is_within(&self, config: &IkConfig) -> bool {
        self.distance_m <= config.tolerance_m && self.angle_rad <= config.tolerance_rad
    }

    /// One length for both parts: a turn weighs as it moves a finger, 0.2 m/rad.
    fn weight_m(&self) -> f64 {
        self.distance_m.hypot(0.2 * self.angle_rad)
    }
}

/// Joint angles of a pose and how they were found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IkSolution {
    /// Joint angles, within the limits, radians.
    pub joints_rad: JointVector,
    /// What is left between the tool and the pose.
    pub residual: PoseResidual,
    /// Steps of descent over all starts; 0 when the closed form sufficed.
    pub n_iterations: usize,
}

/// Finds the joint angles of a tool pose that are nearest to `near` (by travel
/// times, all joints together). Those in which the arm would reach into itself
/// are taken only when there are no others.
///
/// First the closed form gives every solution, in all whole turns that the
/// limits allow. When none of them is within limits, damped least squares starts
/// from `near` and from each of them: poses at the very edge are still found,
/// and otherwise it is known how near the arm can come. The work is bounded by
/// `config` and nothing is allocated.
///
/// # Errors
///
/// [`Error::Unreachable`] with the least residual that was found;
/// [`Error::BadNumber`] for a pose that is none.
pub fn inverse_kinematics(
    arm: &Arm,
    base_from_tool: &RigidTransform,
    near: &JointVector,
    config: &IkConfig,
) -> Result<IkSolution, Error> {
    check_pose(base_from_tool)?;
    let near = arm.chain().clamped(near);
    let seeds = branches(arm.dimensions(), base_from_tool, &near);
    match nearest_branch(arm, base_from_tool, &near, &seeds, config) {
        Some(solution) => Ok(solution),
        None => search(arm, base_from_tool, &near, &seeds, config),
    }
}

impl Arm {
    /// All joint angles within the limits that bring the tool to a pose exactly,
    /// each in the whole turns nearest to `near`: at most eight. For choosing
    /// among them by other needs than the shortest way.
    ///
    /// # Errors
    ///
    /// [`Error::BadNumber`] for a pose that is none.
    pub fn configurations(
        &self,
        base_from_tool: &RigidTransform,
        near: &JointVector,
    ) -> Result<impl Iterator<Item = JointVector>, Error> {
        check_pose(base_from_tool)?;
        let near = self.chain().clamped(near);
        let (pose, config) = (*base_from_tool, IkConfig::default());
        Ok(branches(self.dimensions(), base_from_tool, &near)
            .into_iter()
            .filter_map(move |seed| wound(self, &seed, &near))
            .filter(move |joints| {
                PoseResidual::between(&pose, &self.tool_pose(joints)).is_within(&config)
            }))
    }

    /// Whether parts of the arm that are not joined overlap, the hand wide open.
    pub fn is_self_touching(&self, joints_rad: &JointVector) -> bool {
        let capsules = link_capsules(self, joints_rad, self.gripper().max_opening_m);
        self_clearance_m(&capsules) < 0.0
    }

    /// Whether the tool can be brought to a pose. Cheap: closed form only.
    pub fn can_reach(&self, base_from_tool: &RigidTransform) -> bool {
        self.configurations(base_from_tool, &JointVector::zeros())
            .is_ok_and(|mut found| found.next().is_some())
    }
}

/// Checks that a pose is made of finite numbers and a unit quaternion.
pub(crate) fn check_pose(pose: &RigidTransform) -> Result<(), Error> {
    if !pose.translation.vector.iter().all(|x| x.is_finite()) {
        return Err(Error::BadNumber {
            what: "the position of the pose",
            rule: "its coordinates must be finite numbers",
        });
    }
    // Written so that NaN fails.
    let is_unit = (pose.rotation.as_ref().norm() - 1.0).abs() < 1e-3;
    if !is_unit {
        return Err(Error::BadNumber {
            what: "the quaternion of the pose",
            rule: "its length must be 1",
        });
    }
    Ok(())
}

/// The whole turns of each joint that are within limits and nearest to `near`.
fn wound(arm: &Arm, joints: &JointVector, near: &JointVector) -> Option<JointVector> {
    let mut wound = *joints;
    for (i, joint) in arm.chain().joints.iter().enumerate() {
        wound[i] = joint.equivalent_near(joints[i], near[i])?;
    }
    Some(wound)
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
        .filter_map(|seed| wound(arm, seed, near))
        .map(|joints_rad| IkSolution {
            joints_rad,
            residual: PoseResidual::between(base_from_tool, &arm.tool_pose(&joints_rad)),
            n_iterations: 0,
        })
        .filter(|solution| solution.residual.is_within(config))
        .map(|solution| {
            let way_s = arm.chain().travel_s(near, &solution.joints_rad);
            (
                (arm.is_self_touching(&solution.joints_rad), way_s),
                solution,
            )
        })
        .min_by(|(a, _), (b, _)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)))
        .map(|(_, solution)| solution)
}

/// Descends from `near` and from every seed; the best end counts, and among
/// ends within tolerance the nearest.
fn search(
    arm: &Arm,
    base_from_tool: &RigidTransform,
    near: &JointVector,
    seeds: &[JointVector; N_BRANCHES],
    config: &IkConfig,
) -> Result<IkSolution, Error> {
    let chain = arm.chain();
    let rank = |end: &Descent| {
        if end.residual.is_within(config) {
            (0, chain.travel_s(near, &end.joints_rad))
        } else {
            (1, end.residual.weight_m())
        }
    };
    let mut best = descend(chain, base_from_tool, near, config.max_iterations);
    let mut n_iterations = best.n_iterations;
    for seed in seeds {
        let start = JointVector::from_fn(|i, _| {
            chain.joints[i]
                .equivalent_near(seed[i], near[i])
                .unwrap_or(seed[i])
        });
        let end = descend(chain, base_from_tool, &start, config.max_iterations);
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
