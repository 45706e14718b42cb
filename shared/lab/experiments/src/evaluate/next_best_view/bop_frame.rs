//! Pixels of a BOP image: measured points and the objects that they show.

use super::bop_world::BopWorld;
use dataset::NEUTRAL_GREY;
use dataset::bop_scene::BopScene;
use geometry::{PinholeCamera, RigidTransform};
use point_cloud::{Point, Rgba};
use service::Failure;
use view_planning::PlanningSpace;

/// Distance from the silhouettes of objects within which a pixel is not taken for surroundings,
/// pixels. Chosen: depth is unreliable there.
const BORDER_PX: usize = 3;

/// Pixels of a BOP image, row-major.
#[derive(Debug)]
pub(super) struct BopFrame {
    pub(super) camera: PinholeCamera,
    pub(super) world_from_camera: RigidTransform,
    pub(super) points: Vec<Point>,
    /// One more than the index of the object in the scene, or 0.
    pub(super) mask: Vec<u16>,
    pub(super) visible_shares: Vec<f64>,
}

impl BopFrame {
    /// Reads the pixels of an image by its index.
    ///
    /// # Errors
    /// A file that is missing, damaged or of another size.
    pub(super) fn read(bop: &BopScene, world: &BopWorld, index: usize) -> Result<Self, Failure> {
        let image = &bop.images()[index];
        let (mut depth_m, mut colors) = (Vec::new(), Vec::new());
        let (width, height) = bop
            .read_depth(index, &mut depth_m)
            .map_err(Failure::usage)?;
        let ([fx, fy], [cx, cy]) = (image.focal_px, image.principal_px);
        let camera = PinholeCamera::with_intrinsics([fx, fy, cx, cy], [width, height]);
        let camera = camera.map_err(Failure::usage)?;
        let color_size = bop.read_color(index, &mut colors).map_err(Failure::usage)?;
        check_size(bop, index, color_size.unwrap_or((width, height)), &camera)?;
        Ok(Self {
            points: points(&camera, &depth_m, &colors),
            mask: mask(bop, world, index, &camera)?,
            visible_shares: visible_shares(bop, world, index),
            world_from_camera: world.world_from_cameras[index],
            camera,
        })
    }

    /// Measured points in the space that show no object, world frame, metres.
    pub(super) fn surroundings(&self, space: &PlanningSpace) -> Vec<[f32; 3]> {
        let width = self.camera.width as usize;
        let is_near_object = |pixel: usize| {
            let (column, row) = (pixel % width, pixel / width);
            let rows = row.saturating_sub(BORDER_PX)..=row + BORDER_PX;
            let columns = column.saturating_sub(BORDER_PX)..=(column + BORDER_PX).min(width - 1);
            rows.into_iter().any(|row| {
                let of_row = row * width + columns.start()..=row * width + columns.end();
                let ids = self.mask.get(of_row).unwrap_or_default();
                ids.iter().any(|&id| id != 0)
            })
        };
        let finite = self.points.iter().enumerate();
        let finite = finite.filter(|(_, point)| point.is_finite());
        let places =
            finite.map(|(pixel, point)| (pixel, self.world_from_camera * point.position()));
        places
            .filter(|(pixel, place)| space.contains(place) && !is_near_object(*pixel))
            .map(|(_, place)| place.cast::<f32>().into())
            .collect()
    }
}

/// Measured points, camera frame; without colours they are grey.
fn points(camera: &PinholeCamera, depth_m: &[f32], colors: &[u8]) -> Vec<Point> {
    let width = camera.width as usize;
    let point = |(pixel, &z): (usize, &f32)| {
        let color = match colors.get(3 * pixel..3 * pixel + 3) {
            Some(&[red, green, blue]) => Rgba::opaque(red, green, blue),
            _ => NEUTRAL_GREY,
        };
        if z <= 0.0 {
            return Point::without_depth(color);
        }
        let place = camera.back_project((pixel % width) as f64, (pixel / width) as f64, z.into());
        let [x, y, z] = place.cast::<f32>().into();
        Point { x, y, z, color }
    };
    depth_m.iter().enumerate().map(point).collect()
}

fn mask(
    bop: &BopScene,
    world: &BopWorld,
    index: usize,
    camera: &PinholeCamera,
) -> Result<Vec<u16>, Failure> {
    let (mut mask, mut seen) = (vec![0; camera.n_pixels()], Vec::new());
    for (entry, object) in world.objects_of_images[index].iter().enumerate() {
        let size = bop.read_visible_mask(index, entry, &mut seen);
        check_size(bop, index, size.map_err(Failure::usage)?, camera)?;
        for (id, _) in mask.iter_mut().zip(&seen).filter(|(_, is_seen)| **is_seen) {
            *id = *object as u16 + 1;
        }
    }
    Ok(mask)
}

fn check_size(
    bop: &BopScene,
    index: usize,
    size: (u32, u32),
    camera: &PinholeCamera,
) -> Result<(), Failure> {
    if size == (camera.width, camera.height) {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "image {} of the BOP scene {} has depth of {}x{} pixels but colours or a mask of {}x{}; \
         all must have the size of the depth",
        bop.images()[index].number,
        bop.folder().display(),
        camera.width,
        camera.height,
        size.0,
        size.1
    )))
}

/// Visible share of each object of the world; 0 for one that the image does not list.
fn visible_shares(bop: &BopScene, world: &BopWorld, index: usize) -> Vec<f64> {
    let seen = bop.images()[index].objects.iter();
    let mut shares = vec![0.0; world.objects.len()];
    for (seen, object) in seen.zip(&world.objects_of_images[index]) {
        shares[*object] = seen.visible_share.unwrap_or_default();
    }
    shares
}
