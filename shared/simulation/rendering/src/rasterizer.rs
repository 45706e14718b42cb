//! Draws instances into an image.

use crate::Error;
use crate::background::{Background, NewShadows, Rays};
use crate::face_view::{FaceView, may_see, project};
use crate::image::Image;
use crate::instance::Instance;
use crate::lights::Lights;
use crate::projection::{Lens, Placement, ScreenCorner};
use crate::reflected_light::CameraLights;
use crate::scanline::{Side, scan};
use crate::shader::Shader;
use crate::shading::InstanceLook;
use crate::shadow_map::{LightView, SIDE, ShadowMap};
use crate::shadow_reach::ShadowReach;
use crate::visibility::{Extent, NO_FACE, Visibility};
use geometry::{PinholeCamera, RigidTransform};

/// What stays the same from frame to frame.
#[derive(Debug, Clone, Copy)]
pub struct Stage<'a> {
    /// Where the camera is.
    pub world_from_camera: RigidTransform,
    /// What illuminates the scene.
    pub lights: Lights,
    /// What does not move; it may be empty.
    pub background: &'a [Instance<'a>],
}

/// A rasteriser with its buffers.
///
/// [`Rasterizer::prepare`] draws what does not move, [`Rasterizer::render`]
/// draws the rest over it. The result is the same, bit by bit, as preparing
/// nothing and rendering the background's instances followed by the others.
/// Faces are seen from their outside only. At equal depth the instance that
/// comes first is seen.
#[derive(Debug)]
pub struct Rasterizer {
    rays: Rays,
    lens: Lens,
    world_from_camera: RigidTransform,
    lights: Lights,
    light_view: Option<LightView>,
    image: Image,
    background: Background,
    visibility: Visibility,
    shadow: ShadowMap,
    /// Columns in which the image differs from the background.
    dirty: Vec<Extent>,
    corners: Vec<ScreenCorner>,
    first_faces: Vec<u32>,
    looks: Vec<Option<InstanceLook>>,
    reach: ShadowReach,
    /// In which count a pixel was last covered.
    stamps: Vec<u32>,
    n_counts: u32,
}

impl Rasterizer {
    /// A rasteriser for a camera that looks at nothing.
    ///
    /// # Errors
    /// When the camera is not valid.
    pub fn new(camera: PinholeCamera) -> Result<Self, Error> {
        let camera = camera.validated()?;
        let (width, height) = (camera.width as usize, camera.height as usize);
        let mut rasterizer = Self {
            rays: Rays::new(&camera),
            lens: Lens::of_camera(&camera),
            world_from_camera: RigidTransform::identity(),
            lights: Lights::ROOM,
            light_view: None,
            image: Image::new(camera),
            background: Background::new(Image::new(camera)),
            visibility: Visibility::new(width, height),
            shadow: ShadowMap::new(),
            dirty: vec![Extent::EMPTY; height],
            corners: Vec::new(),
            first_faces: Vec::new(),
            looks: Vec::new(),
            reach: ShadowReach::new(),
            stamps: vec![0; width * height],
            n_counts: 0,
        };
        rasterizer.prepare(&Stage {
            world_from_camera: RigidTransform::identity(),
            lights: Lights::ROOM,
            background: &[],
        })?;
        Ok(rasterizer)
    }

    /// The camera.
    pub fn camera(&self) -> &PinholeCamera {
        self.image.camera()
    }

    /// What was rendered last.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Sets camera pose and lights and draws what does not move.
    ///
    /// When the camera moves in each frame, it is cheaper to prepare a stage
    /// without background and to render everything.
    ///
    /// # Errors
    /// When the pose has a number that is not finite; nothing is changed then.
    pub fn prepare(&mut self, stage: &Stage<'_>) -> Result<(), Error> {
        Placement::new(&stage.world_from_camera).ok_or(Error::Pose)?;
        self.world_from_camera = stage.world_from_camera;
        self.lights = stage.lights;
        self.light_view = LightView::new(&stage.lights);
        self.shadow.view = self.light_view.as_ref().and_then(|view| {
            let map_from_camera = Placement::new(&(view.map_from_world * self.world_from_camera));
            map_from_camera.map(|placement| (placement, view.lens))
        });
        if stage.background.is_empty() && self.background.is_empty {
            self.restore_background();
            return Ok(());
        }
        self.background.is_empty = stage.background.is_empty();
        self.visibility.clear();
        self.shadow.closeness.fill(0.0);
        self.draw(stage.background);
        self.background.clear_light();
        self.image.clear_span(0..self.image.depth_m.len());
        self.shade(stage.background, true);
        self.background
            .keep(&self.image, &self.visibility, &self.shadow);
        self.visibility.face.fill(NO_FACE);
        self.visibility.extents.fill(Extent::EMPTY);
        self.dirty.fill(Extent::EMPTY);
        Ok(())
    }

    /// Draws instances over the background.
    pub fn render(&mut self, instances: &[Instance<'_>]) -> &Image {
        self.restore_background();
        self.draw(instances);
        self.shade(instances, false);
        self.dirty.copy_from_slice(&self.visibility.extents);
        self.background.cast(
            &mut self.image,
            &mut self.dirty,
            &self.visibility.face,
            &NewShadows {
                rays: &self.rays,
                map: &self.shadow,
                reach: &self.reach,
            },
        );
        &self.image
    }

    /// Pixels that an instance would cover if nothing else was there, seen
    /// from where the stage's camera is.
    pub fn n_unoccluded_px(&mut self, instance: &Instance<'_>) -> usize {
        let Some(camera_from_mesh) = self.camera_from_mesh(instance) else {
            return 0;
        };
        self.n_counts = self.n_counts.wrapping_add(1);
        if self.n_counts == 0 {
            self.stamps.fill(0);
            self.n_counts = 1;
        }
        project(
            instance.mesh,
            &camera_from_mesh,
            &self.lens,
            &mut self.corners,
        );
        let (width, stamp) = (self.rays.size().0, self.n_counts);
        let view = FaceView {
            mesh: instance.mesh,
            camera_from_mesh: &camera_from_mesh,
            lens: &self.lens,
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

    fn camera_from_mesh(&self, instance: &Instance<'_>) -> Option<Placement> {
        Placement::new(&(self.world_from_camera.inverse() * instance.world_from_mesh))
    }

    /// Takes back what the last render has changed.
    fn restore_background(&mut self) {
        let width = self.rays.size().0;
        for (row, dirty) in self.dirty.iter_mut().enumerate() {
            let columns = dirty.columns();
            let span = row * width + columns.start..row * width + columns.end;
            let closeness = &mut self.visibility.closeness[span.clone()];
            if self.background.is_empty {
                self.image.clear_span(span.clone());
                closeness.fill(0.0);
            } else {
                self.image.copy_span(&self.background.image, span.clone());
                closeness.copy_from_slice(&self.background.closeness[span.clone()]);
            }
            self.visibility.face[span].fill(NO_FACE);
            *dirty = Extent::EMPTY;
        }
        self.visibility.extents.fill(Extent::EMPTY);
        self.shadow
            .closeness
            .copy_from_slice(&self.background.shadow);
    }

    /// Finds the nearest faces seen by the camera and by the main light.
    fn draw(&mut self, instances: &[Instance<'_>]) {
        self.first_faces.clear();
        self.reach.clear();
        let mut first_face = 0_u32;
        for instance in instances {
            self.first_faces.push(first_face);
            let n_faces = instance.mesh.faces.len() as u32;
            let Some(end) = first_face.checked_add(n_faces).filter(|&end| end < NO_FACE) else {
                continue;
            };
            self.draw_seen(instance, first_face);
            self.draw_caster(instance);
            first_face = end;
        }
        self.shadow.finish();
    }

    fn draw_seen(&mut self, instance: &Instance<'_>, first_face: u32) {
        let Some(camera_from_mesh) = self.camera_from_mesh(instance) else {
            return;
        };
        let size = self.rays.size();
        if !may_see(&self.lens, &camera_from_mesh, instance.mesh, size) {
            return;
        }
        project(
            instance.mesh,
            &camera_from_mesh,
            &self.lens,
            &mut self.corners,
        );
        let view = FaceView {
            mesh: instance.mesh,
            camera_from_mesh: &camera_from_mesh,
            lens: &self.lens,
            corners: &self.corners,
            size: self.rays.size(),
        };
        let visibility = &mut self.visibility;
        view.for_each_span(|span, face| visibility.draw(span, first_face + face));
    }

    fn draw_caster(&mut self, instance: &Instance<'_>) {
        let Some(view) = &self.light_view else {
            return;
        };
        let Some(map_from_mesh) = Placement::new(&(view.map_from_world * instance.world_from_mesh))
        else {
            return;
        };
        if !may_see(&view.lens, &map_from_mesh, instance.mesh, (SIDE, SIDE)) {
            return;
        }
        project(instance.mesh, &map_from_mesh, &view.lens, &mut self.corners);
        let (shadow, reach) = (&mut self.shadow, &mut self.reach);
        for face in &instance.mesh.faces {
            let corners = face.corners.map(|i| &self.corners[i as usize]);
            if corners.iter().all(|corner| corner.closeness > 0.0) {
                scan(corners, Side::Back, (SIDE, SIDE), |span| {
                    shadow.draw(&span);
                    reach.draw(&span);
                });
            }
        }
        reach.end_instance();
    }

    /// Computes the look of all pixels in which something was drawn.
    fn shade(&mut self, instances: &[Instance<'_>], is_background: bool) {
        let Some(camera_from_world) = Placement::new(&self.world_from_camera.inverse()) else {
            return;
        };
        self.looks.clear();
        self.looks.extend(
            instances
                .iter()
                .map(|instance| InstanceLook::new(instance, &self.world_from_camera)),
        );
        let shader = Shader {
            rays: &self.rays,
            lights: &CameraLights::new(&self.lights, &camera_from_world),
            shadow: &self.shadow,
            visibility: &self.visibility,
            instances,
            first_faces: &self.first_faces,
            looks: &self.looks,
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
