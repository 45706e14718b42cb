//! Test support: a simulated scene as a folder in the BOP format, with the statistic that is
//! expected of it.

use super::super::bin_scene::BinScene;
use super::super::captured_view::{CAMERA, CapturedView, LabelledImage};
use super::super::scene_planner::ScenePlanner;
use super::super::segment_matching::SegmentMatcher;
use super::super::simulated_bin::SimulatedBin;
use dataset::bop_scene::{BopImage, BopObject, BopPixels, BopSceneWriter, write_model};
use dataset::mesh::MeshView;
use geometry::RigidTransform;
use point_cloud::{Point, Rgba};
use simulated_world::SimulatedKinect;
use std::path::Path;

/// Number of the model of all objects.
const MODEL: u32 = 1;

/// Contents of a written scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct Written {
    /// `true` for depth as the sensor measures it, `false` for the true depth.
    pub(super) is_measured: bool,
    /// `true` to write the poses of the cameras.
    pub(super) has_camera_poses: bool,
}

/// Writes a scene of objects of one model to `scene` and `models` of a folder, and gives the views
/// of the same scene as they are in the simulation, with walls and gravity unknown; the seed is
/// that of the noise of hypotheses.
pub(super) fn write(
    bin: SimulatedBin,
    folder: &Path,
    (written, seed): (Written, u64),
) -> Vec<CapturedView> {
    write_model_of(&bin, &folder.join("models"));
    let SimulatedBin {
        mut world,
        mounts,
        mut scene,
    } = bin;
    scene.walls = None;
    let planner = ScenePlanner::new(&scene, None, seed, false).unwrap();
    let mut kinect = SimulatedKinect::new(&world, CAMERA).unwrap();
    let mut points = vec![Point::default(); CAMERA.n_pixels()];
    let mut writer = BopSceneWriter::create(&folder.join("scene")).unwrap();
    let (mut matcher, mut views) = (SegmentMatcher::default(), Vec::new());
    for (number, mount) in mounts.iter().enumerate() {
        world.set_camera(*mount);
        let truth = kinect.look(&world, number as u64, &mut points).unwrap();
        let share = |id: u16| {
            let object = truth.iter().find(|object| object.id == id);
            object.unwrap().visible_fraction()
        };
        let visible_shares: Vec<f64> = scene
            .objects
            .iter()
            .map(|object| share(object.id))
            .collect();
        if !written.is_measured {
            set_true_depth(&mut points, kinect.image().depth_m());
        }
        let world_from_camera = world.world_from_camera();
        let image = LabelledImage {
            camera: CAMERA,
            world_from_camera,
            up_in_camera: None,
            points: &points,
            depth_m: kinect.image().depth_m(),
            mask: kinect.mask(),
            visible_shares,
        };
        let annotation = annotation(&scene, &image, number, written);
        write_image(&mut writer, &scene, &image, &annotation);
        views.push(
            CapturedView::new(&scene, image, number, (&mut matcher, Some(&planner))).unwrap(),
        );
    }
    writer.finish().unwrap();
    views
}

fn write_model_of(bin: &SimulatedBin, models: &Path) {
    let mesh = &bin.world.objects()[0].model.mesh;
    let vertices: Vec<Point> = mesh
        .vertices
        .iter()
        .map(|vertex| Point {
            x: vertex.position.x,
            y: vertex.position.y,
            z: vertex.position.z,
            color: Rgba::opaque(200, 180, 160),
        })
        .collect();
    let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.vertices).collect();
    let view = MeshView {
        vertices: &vertices,
        triangles: &triangles,
    };
    write_model(models, MODEL, view).unwrap();
}

fn set_true_depth(points: &mut [Point], depth_m: &[f32]) {
    let width = CAMERA.width as usize;
    for (pixel, (point, &z)) in points.iter_mut().zip(depth_m).enumerate() {
        let place = CAMERA.back_project((pixel % width) as f64, (pixel / width) as f64, z.into());
        let [x, y, z] = place.cast::<f32>().into();
        *point = if z.is_finite() {
            let color = point.color;
            Point { x, y, z, color }
        } else {
            Point::without_depth(point.color)
        };
    }
}

fn annotation(
    scene: &BinScene,
    image: &LabelledImage<'_>,
    number: usize,
    written: Written,
) -> BopImage {
    let camera_from_world: RigidTransform = image.world_from_camera.inverse();
    let objects = scene.objects.iter().zip(&image.visible_shares);
    let objects = objects.map(|(object, &share)| BopObject {
        model: MODEL,
        camera_from_object: camera_from_world * object.world_from_object,
        visible_share: Some(share),
    });
    BopImage {
        number: number as u32,
        focal_px: [CAMERA.fx_px, CAMERA.fy_px],
        principal_px: [CAMERA.cx_px, CAMERA.cy_px],
        depth_scale_mm: 0.1,
        camera_from_world: written.has_camera_poses.then_some(camera_from_world),
        objects: objects.collect(),
    }
}

fn write_image(
    writer: &mut BopSceneWriter,
    scene: &BinScene,
    image: &LabelledImage<'_>,
    annotation: &BopImage,
) {
    let depth_m: Vec<f32> = image.points.iter().map(|point| point.z).collect();
    let colors: Vec<u8> = image
        .points
        .iter()
        .flat_map(|point| point.color.rgb())
        .collect();
    let is_of = |id: u16| image.mask.iter().map(|&seen| seen == id).collect();
    let masks: Vec<Vec<bool>> = scene
        .objects
        .iter()
        .map(|object| is_of(object.id))
        .collect();
    let pixels = BopPixels {
        size: (CAMERA.width, CAMERA.height),
        depth_m: &depth_m,
        colors: &colors,
        visible_masks: &masks,
    };
    writer.write_image(annotation, &pixels).unwrap();
}
