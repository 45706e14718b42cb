//! Scene of view planning: hypotheses at their poses, and the background.

use crate::SurfaceModel;
use crate::error::Error;
use geometry::RigidTransform;
use nalgebra::{Point3, Vector3};
use std::ops::Range;

/// Greatest number of hypotheses: labels of 16 bits, less those of background and of nothing.
pub(crate) const N_HYPOTHESES_MAX: usize = 0xfffd;

/// Object hypothesis: a surface model at a pose.
#[derive(Debug, Clone, Copy)]
pub struct Hypothesis<'a> {
    /// Identity of the object, such as the number of its track. Hypotheses of one identity are
    /// one object, the parts of which add up.
    pub id: u32,
    /// Surface of the object.
    pub model: &'a SurfaceModel,
    /// Pose of the object.
    pub world_from_object: RigidTransform,
}

/// Hypotheses and background as points in the world, ready to be rendered from any side.
///
/// Coordinates are single precision relative to the middle of the scene.
#[derive(Debug, Clone, Default)]
pub struct PlanningScene {
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) z: Vec<f32>,
    /// Points of each contributor: the background first, then the objects.
    pub(crate) ranges: Vec<(Range<usize>, u16)>,
    /// Identity of each object, ascending.
    ids: Vec<u32>,
    /// Bounding spheres of the hypotheses: centre, metres from the middle, and radius.
    spheres: Vec<(Vector3<f32>, f32)>,
    pub(crate) middle_in_world: Vector3<f64>,
    /// Least and greatest coordinates relative to the middle, metres.
    pub(crate) bounds: [Vector3<f32>; 2],
}

impl PlanningScene {
    /// Scene of hypotheses and background points, world frame, metres. Background points that are
    /// not finite are left out; thin them to the cells of the view first, with
    /// [`SurfaceModel::of_points`], if they are many.
    ///
    /// # Errors
    /// A pose that is not finite, or too many hypotheses.
    pub fn new(hypotheses: &[Hypothesis<'_>], background: &[[f32; 3]]) -> Result<Self, Error> {
        let mut scene = Self::default();
        scene.fill(hypotheses, background)?;
        Ok(scene)
    }

    /// Replaces the content of the scene, with the memory of the old one.
    ///
    /// # Errors
    /// As for [`new`](Self::new); the scene is empty then.
    pub fn fill(
        &mut self,
        hypotheses: &[Hypothesis<'_>],
        background: &[[f32; 3]],
    ) -> Result<(), Error> {
        self.clear();
        if hypotheses.len() > N_HYPOTHESES_MAX {
            return Err(Error::TooManyHypotheses {
                n: hypotheses.len(),
                max: N_HYPOTHESES_MAX,
            });
        }
        let is_finite = |hypothesis: &Hypothesis<'_>| is_pose_finite(&hypothesis.world_from_object);
        if let Some(index) = hypotheses.iter().position(|h| !is_finite(h)) {
            let what = "hypothesis";
            return Err(Error::NotFinite { what, index });
        }
        self.ids
            .extend(hypotheses.iter().map(|hypothesis| hypothesis.id));
        self.ids.sort_unstable();
        self.ids.dedup();
        self.middle_in_world = middle(hypotheses, background);
        self.add_background(background);
        for hypothesis in hypotheses {
            self.add_hypothesis(hypothesis);
        }
        let axes = [&self.x, &self.y, &self.z];
        let bound = |start: f32, least: fn(f32, f32) -> f32| {
            Vector3::from(axes.map(|axis| axis.iter().copied().fold(start, least)))
        };
        self.bounds = [
            bound(f32::INFINITY, f32::min),
            bound(f32::NEG_INFINITY, f32::max),
        ];
        Ok(())
    }

    fn clear(&mut self) {
        for axis in [&mut self.x, &mut self.y, &mut self.z] {
            axis.clear();
        }
        self.ranges.clear();
        self.ids.clear();
        self.spheres.clear();
        self.middle_in_world = Vector3::zeros();
        self.bounds = [Vector3::zeros(); 2];
    }

    fn add_background(&mut self, background: &[[f32; 3]]) {
        for point in background.iter().filter(|point| is_point_finite(point)) {
            self.add_point(Vector3::from(*point).cast::<f64>() - self.middle_in_world);
        }
        self.ranges.push((0..self.x.len(), 0));
    }

    fn add_hypothesis(&mut self, hypothesis: &Hypothesis<'_>) {
        let first = self.x.len();
        let mut pose = hypothesis.world_from_object;
        pose.translation.vector -= self.middle_in_world;
        for point in hypothesis.model.points() {
            self.add_point((pose * Point3::from(*point).cast::<f64>()).coords);
        }
        let range = first..self.x.len();
        let position = |i: usize| Vector3::new(self.x[i], self.y[i], self.z[i]);
        let (mut low, mut high) = (position(first), position(first));
        for i in range.clone() {
            low = low.inf(&position(i));
            high = high.sup(&position(i));
        }
        let centre = (low + high) / 2.0;
        let far_m = |i: usize| (position(i) - centre).norm();
        let radius_m = range.clone().map(far_m).fold(0.0, f32::max);
        self.spheres.push((centre, radius_m));
        let object = self.ids.partition_point(|&id| id < hypothesis.id);
        self.ranges.push((range, object as u16 + 1));
    }

    fn add_point(&mut self, relative: Vector3<f64>) {
        self.x.push(relative.x as f32);
        self.y.push(relative.y as f32);
        self.z.push(relative.z as f32);
    }

    /// Identities of the objects, ascending. Areas of a view are in this order.
    pub fn ids(&self) -> &[u32] {
        &self.ids
    }

    /// Number of points, background included.
    pub fn n_points(&self) -> usize {
        self.x.len()
    }

    /// Middle of the hypotheses, or of the background without them, world frame, metres.
    pub fn middle(&self) -> Point3<f64> {
        self.middle_in_world.into()
    }

    /// Camera position test: `true` within the bounding sphere of a hypothesis, or nearer than
    /// `near_m` to a point of the background.
    pub(crate) fn is_blocked(&self, camera_in_world: &Vector3<f64>, near_m: f32) -> bool {
        let camera = (camera_in_world - self.middle_in_world).cast::<f32>();
        // Most cameras are outside of the scene's bounding box.
        let is_outside = |axis: usize| {
            let [low, high] = self.bounds.map(|bound| bound[axis]);
            camera[axis] < low - near_m || camera[axis] > high + near_m
        };
        if (0..3).any(is_outside) {
            return false;
        }
        let is_inside = |(centre, radius_m): &(Vector3<f32>, f32)| {
            (camera - centre).norm() < radius_m.max(near_m)
        };
        let background = self.ranges.first().map_or(0..0, |(range, _)| range.clone());
        let is_near = |i: usize| {
            let (dx, dy, dz) = (
                self.x[i] - camera.x,
                self.y[i] - camera.y,
                self.z[i] - camera.z,
            );
            dx * dx + dy * dy + dz * dz < near_m * near_m
        };
        self.spheres.iter().any(is_inside) || background.into_iter().any(is_near)
    }
}

/// `true` if all numbers of a pose are finite.
pub(crate) fn is_pose_finite(pose: &RigidTransform) -> bool {
    let mut numbers = pose.translation.vector.iter().chain(&pose.rotation.coords);
    numbers.all(|number| number.is_finite())
}

fn is_point_finite(point: &[f32; 3]) -> bool {
    point.iter().all(|c| c.is_finite())
}

/// Mean position of the hypotheses' origins, or of the background points without hypotheses.
fn middle(hypotheses: &[Hypothesis<'_>], background: &[[f32; 3]]) -> Vector3<f64> {
    let (mut sum, mut n) = (Vector3::zeros(), 0.0);
    for hypothesis in hypotheses {
        sum += hypothesis.world_from_object.translation.vector;
        n += 1.0;
    }
    if hypotheses.is_empty() {
        for point in background.iter().filter(|point| is_point_finite(point)) {
            sum += Vector3::from(*point).cast::<f64>();
            n += 1.0;
        }
    }
    sum / f64::max(n, 1.0)
}
