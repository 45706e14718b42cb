//! Views of a BOP scene with its objects and their surroundings.

use super::bin_scene::{BinObject, BinScene, SURROUNDINGS_SPACING_M};
use super::bop_frame::BopFrame;
use super::bop_world::BopWorld;
use super::captured_view::{CapturedView, LabelledImage};
use super::filled_depth;
use super::scene_planner::ScenePlanner;
use super::segment_matching::SegmentMatcher;
use dataset::bop_scene::{BopObject, BopScene, open_model};
use mesh::{Surface, Triangle, TriangleMesh, Vertex};
use nalgebra::{Point3, Vector3};
use next_best_view::SurfaceModel;
use point_cloud::Point;
use service::Failure;
use std::path::Path;
use std::rc::Rc;

/// Least number of images: one to see from, and one to predict.
const N_IMAGES_MIN: usize = 2;

/// Share of the images that need a point in a voxel of the surroundings, so that errors of single
/// images do not pile up in front of the objects. Chosen of 0 to 0.3 on a written twin of 59
/// views, seed 1001: the figures are nearest those of known surroundings; from 0.3 on surfaces
/// vanish.
const CONFIRMED_SHARE: f64 = 0.05;

/// Captured views of a scene with the models of its objects; the seed is that of the noise of hypotheses.
///
/// # Errors
/// A file that is missing or not as in the format, fewer than two images, no objects, no
/// visible shares, or cameras whose poses nothing tells.
pub(super) fn read(folder: &Path, models: &Path, seed: u64) -> Result<Vec<CapturedView>, Failure> {
    let bop = BopScene::open(folder).map_err(Failure::usage)?;
    let shown = folder.display();
    if bop.images().len() < N_IMAGES_MIN {
        return Err(Failure::usage(format!(
            "the BOP scene {shown} has one image; the entropy of a view is predicted from \
             another one, so give a scene of at least {N_IMAGES_MIN} images"
        )));
    }
    let world = BopWorld::of(bop.images()).map_err(|image| {
        Failure::usage(format!(
            "the pose of the camera of image {image} of the BOP scene {shown} is not known: \
             scene_camera.json does not give cam_R_w2c and cam_t_w2c for all images, and the \
             image has no object in common with the others that tells the pose; add the poses, \
             or remove the image from scene_camera.json and scene_gt.json"
        ))
    })?;
    if world.objects.is_empty() {
        return Err(Failure::usage(format!(
            "scene_gt.json of the BOP scene {shown} lists no objects; give a scene with ground \
             truth"
        )));
    }
    check_visible_shares(&bop)?;
    let scene = scene(&bop, &world, models)?;
    let planner = ScenePlanner::new(&scene, None, seed, false)?;
    let mut matcher = SegmentMatcher::default();
    let views = (0..bop.images().len()).map(|number| {
        let frame = BopFrame::read(&bop, &world, number)?;
        view(&scene, frame, number, (&mut matcher, &planner))
    });
    views.collect()
}

/// Checks that the visible shares of all objects are known.
fn check_visible_shares(bop: &BopScene) -> Result<(), Failure> {
    let is_lacking = |object: &BopObject| object.visible_share.is_none();
    let mut images = bop.images().iter();
    match images.find(|image| image.objects.iter().any(is_lacking)) {
        Some(image) => Err(Failure::usage(format!(
            "the visible shares of image {} of the BOP scene {} are missing; make \
             scene_gt_info.json with the script calc_gt_info.py of the BOP toolkit",
            image.number,
            bop.folder().display()
        ))),
        None => Ok(()),
    }
}

/// Scene of the objects; the walls of a bin are not known.
fn scene(bop: &BopScene, world: &BopWorld, models: &Path) -> Result<BinScene, Failure> {
    let mut meshes: Vec<(u32, Rc<TriangleMesh>)> = Vec::new();
    let mut objects = Vec::new();
    for (object, id) in world.objects.iter().zip(1..) {
        if !meshes.iter().any(|(model, _)| *model == object.model) {
            let mesh = open_model(models, object.model).map_err(Failure::usage)?;
            meshes.push((object.model, Rc::new(triangle_mesh(&mesh))));
        }
        for (model, mesh) in meshes.iter().filter(|(model, _)| *model == object.model) {
            let name = model.to_string();
            let pose = object.world_from_object;
            objects.push(BinObject::new((id, &name), mesh.clone(), pose)?);
        }
    }
    let mut scene = BinScene::new(objects, None, world.world_from_cameras.clone());
    let mut surroundings = Vec::new();
    for index in 0..bop.images().len() {
        let frame = BopFrame::read(bop, world, index)?;
        surroundings.extend(thinned(&frame.surroundings(&scene.space))?);
    }
    scene.surroundings = thinned(&confirmed(surroundings, bop.images().len()))?;
    Ok(scene)
}

/// Points in voxels that enough images have a point in, of the thinned points of all images.
fn confirmed(mut points: Vec<[f32; 3]>, n_images: usize) -> Vec<[f32; 3]> {
    let n_min = (CONFIRMED_SHARE * n_images as f64).ceil() as usize;
    let voxel =
        |point: &[f32; 3]| point.map(|c| (c / SURROUNDINGS_SPACING_M as f32).floor() as i32);
    points.sort_by_key(voxel);
    let of_voxels = points.chunk_by(|a, b| voxel(a) == voxel(b));
    of_voxels
        .filter(|points| points.len() >= n_min)
        .flatten()
        .copied()
        .collect()
}

fn thinned(points: &[[f32; 3]]) -> Result<Vec<[f32; 3]>, Failure> {
    if points.is_empty() {
        return Ok(Vec::new());
    }
    let model = SurfaceModel::of_points(points, SURROUNDINGS_SPACING_M);
    Ok(model.map_err(Failure::general)?.points().to_vec())
}

fn triangle_mesh(read: &dataset::mesh::Mesh) -> TriangleMesh {
    let vertex = |point: &Point| Vertex {
        position: Point3::new(point.x, point.y, point.z),
        normal: Vector3::z(),
        color: point.color.rgb(),
    };
    let triangle = |&vertices: &[u32; 3]| Triangle {
        vertices,
        surface: 0,
    };
    TriangleMesh {
        vertices: read.vertices.iter().map(vertex).collect(),
        triangles: read.triangles.iter().map(triangle).collect(),
        surfaces: vec![Surface::MATTE],
    }
}

fn view(
    scene: &BinScene,
    frame: BopFrame,
    number: usize,
    (matcher, planner): (&mut SegmentMatcher, &ScenePlanner<'_>),
) -> Result<CapturedView, Failure> {
    let depth_m = filled_depth::filled(&frame.points, &frame.mask, frame.camera.width as usize);
    let image = LabelledImage {
        camera: frame.camera,
        world_from_camera: frame.world_from_camera,
        // The axes of the world are arbitrary.
        up_in_camera: None,
        points: &frame.points,
        depth_m: &depth_m,
        mask: &frame.mask,
        visible_shares: frame.visible_shares,
    };
    CapturedView::new(scene, image, number, (matcher, Some(planner)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surroundings_need_points_of_enough_images() {
        // Of 60 images three see the first voxel, and two the second.
        let place = |x: f32| [x, 0.001, 0.001];
        let points = [0.001, 0.101, 0.002, 0.102, 0.003].map(place).to_vec();
        let first = [0.001, 0.002, 0.003].map(place);
        assert_eq!(confirmed(points.clone(), 60), first);
        // Of a few images each counts.
        assert_eq!(confirmed(points, 12).len(), 5);
        assert!(confirmed(Vec::new(), 60).is_empty());
    }
}
