//! Free space beneath the near rim of a surface, which tells a board from the top of a box.

use crate::affine_form::AffineForm;
use crate::plane_region::PlaneRegionBuffers;
use crate::samples::{Samples, plane_band_m};
use crate::{RawConfig, table::BOARD_THICKNESS_MAX_M};
use geometry::Plane;

/// Least depth step from a rim to what is seen beneath it, metres: free space. Chosen.
const FREE_STEP_M: f32 = 0.06;

/// Greatest depth step from a rim to the face that goes down from it, metres. Chosen.
const FACE_STEP_M: f32 = 0.03;

/// Greatest number of samples without depth between a rim and what is seen beneath it. Chosen.
const N_NO_DEPTH_MAX: usize = 6;

/// Least number of places at a rim with free space beneath. Chosen.
const N_FREE_MIN: usize = 8;

/// Background seen beneath a place at a rim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Beneath {
    /// Something farther: the surface is a board or the top of a table.
    FreeSpace,
    /// A face that goes down from the rim: the surface is the top of a box.
    Face,
}

/// Near rim of a region: its last sample downwards in each column or row of the subsampled
/// image. Reused from region to region.
#[derive(Debug, Default)]
pub(crate) struct NearRim {
    last: Vec<Option<usize>>,
}

impl NearRim {
    /// `true` when beneath more places of the near rim of the region found last free space is seen
    /// than a face.
    pub(crate) fn is_free_beneath(
        &mut self,
        samples: &Samples,
        plane: &Plane,
        region: &PlaneRegionBuffers,
        config: &RawConfig,
    ) -> bool {
        let down = Downwards::along(plane, samples);
        self.last.clear();
        self.last.resize(down.n_lines(), None);
        for sample in region.samples() {
            let last = &mut self.last[down.line(sample)];
            if last.is_none_or(|last| down.is_beyond(sample, last)) {
                *last = Some(sample);
            }
        }
        let height = AffineForm::from(plane);
        let [mut n_free, mut n_face] = [0_usize; 2];
        for &rim in self.last.iter().flatten() {
            match down.beneath(rim, samples, &height, config) {
                Some(Beneath::FreeSpace) => n_free += 1,
                Some(Beneath::Face) => n_face += 1,
                None => {}
            }
        }
        n_free >= N_FREE_MIN && n_free > n_face
    }
}

/// Direction against the normal of a plane in the subsampled image, along its rows or columns.
#[derive(Debug, Clone, Copy)]
struct Downwards {
    width: usize,
    height: usize,
    /// `true` along the rows of the image, for a camera that lies on its side.
    is_along_rows: bool,
    is_ascending: bool,
}

impl Downwards {
    fn along(plane: &Plane, samples: &Samples) -> Self {
        let normal = &plane.normal;
        let is_along_rows = normal.x.abs() > normal.y.abs();
        let component = if is_along_rows { normal.x } else { normal.y };
        Self {
            width: samples.width(),
            height: samples.height(),
            is_along_rows,
            is_ascending: component < 0.0,
        }
    }

    /// Column and row of a sample.
    fn place(&self, sample: usize) -> [usize; 2] {
        [sample % self.width, sample / self.width]
    }

    /// Number of lines in this direction.
    fn n_lines(&self) -> usize {
        [self.width, self.height][usize::from(self.is_along_rows)]
    }

    fn line(&self, sample: usize) -> usize {
        self.place(sample)[usize::from(self.is_along_rows)]
    }

    fn is_beyond(&self, sample: usize, other: usize) -> bool {
        (sample > other) == self.is_ascending
    }

    /// Samples beyond one up to the border of the image.
    fn beyond(&self, sample: usize) -> impl Iterator<Item = usize> {
        let along = usize::from(!self.is_along_rows);
        let at = self.place(sample)[along];
        let n_beyond = if self.is_ascending {
            [self.width, self.height][along] - 1 - at
        } else {
            at
        };
        let step = if self.is_along_rows { 1 } else { self.width };
        let is_ascending = self.is_ascending;
        (1..=n_beyond).map(move |n| {
            if is_ascending {
                sample + n * step
            } else {
                sample - n * step
            }
        })
    }

    /// Background beneath a place at the rim; `None` when something hides it, or nothing there has
    /// depth.
    fn beneath(
        &self,
        rim: usize,
        samples: &Samples,
        height: &AffineForm,
        config: &RawConfig,
    ) -> Option<Beneath> {
        let rim_depth_m = samples.depth(rim);
        let mut n_no_depth = 0;
        let mut is_face = None;
        for sample in self.beyond(rim) {
            let depth_m = samples.depth(sample);
            if depth_m <= 0.0 {
                n_no_depth += 1;
                if n_no_depth > N_NO_DEPTH_MAX {
                    break;
                }
                continue;
            }
            let height_m = samples.coordinate(height, sample);
            if height_m > plane_band_m(depth_m, config) {
                break;
            }
            if depth_m - rim_depth_m >= FREE_STEP_M {
                return Some(Beneath::FreeSpace);
            }
            if (depth_m - rim_depth_m).abs() > FACE_STEP_M {
                break;
            }
            if height_m < -BOARD_THICKNESS_MAX_M {
                is_face = Some(Beneath::Face);
                break;
            }
        }
        is_face
    }
}
