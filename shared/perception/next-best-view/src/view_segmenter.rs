//! Segmentation of a virtual view by detection, in place of the identities of its hypotheses.

use crate::virtual_view::VirtualView;
use detection::{
    Config, Detection, DetectionInput, Error, Execution, ScenePriors, Workspace, detect,
};
use nalgebra::{Unit, Vector3};
use point_cloud::{OrganizedCloud, Point};

/// Segmenter of virtual clouds with its buffers.
///
/// The virtual point cloud is segmented like a measured one (Kasaei et al. 2018). Detection is
/// made for the images of a pinhole camera; render the view with a perspective projection.
#[derive(Debug, Default)]
pub struct ViewSegmenter {
    config: Config,
    workspace: Workspace,
    detection: Detection,
    points: Vec<Point>,
    areas_m2: Vec<f64>,
}

impl ViewSegmenter {
    /// Segmenter with settings of detection.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            ..Self::default()
        }
    }

    /// Visible areas of the segments in a view, and the area of all the rest, square metres.
    /// `up_in_camera` is the direction against gravity.
    ///
    /// # Errors
    /// A view that detection refuses, such as one in which nothing is visible.
    pub fn segment(
        &mut self,
        view: &VirtualView,
        up_in_camera: Option<Unit<Vector3<f64>>>,
    ) -> Result<(&[f64], f64), Error> {
        view.write_cloud(&mut self.points);
        let (width, height) = view.size();
        self.areas_m2.clear();
        let Ok(cloud) = OrganizedCloud::new(&self.points, width, height) else {
            return Ok((&self.areas_m2, 0.0));
        };
        let frame = DetectionInput {
            cloud,
            up_in_camera,
            priors: ScenePriors::default(),
        };
        detect(
            &frame,
            &self.config,
            &mut self.workspace,
            &mut self.detection,
            Execution::default(),
        )?;
        let area_m2 = |index: usize| {
            view.cell_area_m2(index % width, index / width)
                .unwrap_or(0.0)
        };
        for candidate in self
            .detection
            .candidates
            .iter()
            .filter(|c| c.is_hypothesis())
        {
            let indices = self.detection.points_of(candidate).iter();
            self.areas_m2
                .push(indices.map(|&index| area_m2(index as usize)).sum());
        }
        let total_m2: f64 = (0..width * height).map(area_m2).sum();
        let segments_m2: f64 = self.areas_m2.iter().sum();
        Ok((&self.areas_m2, (total_m2 - segments_m2).max(0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Hypothesis, PlanningScene, RenderConfig, SurfaceModel, ViewProjection};
    use geometry::{PinholeCamera, RigidTransform};
    use nalgebra::Point3;

    /// Camera of a Kinect at half its resolution.
    const CAMERA: PinholeCamera = PinholeCamera {
        fx_px: 292.5,
        fy_px: 292.5,
        cx_px: 159.5,
        cy_px: 119.5,
        width: 320,
        height: 240,
    };

    #[test]
    fn detection_finds_the_hypotheses_in_their_virtual_cloud() {
        let mesh = mesh::rounded_box([0.1; 3], 0.002, 0.1).mesh;
        let cube = SurfaceModel::of_mesh(&mesh, 0.003).unwrap();
        let at = |id, x| Hypothesis {
            id,
            model: &cube,
            world_from_object: RigidTransform::translation(x, 0.0, 0.05),
        };
        let place = |i: u32| {
            [
                (i % 267) as f32 * 0.003 - 0.4,
                (i / 267) as f32 * 0.003 - 0.3,
                0.0,
            ]
        };
        let table: Vec<[f32; 3]> = (0..267 * 200).map(place).collect();
        let scene = PlanningScene::new(&[at(1, -0.2), at(2, 0.2)], &table).unwrap();
        let (eye, middle) = (Point3::new(0.0, -0.6, 0.7), Point3::origin());
        let camera = RigidTransform::face_towards(&eye, &middle, &-Vector3::z());
        let config = RenderConfig {
            projection: ViewProjection::Perspective(CAMERA),
            ..RenderConfig::default()
        };
        let mut view = VirtualView::default();
        view.render(&scene, &camera, &config).unwrap();
        let up = Unit::new_normalize(camera.rotation.inverse() * Vector3::z());
        let mut segmenter = ViewSegmenter::default();
        let (segments, rest) = segmenter.segment(&view, Some(up)).unwrap();
        assert_eq!(segments.len(), 2, "{segments:?}");
        let [first, second] = view.object_areas_m2() else {
            panic!("two objects");
        };
        for area in segments {
            assert!(
                (area / first - 1.0).abs() < 0.15,
                "{area} for {first} and {second}"
            );
        }
        let total = first + second + view.background_area_m2();
        let found = segments.iter().sum::<f64>() + rest;
        assert!((found / total - 1.0).abs() < 0.05, "{found} of {total}");
        // An empty view has no segments.
        let empty = PlanningScene::new(&[], &[]).unwrap();
        view.render(&empty, &camera, &config).unwrap();
        assert_eq!(segmenter.segment(&view, Some(up)).unwrap(), (&[][..], 0.0));
    }
}
