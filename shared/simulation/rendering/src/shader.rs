//! The look of all pixels in which something was drawn.

use crate::background::Rays;
use crate::instance::Instance;
use crate::pixel_block::{LitPixel, PixelBlock, RUN_MIN, Run};
use crate::reflected_light::CameraLights;
use crate::seen_face::SeenFace;
use crate::shading::InstanceLook;
use crate::shadow_map::ShadowMap;
use crate::visibility::{NO_FACE, Visibility};
use std::ops::Range;

/// What the look of the pixels depends on.
pub(crate) struct Shader<'a> {
    pub(crate) rays: &'a Rays,
    pub(crate) lights: &'a CameraLights,
    pub(crate) shadow: &'a ShadowMap,
    pub(crate) visibility: &'a Visibility,
    pub(crate) instances: &'a [Instance<'a>],
    /// Numbers of the faces at which instances begin.
    pub(crate) first_faces: &'a [u32],
    /// Of each instance; `None` where its transform is not finite.
    pub(crate) looks: &'a [Option<InstanceLook>],
}

impl Shader<'_> {
    /// Calls `take` with each pixel.
    #[inline]
    pub(crate) fn shade(&self, mut take: impl FnMut(&LitPixel)) {
        let (mut seen, mut block) = (SeenFace::default(), PixelBlock::new());
        let width = self.rays.size().0;
        for (row, extent) in self.visibility.extents.iter().enumerate() {
            let columns = extent.columns();
            let faces = &self.visibility.face[row * width..row * width + columns.end];
            let mut start = columns.start;
            while let Some(&face) = faces.get(start) {
                let others = faces[start..].iter().position(|&other| other != face);
                let end = others.map_or(faces.len(), |n| start + n);
                if face != NO_FACE {
                    if !seen.is(face) {
                        seen.turn_to(face, self.instances, self.first_faces);
                    }
                    self.gather(row, start..end, &seen, &mut block, &mut take);
                }
                start = end;
            }
        }
        block.flush(self.lights, self.shadow, &mut take);
    }

    /// Adds the pixels of a run to the block and lights it whenever it is full.
    #[inline]
    fn gather(
        &self,
        row: usize,
        columns: Range<usize>,
        seen: &SeenFace,
        block: &mut PixelBlock,
        mut take: impl FnMut(&LitPixel),
    ) {
        let (Some(face), Some(Some(look))) = (&seen.look, self.looks.get(seen.slot)) else {
            return;
        };
        let first = row * self.rays.size().0;
        let run = Run {
            row,
            column: columns.start,
            x: &self.rays.x()[columns.clone()],
            y: self.rays.y()[row],
            closeness: &self.visibility.closeness[first + columns.start..first + columns.end],
        };
        if columns.len() < RUN_MIN {
            for i in 0..columns.len() {
                if block.push(&run, i, face, look) {
                    block.flush(self.lights, self.shadow, &mut take);
                }
            }
            return;
        }
        let mut rest = Some(run);
        while let Some(run) = rest {
            rest = block.push_all(&run, face, look);
            if rest.is_some() {
                block.flush(self.lights, self.shadow, &mut take);
            }
        }
    }
}
