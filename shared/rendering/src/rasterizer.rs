//! Draws instances into an image.

use crate::Error;
use crate::background::{Background, NewShadows, Rays};
use crate::face_view::{FaceView, may_see, project};
use crate::image::{Image, Reflection};
use crate::instance::Instance;
use crate::lights::Lights;
use crate::pixel_block::{CameraLights, LitPixel, PixelBlock};
use crate::projection::{Lens, Placement, ScreenCorner};
use crate::scanline::{Side, scan};
use crate::seen_face::SeenFace;
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
        self.visibility.clear();
        self.shadow.closeness.fill(0.0);
        self.draw(stage.background);
        self.background.light.fill(0);
        self.clear_image();
        self.shade(stage.background, true);
        self.background
            .keep(&self.image, &self.visibility, &self.shadow);
        self.background.find_tiles(&self.rays, &self.shadow);
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

    fn clear_image(&mut self) {
        self.image.depth_m.fill(f32::INFINITY);
        self.image.instance.fill(0);
        self.image.color.fill([0; 3]);
        self.image.reflection.fill(Reflection::default());
    }

    /// Takes back what the last render has changed.
    fn restore_background(&mut self) {
        let width = self.rays.size().0;
        for (row, dirty) in self.dirty.iter_mut().enumerate() {
            let columns = dirty.columns();
            let span = row * width + columns.start..row * width + columns.end;
            self.image.copy_span(&self.background.image, span.clone());
            self.visibility.closeness[span.clone()]
                .copy_from_slice(&self.background.closeness[span.clone()]);
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
    }

    /// Computes the look of all pixels in which something was drawn.
    fn shade(&mut self, instances: &[Instance<'_>], is_background: bool) {
        let Some(camera_from_world) = Placement::new(&self.world_from_camera.inverse()) else {
            return;
        };
        let lights = CameraLights::new(&self.lights, &camera_from_world);
        self.looks.clear();
        self.looks.extend(
            instances
                .iter()
                .map(|instance| InstanceLook::new(instance, &self.world_from_camera)),
        );
        let (mut seen, mut block) = (SeenFace::default(), PixelBlock::new());
        let (width, height) = self.rays.size();
        for row in 0..height {
            for column in self.visibility.extents[row].columns() {
                let pixel = row * width + column;
                let face = self.visibility.face[pixel];
                if face == NO_FACE {
                    continue;
                }
                if !seen.is(face) {
                    seen.turn_to(face, instances, &self.first_faces);
                }
                let Some(face_look) = &seen.look else {
                    continue;
                };
                let Some(Some(look)) = self.looks.get(seen.slot) else {
                    continue;
                };
                let depth_m = 1.0 / self.visibility.closeness[pixel];
                let sample = face_look.sample(look, self.rays.point(column, row, depth_m));
                if block.push(pixel, &sample) {
                    block.flush(&lights, |lit| self.write(&lit, is_background));
                }
            }
        }
        block.flush(&lights, |lit| self.write(&lit, is_background));
    }

    #[expect(
        clippy::inline_always,
        reason = "a call would pass the pixel through memory; bench `render`"
    )]
    #[inline(always)]
    fn write(&mut self, lit: &LitPixel, is_background: bool) {
        let light = light_at(&self.shadow, lit);
        self.image.depth_m[lit.pixel] = lit.point[2];
        self.image.instance[lit.pixel] = lit.instance;
        self.image.color[lit.pixel] = lit.radiance.color(light);
        self.image.reflection[lit.pixel] = lit.reflection;
        if is_background {
            self.background.radiance[lit.pixel] = lit.radiance;
            self.background.light[lit.pixel] = light;
        }
    }
}

/// Share of the main light in a pixel, times 255; 0 where it has no effect.
#[inline]
fn light_at(shadow: &ShadowMap, lit: &LitPixel) -> u8 {
    if !lit.radiance.has_main_light() {
        return 0;
    }
    shadow
        .locate(lit.point)
        .map_or(u8::MAX, |place| shadow.light_at(&place))
}
