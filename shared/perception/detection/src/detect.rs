//! Detection entry point: organised clouds take the image path, all others the
//! unorganised path.

use crate::execution::Execution;
use crate::input::DetectionInput;
use crate::organized::detect_organized;
use crate::output::Detection;
use crate::unorganized::{detect_unorganized, is_unorganized};
use crate::workspace::Workspace;
use crate::{Config, Error};
use constraint::{Assumption, Assumptions};
use point_cloud::OrganizedCloud;

/// Largest accepted cloud, points: an image of 8192x8192.
const N_POINTS_MAX: usize = 1 << 26;

/// Detect the table and the object candidates on it in one frame.
///
/// Points may hold any bit pattern; points that are not finite, out of range or
/// implausibly far to the side are ignored. The result does not depend on `execution`.
/// Allocates nothing once the buffers have grown.
///
/// # Errors
/// When the cloud is larger than 8192x8192 points; `detection` is then left empty.
pub fn detect(
    frame: &DetectionInput<'_>,
    config: &Config,
    workspace: &mut Workspace,
    detection: &mut Detection,
    execution: Execution<'_>,
) -> Result<(), Error> {
    let Workspace {
        organized,
        unorganized,
    } = workspace;
    organized.recycle(detection);
    detection.assumptions = assumptions(frame);
    detection.depth_noise = config.get().depth_noise;
    check_size(&frame.cloud)?;
    if is_unorganized(&frame.cloud) {
        let buffers = unorganized.get_or_insert_default();
        detect_unorganized(frame, config, buffers, organized, detection);
    } else {
        detect_organized(frame, config, organized, detection, execution);
    }
    Ok(())
}

/// Assumptions for the sources that are absent.
fn assumptions(frame: &DetectionInput<'_>) -> Assumptions {
    let mut assumptions = Assumptions::default();
    for (is_absent, assumption) in [
        (frame.priors.instructor.is_none(), Assumption::NoPersonKnown),
        (frame.priors.robot.is_none(), Assumption::NoRobotKnown),
        (frame.up_in_camera.is_none(), Assumption::UpGuessed),
    ] {
        if is_absent {
            assumptions.add(assumption);
        }
    }
    assumptions
}

/// Checks that the cloud is not too large.
fn check_size(cloud: &OrganizedCloud<'_>) -> Result<(), Error> {
    let n_points = cloud.points().len();
    if n_points > N_POINTS_MAX {
        return Err(Error::TooLarge { n_points });
    }
    Ok(())
}
