//! Pose graph: all camera poses at once, from the registrations of pairs of views.

use crate::pose_filter::PoseSigma;
use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Matrix6, Point3};
use registration::PairAlignment;
use registration::twist::{Twist, exponential, moved_to, twist_at};

/// Number of Gauss-Newton steps, at most. Chosen: three do.
const N_STEPS_MAX: usize = 10;

/// Step below which the poses are final, radians and metres. Chosen.
const STEP_MIN: f64 = 1e-6;

/// Standard deviation of a correspondence across the surfaces, metres, for the weight of a
/// registration. Chosen: ten times that of one surfel, because neighbours share their errors.
const CORRESPONDENCE_SIGMA_M: f64 = 0.01;

/// Distance of a registration from the poses, in standard deviations, from which it loses weight.
/// Chosen.
const OUTLIER_SIGMAS: f64 = 3.0;

/// Registration of two views.
#[derive(Debug, Clone)]
pub(crate) struct Edge {
    pub(crate) target: usize,
    pub(crate) source: usize,
    pub(crate) alignment: PairAlignment,
}

/// Pose of a view as a node.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub(crate) object_from_camera: Isometry3<f64>,
    /// Pose that the robot reported, and its uncertainty.
    pub(crate) reported: Isometry3<f64>,
    pub(crate) sigma: PoseSigma,
}

/// Poses with the least sum of squared errors of all registrations and reported poses
/// (Lu and Milios 1997), by Gauss-Newton; registrations far off lose weight (Cauchy).
pub(crate) fn optimise(nodes: &mut [Node], edges: &[Edge]) {
    for _ in 0..N_STEPS_MAX {
        let n = 6 * nodes.len();
        let mut matrix = DMatrix::zeros(n, n);
        let mut vector = DVector::zeros(n);
        for (index, node) in nodes.iter().enumerate() {
            add_report(&mut matrix, &mut vector, index, node);
        }
        for edge in edges {
            add_edge(&mut matrix, &mut vector, nodes, edge);
        }
        let Some(factor) = matrix.cholesky() else {
            return;
        };
        let step = factor.solve(&vector);
        for (index, node) in nodes.iter_mut().enumerate() {
            let change: Twist = step.fixed_rows::<6>(6 * index).into_owned();
            node.object_from_camera = exponential(&change) * node.object_from_camera;
        }
        if step.amax() < STEP_MIN {
            return;
        }
    }
}

/// Adds the pose that the robot reported, with errors about the camera.
fn add_report(matrix: &mut DMatrix<f64>, vector: &mut DVector<f64>, index: usize, node: &Node) {
    let camera = Point3::from(node.object_from_camera.translation.vector);
    let to_camera = moved_to(&camera);
    let off = twist_at(
        &(node.object_from_camera * node.reported.inverse()),
        &camera,
    );
    // Isotropic: the same in the axes of the object.
    let Some(information) = node.sigma.covariance().try_inverse() else {
        return;
    };
    let weighted = to_camera.transpose() * information;
    let at = 6 * index;
    let mut block = matrix.fixed_view_mut::<6, 6>(at, at);
    block += weighted * to_camera;
    let mut rows = vector.fixed_rows_mut::<6>(at);
    rows -= weighted * off;
}

/// Adds a registration, with errors about the centre of the source.
fn add_edge(matrix: &mut DMatrix<f64>, vector: &mut DVector<f64>, nodes: &[Node], edge: &Edge) {
    let target = nodes[edge.target].object_from_camera;
    let source = nodes[edge.source].object_from_camera;
    let measured = target * edge.alignment.target_from_source;
    let centre = measured * edge.alignment.centre;
    let off = twist_at(&(source * measured.inverse()), &centre);
    let information = in_axes(&edge.alignment.curvature, &target) / CORRESPONDENCE_SIGMA_M.powi(2);
    let squared = off.dot(&(information * off));
    let information = information / (1.0 + squared / OUTLIER_SIGMAS.powi(2));
    let to_centre = moved_to(&centre);
    let weighted = to_centre.transpose() * information;
    let (square, shift) = (weighted * to_centre, weighted * off);
    for (index, sign) in [(edge.source, 1.0), (edge.target, -1.0)] {
        let mut rows = vector.fixed_rows_mut::<6>(6 * index);
        rows -= sign * shift;
        for (other, other_sign) in [(edge.source, 1.0), (edge.target, -1.0)] {
            let mut block = matrix.fixed_view_mut::<6, 6>(6 * index, 6 * other);
            block += sign * other_sign * square;
        }
    }
}

/// Information of a twist in the axes of another frame.
fn in_axes(information: &Matrix6<f64>, pose: &Isometry3<f64>) -> Matrix6<f64> {
    let rotation: Matrix3<f64> = pose.rotation.to_rotation_matrix().into_inner();
    let mut both = Matrix6::zeros();
    both.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation);
    both.fixed_view_mut::<3, 3>(3, 3).copy_from(&rotation);
    both * information * both.transpose()
}
