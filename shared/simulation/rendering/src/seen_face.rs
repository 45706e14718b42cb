//! From a face's number to its look.

use crate::instance::Instance;
use crate::shading::FaceLook;
use crate::visibility::NO_FACE;

/// The face looked at last; neighbouring pixels mostly show the same.
#[derive(Debug, Default)]
pub(crate) struct SeenFace {
    number: Option<u32>,
    /// Which instance it belongs to, and the numbers of that instance's faces.
    pub(crate) slot: usize,
    numbers: std::ops::Range<u32>,
    pub(crate) look: Option<FaceLook>,
}

impl SeenFace {
    #[inline]
    pub(crate) fn is(&self, face: u32) -> bool {
        self.number == Some(face)
    }

    /// Looks at another face; `first_faces` are the numbers at which instances begin.
    #[inline]
    pub(crate) fn turn_to(&mut self, number: u32, instances: &[Instance<'_>], first_faces: &[u32]) {
        self.number = Some(number);
        if !self.numbers.contains(&number) {
            // The last that begins at or before the face; ones without faces share a beginning.
            let n_begun = first_faces.partition_point(|&first| first <= number);
            self.slot = n_begun.saturating_sub(1);
            let end = first_faces.get(n_begun).copied().unwrap_or(NO_FACE);
            self.numbers = first_faces[self.slot]..end;
        }
        self.look = instances.get(self.slot).and_then(|instance| {
            let index = (number - self.numbers.start) as usize;
            let face = instance.mesh.faces.get(index)?;
            Some(FaceLook::new(instance.mesh, face))
        });
    }
}
