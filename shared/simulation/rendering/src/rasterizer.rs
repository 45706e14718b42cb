//! Rasteriser: visibility buffer, shadow map and deferred shading of mesh instances.

use crate::Error;
use crate::background::{Background, ShadowUpdate};
use crate::blinn_phong::CameraLights;
use crate::deferred_shader::DeferredShader;
use crate::dirty_shadow_blocks::DirtyShadowBlocks;
use crate::image::Image;
use crate::instance::Instance;
use crate::lights::Lights;
use crate::pixel_rays::PixelRays;
use crate::projected_mesh::{ProjectedMesh, is_mesh_visible, project_corners};
use crate::projection::{Projection, RigidTransformF32, ScreenCorner};
use crate::scanline::{FaceSide, rasterize};
use crate::shadow_grid::MAP_SIDE;
use crate::shadow_map::{LightView, ShadowMap};
use crate::surface_attributes::InstanceAttributes;
use crate::visibility_buffer::{ColumnRange, NO_FACE, VisibilityBuffer};
use geometry::{PinholeCamera, RigidTransform};

/// Static part of a scene: camera pose, lights and background.
#[derive(Debug, Clone, Copy)]
pub struct StaticScene<'a> {
    /// Pose of the camera, `world_from_camera`.
    pub world_from_camera: RigidTransform,
    /// Light sources of the scene.
    pub lights: Lights,
    /// Instances that do not move; may be empty.
    pub background: &'a [Instance<'a>],
}

/// Software rasteriser with its buffers.
///
/// [`Rasterizer::prepare`] draws the static background, [`Rasterizer::render`] draws the moving
/// instances over it. The result is the same, bit by bit, as preparing an empty background and
/// rendering the background's instances followed by the others. Back faces are culled. At equal
/// depth the first instance wins.
#[derive(Debug)]
pub struct Rasterizer {
    rays: PixelRays,
    projection: Projection,
    world_from_camera: RigidTransform,
    lights: Lights,
    light_view: Option<LightView>,
    image: Image,
    background: Background,
    visibility: VisibilityBuffer,
    shadow: ShadowMap,
    /// Columns of each row in which the image differs from the background.
    dirty: Vec<ColumnRange>,
    corners: Vec<ScreenCorner>,
    first_faces: Vec<u32>,
    attributes: Vec<Option<InstanceAttributes>>,
    dirty_blocks: DirtyShadowBlocks,
    /// Number of the count in which each pixel was last covered.
    stamps: Vec<u32>,
    n_counts: u32,
}

impl Rasterizer {
    /// Rasteriser for a camera, with an empty background.
    ///
    /// # Errors
    /// [`Error::Camera`] for invalid intrinsics.
    pub fn new(camera: PinholeCamera) -> Result<Self, Error> {
        let camera = camera.validated()?;
        let (width, height) = (camera.width as usize, camera.height as usize);
        let mut rasterizer = Self {
            rays: PixelRays::new(&camera),
            projection: Projection::of_camera(&camera),
            world_from_camera: RigidTransform::identity(),
            lights: Lights::ROOM,
            light_view: None,
            image: Image::new(camera),
            background: Background::new(Image::new(camera)),
            visibility: VisibilityBuffer::new(width, height),
            shadow: ShadowMap::new(),
            dirty: vec![ColumnRange::EMPTY; height],
            corners: Vec::new(),
            first_faces: Vec::new(),
            attributes: Vec::new(),
            dirty_blocks: DirtyShadowBlocks::new(),
            stamps: vec![0; width * height],
            n_counts: 0,
        };
        rasterizer.prepare(&StaticScene {
            world_from_camera: RigidTransform::identity(),
            lights: Lights::ROOM,
            background: &[],
        })?;
        Ok(rasterizer)
    }

    /// Intrinsics of the camera.
    pub fn camera(&self) -> &PinholeCamera {
        self.image.camera()
    }

    /// Image that was rendered last.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Sets the camera pose and the lights and draws the static background.
    ///
    /// For a camera that moves in each frame, it is cheaper to prepare an empty background and to
    /// render all instances.
    ///
    /// # Errors
    /// [`Error::Pose`] for a pose that is not finite; nothing is changed then.
    pub fn prepare(&mut self, scene: &StaticScene<'_>) -> Result<(), Error> {
        RigidTransformF32::new(&scene.world_from_camera).ok_or(Error::Pose)?;
        self.world_from_camera = scene.world_from_camera;
        self.lights = scene.lights;
        self.light_view = LightView::new(&scene.lights);
        self.shadow.view = self.light_view.as_ref().and_then(|view| {
            let map_from_camera =
                RigidTransformF32::new(&(view.map_from_world * self.world_from_camera));
            map_from_camera.map(|placement| (placement, view.projection))
        });
        if scene.background.is_empty() && self.background.is_empty {
            self.restore_background();
            return Ok(());
        }
        self.background.is_empty = scene.background.is_empty();
        self.visibility.clear();
        self.shadow.reverse_z.fill(0.0);
        self.draw(scene.background);
        self.background.clear_light();
        self.image.clear_span(0..self.image.depth_m.len());
        self.shade(scene.background, true);
        self.background
            .keep(&self.image, &self.visibility, &self.shadow);
        self.visibility.face.fill(NO_FACE);
        self.visibility.row_ranges.fill(ColumnRange::EMPTY);
        self.dirty.fill(ColumnRange::EMPTY);
        Ok(())
    }

    /// Renders moving instances over the background.
    pub fn render(&mut self, instances: &[Instance<'_>]) -> &Image {
        self.restore_background();
        self.draw(instances);
        self.shade(instances, false);
        self.dirty.copy_from_slice(&self.visibility.row_ranges);
        self.background.cast(
            &mut self.image,
            &mut self.dirty,
            &self.visibility.face,
            &ShadowUpdate {
                rays: &self.rays,
                map: &self.shadow,
                dirty_blocks: &self.dirty_blocks,
            },
        );
        &self.image
    }

    /// Number of pixels that an instance would cover without occlusion, from the prepared camera
    /// pose.
    pub fn n_unoccluded_px(&mut self, instance: &Instance<'_>) -> usize {
        let Some(camera_from_mesh) = self.camera_from_mesh(instance) else {
            return 0;
        };
        self.n_counts = self.n_counts.wrapping_add(1);
        if self.n_counts == 0 {
            self.stamps.fill(0);
            self.n_counts = 1;
        }
        project_corners(
            instance.mesh,
            &camera_from_mesh,
            &self.projection,
            &mut self.corners,
        );
        let (width, stamp) = (self.rays.size().0, self.n_counts);
        let view = ProjectedMesh {
            mesh: instance.mesh,
            camera_from_mesh: &camera_from_mesh,
            projection: &self.projection,
            corners: &self.corners,
            size: self.rays.size(),
        };
        let (stamps, mut n_px) = (&mut self.stamps, 0);
        view.for_each_span(|span, _| {
            let first = span.row * width;
            for pixel in &mut stamps[first + span.start..first + span.end] {
                n_px += usize::from(*pixel != stamp);
                *pixel = stamp;
            }
        });
        n_px
    }

    fn camera_from_mesh(&self, instance: &Instance<'_>) -> Option<RigidTransformF32> {
        RigidTransformF32::new(&(self.world_from_camera.inverse() * instance.world_from_mesh))
    }

    /// Restores the background in the pixels that the last render changed.
    fn restore_background(&mut self) {
        let width = self.rays.size().0;
        for (row, dirty) in self.dirty.iter_mut().enumerate() {
            let columns = dirty.columns();
            let span = row * width + columns.start..row * width + columns.end;
            let reverse_z = &mut self.visibility.reverse_z[span.clone()];
            if self.background.is_empty {
                self.image.clear_span(span.clone());
                reverse_z.fill(0.0);
            } else {
                self.image.copy_span(&self.background.image, span.clone());
                reverse_z.copy_from_slice(&self.background.reverse_z[span.clone()]);
            }
            self.visibility.face[span].fill(NO_FACE);
            *dirty = ColumnRange::EMPTY;
        }
        self.visibility.row_ranges.fill(ColumnRange::EMPTY);
        self.shadow
            .reverse_z
            .copy_from_slice(&self.background.shadow);
    }

    /// Draws instances into the visibility buffer and the shadow map.
    fn draw(&mut self, instances: &[Instance<'_>]) {
        self.first_faces.clear();
        self.dirty_blocks.clear();
        let mut first_face = 0_u32;
        for instance in instances {
            self.first_faces.push(first_face);
            let n_faces = instance.mesh.faces.len() as u32;
            let Some(end) = first_face.checked_add(n_faces).filter(|&end| end < NO_FACE) else {
                continue;
            };
            self.draw_visible(instance, first_face);
            self.draw_shadow_caster(instance);
            first_face = end;
        }
        self.shadow.finish();
    }

    fn draw_visible(&mut self, instance: &Instance<'_>, first_face: u32) {
        let Some(camera_from_mesh) = self.camera_from_mesh(instance) else {
            return;
        };
        let size = self.rays.size();
        if !is_mesh_visible(&self.projection, &camera_from_mesh, instance.mesh, size) {
            return;
        }
        project_corners(
            instance.mesh,
            &camera_from_mesh,
            &self.projection,
            &mut self.corners,
        );
        let view = ProjectedMesh {
            mesh: instance.mesh,
            camera_from_mesh: &camera_from_mesh,
            projection: &self.projection,
            corners: &self.corners,
            size: self.rays.size(),
        };
        let visibility = &mut self.visibility;
        view.for_each_span(|span, face| visibility.draw(span, first_face + face));
    }

    fn draw_shadow_caster(&mut self, instance: &Instance<'_>) {
        let Some(view) = &self.light_view else {
            return;
        };
        let Some(map_from_mesh) =
            RigidTransformF32::new(&(view.map_from_world * instance.world_from_mesh))
        else {
            return;
        };
        if !is_mesh_visible(
            &view.projection,
            &map_from_mesh,
            instance.mesh,
            (MAP_SIDE, MAP_SIDE),
        ) {
            return;
        }
        project_corners(
            instance.mesh,
            &map_from_mesh,
            &view.projection,
            &mut self.corners,
        );
        let (shadow, dirty_blocks) = (&mut self.shadow, &mut self.dirty_blocks);
        for face in &instance.mesh.faces {
            let corners = face.corners.map(|i| &self.corners[i as usize]);
            if corners.iter().all(|corner| corner.reverse_z > 0.0) {
                rasterize(corners, FaceSide::Back, (MAP_SIDE, MAP_SIDE), |span| {
                    shadow.draw(&span);
                    dirty_blocks.draw(&span);
                });
            }
        }
        dirty_blocks.end_instance();
    }

    /// Shades all covered pixels.
    fn shade(&mut self, instances: &[Instance<'_>], is_background: bool) {
        let Some(camera_from_world) = RigidTransformF32::new(&self.world_from_camera.inverse())
        else {
            return;
        };
        self.attributes.clear();
        self.attributes.extend(
            instances
                .iter()
                .map(|instance| InstanceAttributes::new(instance, &self.world_from_camera)),
        );
        let shader = DeferredShader {
            rays: &self.rays,
            lights: &CameraLights::new(&self.lights, &camera_from_world),
            shadow: &self.shadow,
            visibility: &self.visibility,
            instances,
            first_faces: &self.first_faces,
            attributes: &self.attributes,
        };
        let (image, background) = (&mut self.image, &mut self.background);
        let width = self.rays.size().0;
        if is_background {
            shader.shade(|lit| {
                let pixel = lit.row * width + lit.column;
                image.set(pixel, lit);
                background.keep_light(pixel, lit);
            });
        } else {
            shader.shade(|lit| image.set(lit.row * width + lit.column, lit));
        }
    }
}
