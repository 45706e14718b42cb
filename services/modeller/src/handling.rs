//! Handling of an object by a person or a robot: it separates the placements of the object.

use message::{SceneObject, SceneSummary};
use nalgebra::{Point3, Vector3};
use scene_client::{is_seen_whole, table_in_world};

/// Growth of the uncertainty of the tracked rotation that tells of a hand, radians. Chosen: a
/// tracked object at rest has up to 6°, and one in a hand gains 15° in the first second. One that
/// has just come back into view has up to 70°, and gains some percent of it.
const HANDLED_GROWTH_RAD: f64 = 10.0_f64.to_radians();
const HANDLED_GROWTH_SHARE: f64 = 0.3;

/// Time for which an object stands still before it counts as put down, nanoseconds, with the
/// growth of the uncertainty, radians, and the change of place, metres, that it may have. Chosen.
const STILL_NS: u64 = 500_000_000;
const STILL_GROWTH_RAD: f64 = 1.0_f64.to_radians();
const STILL_M: f64 = 0.02;

/// Change of the height over the table from which an object is still in a hand, metres. Chosen:
/// it stands as upright as before.
const LIFTED_M: f64 = 0.025;

/// Tracked pose of an object at a time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TrackedPose {
    time_ns: u64,
    /// `false` while the object is hidden or not whole in the image, where the uncertainty grows,
    /// too.
    is_seen_whole: bool,
    position_m: Vector3<f64>,
    rotation_sigma_rad: f64,
    /// Height of its middle over the table; `None` without a table.
    height_m: Option<f64>,
}

impl TrackedPose {
    pub(crate) fn of(object: &SceneObject, scene: &SceneSummary) -> Self {
        let [xx, _, _, yy, _, zz] = object.rotation_covariance_rad2.map(f64::from);
        let position_m = Vector3::from(object.pose.position_m);
        Self {
            time_ns: scene.stamps.capture_ns,
            is_seen_whole: is_seen_whole(object),
            position_m,
            height_m: table_in_world(scene).map(|table| table.height_m(&Point3::from(position_m))),
            rotation_sigma_rad: (xx + yy + zz).max(0.0).sqrt(),
        }
    }
}

/// Placements of an object, told apart by the uncertainty of its tracked rotation: the tracker
/// lets it grow while a hand can turn an object that is seen.
#[derive(Debug, Default)]
pub(crate) struct Handling {
    n_placements: u32,
    state: HandlingState,
}

#[derive(Debug, Default)]
enum HandlingState {
    #[default]
    Unknown,
    /// At rest, with the least uncertainty since it was put down, and its height then.
    Resting {
        least_sigma_rad: f64,
        height_m: Option<f64>,
    },
    /// In a hand, or just put down: the pose since which it has not moved, and the height at which
    /// it stood before.
    Handled {
        still_since: TrackedPose,
        resting_height_m: Option<f64>,
    },
}

impl Handling {
    /// Takes the next tracked pose.
    pub(crate) fn note(&mut self, pose: TrackedPose) {
        let sigma_rad = pose.rotation_sigma_rad;
        match &mut self.state {
            HandlingState::Unknown => self.rest(&pose),
            HandlingState::Resting {
                least_sigma_rad,
                height_m,
            } => {
                if !pose.is_seen_whole {
                    *least_sigma_rad = sigma_rad;
                }
                *least_sigma_rad = least_sigma_rad.min(sigma_rad);
                let growth_rad = (HANDLED_GROWTH_SHARE * *least_sigma_rad).max(HANDLED_GROWTH_RAD);
                if sigma_rad > *least_sigma_rad + growth_rad {
                    self.state = HandlingState::Handled {
                        still_since: pose,
                        resting_height_m: *height_m,
                    };
                }
            }
            HandlingState::Handled {
                still_since,
                resting_height_m,
            } => {
                let moved_m = (pose.position_m - still_since.position_m).norm();
                let grown_rad = sigma_rad - still_since.rotation_sigma_rad;
                let heights = pose.height_m.zip(*resting_height_m);
                let is_lifted = heights.is_some_and(|(now, then)| (now - then).abs() > LIFTED_M);
                if is_lifted || moved_m > STILL_M || grown_rad > STILL_GROWTH_RAD {
                    *still_since = pose;
                } else if pose.time_ns.saturating_sub(still_since.time_ns) >= STILL_NS {
                    self.n_placements += 1;
                    self.rest(&pose);
                }
            }
        }
    }

    fn rest(&mut self, pose: &TrackedPose) {
        self.state = HandlingState::Resting {
            least_sigma_rad: pose.rotation_sigma_rad,
            height_m: pose.height_m,
        };
    }

    /// Number of the placement in which the object stands; `None` while it is handled.
    pub(crate) fn placement(&self) -> Option<u32> {
        let is_handled = matches!(self.state, HandlingState::Handled { .. });
        (!is_handled).then_some(self.n_placements)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Placements after each of the poses, 0.1 s apart: height, metres, and uncertainty, degrees.
    fn placements(poses: &[(f64, f64)]) -> Vec<Option<u32>> {
        let mut handling = Handling::default();
        let poses = (0_u64..).zip(poses);
        let placement = |(index, &(height_m, sigma_deg)): (u64, &(f64, f64))| {
            handling.note(TrackedPose {
                time_ns: 100_000_000 * index,
                is_seen_whole: (0.0..1.0).contains(&height_m),
                position_m: Vector3::z() * height_m,
                height_m: Some(height_m),
                rotation_sigma_rad: sigma_deg.to_radians(),
            });
            handling.placement()
        };
        poses.map(placement).collect()
    }

    #[test]
    fn object_at_rest_stays_in_its_placement() {
        let noisy: Vec<(f64, f64)> = (0..100)
            .map(|i| (0.01 * f64::from(i % 3), 3.0 + 0.05 * f64::from(i % 60)))
            .collect();
        assert!(
            placements(&noisy)
                .iter()
                .all(|placement| *placement == Some(0))
        );
    }

    #[test]
    fn hidden_object_is_not_handled() {
        let hidden = -1.0;
        let mut poses = vec![(0.0, 4.0); 5];
        poses.extend((0..40).map(|i| (hidden, 5.0 + 8.0 * f64::from(i))));
        poses.extend([(0.0, 310.0), (0.0, 300.0), (0.0, 8.0), (0.0, 6.0)]);
        let found = placements(&poses);
        assert!(found.iter().all(|placement| *placement == Some(0)));
    }

    #[test]
    fn object_that_comes_back_into_view_is_not_handled() {
        let (hidden, seen) = (-1.0, 0.0);
        let mut poses = vec![(seen, 4.0); 5];
        // Beyond the image, cut by its border, and whole, as recorded with a Kinect.
        poses.extend((0..20).map(|i| (hidden, 20.0 * f64::from(i))));
        poses.extend([250.0, 255.0, 262.0].map(|sigma| (hidden, sigma)));
        poses.extend((0..15).map(|i| (seen, 66.0 + 0.4 * f64::from(i))));
        poses.extend((0..6).map(|i| (seen, 33.0 + 0.2 * f64::from(i))));
        let found = placements(&poses);
        assert!(found.iter().all(|placement| *placement == Some(0)));
        // A hand tells by a faster growth.
        poses.extend((0..10).map(|i| (seen, 34.0 + 3.0 * f64::from(i))));
        assert_eq!(placements(&poses).last(), Some(&None));
    }

    #[test]
    fn object_that_was_put_down_and_stands_still_is_in_the_next_placement() {
        let mut poses = vec![(0.0, 4.0); 5];
        // Lifted and held, put down, and measured anew, which makes it surer.
        poses.extend((0..20).map(|i| (0.01 * f64::from(i), 15.0 + 2.0 * f64::from(i))));
        poses.extend((0..20).map(|i| (0.2, 60.0 + 1.5 * f64::from(i))));
        // Held still before the camera, which makes it surer, too.
        poses.extend([(0.2, 20.0); 20]);
        let n_handled = poses.len();
        poses.extend([
            (0.0, 40.0),
            (0.0, 30.0),
            (0.0, 30.0),
            (0.0, 30.2),
            (0.0, 30.0),
        ]);
        poses.extend([(0.0, 30.0); 20]);
        let found = placements(&poses);
        assert_eq!(found[4], Some(0));
        assert!(found[5..n_handled].iter().all(Option::is_none), "{found:?}");
        assert_eq!(found[n_handled + 3], None, "not yet still");
        assert_eq!(found.last(), Some(&Some(1)));
        let n_resting = found
            .iter()
            .filter(|placement| **placement == Some(1))
            .count();
        assert!(n_resting >= 18, "{found:?}");
    }
}
