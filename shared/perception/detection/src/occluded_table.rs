//! Occluded-table search: the plane of the table under an object whose top is a larger plane.

use crate::RawConfig;
use crate::affine_form::AffineForm;
use crate::footprint::Footprint;
use crate::plane_region::PlaneRegionBuffers;
use crate::samples::{Samples, plane_band_m};
use crate::table::FLOOR_GAP_M;
use geometry::Plane;

/// Least cosine of the angle between a table and the top of an object that leans on
/// another (20 degrees). Chosen.
const LEANING_COS_MIN: f64 = 0.94;

/// Greatest share of a top's samples below the table. Chosen.
const BELOW_SHARE_MAX: f64 = 0.05;

/// Greatest share of a top's samples as high over the table as a table is over its floor.
/// Chosen.
const HIGH_SHARE_MAX: f64 = 0.5;

/// Buffers of the occluded-table search.
#[derive(Debug, Default)]
pub(crate) struct OccludedTableBuffers {
    /// First and last column of a region in each row of the image.
    row_ends: Vec<Option<[usize; 2]>>,
    /// First and last row of a region in each column of the image.
    column_ends: Vec<Option<[usize; 2]>>,
}

/// Place of a sample relative to a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Above,
    On,
    Below,
}

/// Plane that may be the table under another, with the samples that are compared with it.
struct LowerPlane<'a> {
    height: AffineForm,
    samples: &'a Samples,
    config: &'a RawConfig,
}

/// Support test: `true` when `upper` is the top of an object on the table `lower`, or a
/// mixture of both. Of the wide region of `upper`, which was found last, nothing is below
/// `lower`, an object's size is above it, and around the region more rays meet `lower` than
/// pass it.
///
/// A table over a chair or a lower table fails: beside it, most rays meet the floor.
pub(crate) fn stands_on(
    samples: &Samples,
    [upper, lower]: [&Plane; 2],
    config: &RawConfig,
    n_min: usize,
    region: &PlaneRegionBuffers,
    buffers: &mut OccludedTableBuffers,
) -> bool {
    if upper.normal.dot(&lower.normal) < LEANING_COS_MIN {
        return false;
    }
    let upper_from_camera = upper.plane_from_source();
    let lower = LowerPlane {
        height: AffineForm::from(lower),
        samples,
        config,
    };
    let top_axes = AffineForm::coordinates_of(&upper_from_camera);
    lower.is_under(region, &top_axes, n_min) && lower.is_around(region, buffers)
}

impl LowerPlane<'_> {
    fn place(&self, sample: usize) -> Place {
        let height_m = self.samples.coordinate(&self.height, sample);
        let band_m = plane_band_m(self.samples.depth(sample), self.config);
        if height_m > band_m {
            Place::Above
        } else if height_m < -band_m {
            Place::Below
        } else {
            Place::On
        }
    }

    /// `true` when a region is on the plane or above it, and at least `n_min` samples of an
    /// object's size above it.
    fn is_under(
        &self,
        region: &PlaneRegionBuffers,
        [u, v, _]: &[AffineForm; 3],
        n_min: usize,
    ) -> bool {
        let mut top = Footprint::new();
        let (mut n, mut n_above, mut n_below, mut n_high) = (0, 0, 0, 0);
        for sample in region.samples() {
            n += 1;
            match self.place(sample) {
                Place::On => {}
                Place::Below => n_below += 1,
                Place::Above => {
                    n_above += 1;
                    let height_m = self.samples.coordinate(&self.height, sample);
                    n_high += usize::from(f64::from(height_m) >= FLOOR_GAP_M);
                    let [u, v] = [u, v].map(|axis| self.samples.coordinate(axis, sample));
                    top.add(u, v);
                }
            }
        }
        let is_at_most = |n_of: usize, share: f64| n_of as f64 <= share * f64::from(n);
        let is_object_sized = || {
            let rectangle = top.bounding_rectangle();
            rectangle.is_some_and(|top| 2.0 * top.half_sides_m.x <= self.config.side_max_m)
        };
        n_above >= n_min
            && is_at_most(n_below, BELOW_SHARE_MAX)
            && is_at_most(n_high, HIGH_SHARE_MAX)
            && is_object_sized()
    }

    /// `true` when of the rays beside a region in its rows and columns more meet the plane
    /// than pass it; rays that meet what is above the plane tell nothing.
    fn is_around(&self, region: &PlaneRegionBuffers, buffers: &mut OccludedTableBuffers) -> bool {
        let (width, height) = (self.samples.width(), self.samples.height());
        let OccludedTableBuffers {
            row_ends,
            column_ends,
        } = buffers;
        for (ends, n) in [(&mut *row_ends, height), (&mut *column_ends, width)] {
            ends.clear();
            ends.resize(n, None);
        }
        for sample in region.samples() {
            let (row, column) = (sample / width, sample % width);
            extend(&mut row_ends[row], column);
            extend(&mut column_ends[column], row);
        }
        let (mut n_on, mut n_below) = (0, 0);
        let mut count = |place: Option<Place>| {
            n_on += usize::from(place == Some(Place::On));
            n_below += usize::from(place == Some(Place::Below));
        };
        for (row, ends) in row_ends.iter().enumerate() {
            let Some([first, last]) = *ends else { continue };
            let at = |column| row * width + column;
            count(self.first_not_above((0..=first).rev().map(at)));
            count(self.first_not_above((last..width).map(at)));
        }
        for (column, ends) in column_ends.iter().enumerate() {
            let Some([first, last]) = *ends else { continue };
            let at = |row| row * width + column;
            count(self.first_not_above((0..=first).rev().map(at)));
            count(self.first_not_above((last..height).map(at)));
        }
        n_on > n_below
    }

    /// Place of the first sample that is not above the plane; `None` without one.
    fn first_not_above(&self, samples: impl Iterator<Item = usize>) -> Option<Place> {
        samples
            .filter(|&sample| self.samples.depth(sample) > 0.0)
            .map(|sample| self.place(sample))
            .find(|&place| place != Place::Above)
    }
}

/// Extend an interval, first and last, by a place.
fn extend(interval: &mut Option<[usize; 2]>, place: usize) {
    let [first, last] = interval.unwrap_or([place, place]);
    *interval = Some([first.min(place), last.max(place)]);
}
