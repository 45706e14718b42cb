//! Cache of the shading attributes of the last face.

use crate::instance::Instance;
use crate::surface_attributes::FaceAttributes;
use crate::visibility_buffer::NO_FACE;

/// One-entry cache of face attributes; neighbouring pixels mostly show the same face.
#[derive(Debug, Default)]
pub(crate) struct FaceCache {
    number: Option<u32>,
    /// Index of the instance that the face belongs to.
    pub(crate) slot: usize,
    numbers: std::ops::Range<u32>,
    pub(crate) attributes: Option<FaceAttributes>,
}

impl FaceCache {
    #[inline]
    pub(crate) fn is(&self, face: u32) -> bool {
        self.number == Some(face)
    }

    /// Loads another face; `first_faces` holds the index of the first face of each instance.
    #[inline]
    pub(crate) fn load(&mut self, number: u32, instances: &[Instance<'_>], first_faces: &[u32]) {
        self.number = Some(number);
        if !self.numbers.contains(&number) {
            // The last instance that starts at or before the face; instances without faces share
            // their start.
            let n_begun = first_faces.partition_point(|&first| first <= number);
            self.slot = n_begun.saturating_sub(1);
            let end = first_faces.get(n_begun).copied().unwrap_or(NO_FACE);
            self.numbers = first_faces[self.slot]..end;
        }
        self.attributes = instances.get(self.slot).and_then(|instance| {
            let index = (number - self.numbers.start) as usize;
            let face = instance.mesh.faces.get(index)?;
            Some(FaceAttributes::new(instance.mesh, face))
        });
    }
}
