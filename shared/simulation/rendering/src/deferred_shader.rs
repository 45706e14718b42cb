//! Deferred shading of the visibility buffer.

use crate::blinn_phong::CameraLights;
use crate::face_cache::FaceCache;
use crate::instance::Instance;
use crate::lit_pixel::LitPixel;
use crate::pixel_block::{FaceRun, MIN_RUN, PixelBlock};
use crate::pixel_rays::PixelRays;
use crate::shadow_map::ShadowMap;
use crate::surface_attributes::InstanceAttributes;
use crate::visibility_buffer::{NO_FACE, VisibilityBuffer};
use std::ops::Range;

/// Inputs of deferred shading.
pub(crate) struct DeferredShader<'a> {
    pub(crate) rays: &'a PixelRays,
    pub(crate) lights: &'a CameraLights,
    pub(crate) shadow: &'a ShadowMap,
    pub(crate) visibility: &'a VisibilityBuffer,
    pub(crate) instances: &'a [Instance<'a>],
    /// Index of each instance's first face.
    pub(crate) first_faces: &'a [u32],
    /// Shading attributes of each instance; `None` where its transform is not finite.
    pub(crate) attributes: &'a [Option<InstanceAttributes>],
}

impl DeferredShader<'_> {
    /// Shades all covered pixels and calls `take` with each of them.
    #[inline]
    pub(crate) fn shade(&self, mut take: impl FnMut(&LitPixel)) {
        let (mut cache, mut block) = (FaceCache::default(), PixelBlock::new());
        let width = self.rays.size().0;
        for (row, row_range) in self.visibility.row_ranges.iter().enumerate() {
            let columns = row_range.columns();
            let faces = &self.visibility.face[row * width..row * width + columns.end];
            let mut start = columns.start;
            while let Some(&face) = faces.get(start) {
                let others = faces[start..].iter().position(|&other| other != face);
                let end = others.map_or(faces.len(), |n| start + n);
                if face != NO_FACE {
                    if !cache.is(face) {
                        cache.load(face, self.instances, self.first_faces);
                    }
                    self.gather(row, start..end, &cache, &mut block, &mut take);
                }
                start = end;
            }
        }
        block.flush(self.lights, self.shadow, &mut take);
    }

    /// Adds the pixels of a run to the block and shades the block whenever it is full.
    #[inline]
    fn gather(
        &self,
        row: usize,
        columns: Range<usize>,
        cache: &FaceCache,
        block: &mut PixelBlock,
        mut take: impl FnMut(&LitPixel),
    ) {
        let (Some(face), Some(Some(instance))) =
            (&cache.attributes, self.attributes.get(cache.slot))
        else {
            return;
        };
        let first = row * self.rays.size().0;
        let run = FaceRun {
            row,
            column: columns.start,
            x: &self.rays.x()[columns.clone()],
            y: self.rays.y()[row],
            reverse_z: &self.visibility.reverse_z[first + columns.start..first + columns.end],
        };
        if columns.len() < MIN_RUN {
            for i in 0..columns.len() {
                if block.push(&run, i, face, instance) {
                    block.flush(self.lights, self.shadow, &mut take);
                }
            }
            return;
        }
        let mut rest = Some(run);
        while let Some(run) = rest {
            rest = block.push_all(&run, face, instance);
            if rest.is_some() {
                block.flush(self.lights, self.shadow, &mut take);
            }
        }
    }
}
