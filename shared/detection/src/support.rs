//! What carries a cluster.

use crate::candidate::Support;
use crate::clusters::{Clusters, squared_distance};
use crate::prism::OUTSIDE;
use nalgebra::{Point3, Vector3};
use point_cloud::OrganizedCloud;

/// Points this near across the border of two clusters touch, metres.
const TOUCH_M: f32 = 0.025;

/// What is nearer by more hides what is behind it, metres.
const HIDE_M: f32 = 0.02;

/// How far below its lower border a cluster's neighbour is looked for, pixels.
const LOOK_PX: [f64; 3] = [2.0, 4.0, 8.0];

/// Share of the lower border that must rest on or be hidden by something.
const SHARE_MIN: f64 = 0.3;

/// What lies under the lower border of a cluster, in pixels of the border.
#[derive(Debug, Default)]
struct Below {
    n: u32,
    n_hidden: u32,
    n_touching: u32,
}

/// Buffers.
#[derive(Debug, Default)]
pub(crate) struct SupportBuffers {
    /// Per cluster, `None` while it hangs in the air.
    pub(crate) support_of: Vec<Option<Support>>,
}

/// Finds what carries each cluster that does not stand on the table itself: a
/// carried cluster it touches from above, or, unseen, whatever hides its lower
/// border. `buffers.support_of` holds the standing ones on entry.
pub(crate) fn find_supports(
    cloud: &OrganizedCloud<'_>,
    clusters: &Clusters,
    centroids: impl Fn(usize) -> Point3<f64>,
    up: &Vector3<f64>,
    buffers: &mut SupportBuffers,
) {
    // Each pass carries support one object higher; a pass without news ends it.
    for _ in 0..clusters.len() {
        let mut news = false;
        for cluster in 0..clusters.len() {
            if buffers.support_of[cluster].is_none() {
                let step = downwards(&centroids(cluster), up);
                let below = look_below(cloud, clusters, cluster, step, &buffers.support_of);
                buffers.support_of[cluster] = judge(&below);
                news |= buffers.support_of[cluster].is_some();
            }
        }
        if !news {
            break;
        }
    }
}

fn judge(below: &Below) -> Option<Support> {
    let share = |n: u32| f64::from(n) / f64::from(below.n.max(1));
    if share(below.n_touching) >= SHARE_MIN {
        Some(Support::Object)
    } else if share(below.n_touching + below.n_hidden) >= SHARE_MIN {
        Some(Support::Hidden)
    } else {
        None
    }
}

/// The image direction towards the table at a point, columns and rows, length 1.
fn downwards(at: &Point3<f64>, up: &Vector3<f64>) -> [f64; 2] {
    let (columns, rows) = (at.x * up.z - up.x * at.z, at.y * up.z - up.y * at.z);
    let length = columns.hypot(rows);
    if length > 1e-9 { [columns / length, rows / length] } else { [0.0, 1.0] }
}

fn look_below(
    cloud: &OrganizedCloud<'_>,
    clusters: &Clusters,
    cluster: usize,
    step: [f64; 2],
    support_of: &[Option<Support>],
) -> Below {
    let (points, width) = (cloud.points(), cloud.width());
    let mut below = Below::default();
    for &pixel in clusters.pixels(cluster) {
        let pixel = pixel as usize;
        let neighbour_at = |distance: f64| {
            let column = (pixel % width).checked_add_signed((step[0] * distance).round() as isize)?;
            let row = (pixel / width).checked_add_signed((step[1] * distance).round() as isize)?;
            (column < width && row < cloud.height()).then_some(row * width + column)
        };
        let own = |&neighbour: &usize| clusters.cluster_of[neighbour] == cluster as u32;
        if LOOK_PX.iter().filter_map(|&d| neighbour_at(d)).any(|n| own(&n)) {
            continue;
        }
        below.n += 1;
        let seen = LOOK_PX.iter().filter_map(|&d| neighbour_at(d)).find(|&n| points[n].is_finite());
        let Some(neighbour) = seen else { continue };
        let other = clusters.cluster_of[neighbour];
        let carried = other != OUTSIDE && support_of[other as usize].is_some();
        if carried && squared_distance(&points[pixel], &points[neighbour]) <= TOUCH_M * TOUCH_M {
            below.n_touching += 1;
        } else if points[neighbour].z < points[pixel].z - HIDE_M {
            below.n_hidden += 1;
        }
    }
    below
}
