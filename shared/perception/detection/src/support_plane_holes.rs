//! Support-plane holes: regions level with the table that an object encloses, such as the
//! floor of a pot or the middle of a plate.

use crate::affine_form::AffineForm;
use crate::samples::Samples;

/// Label of samples that are not level with the table.
const NO_REGION: u16 = 0;

/// Least number of samples of a hole. Chosen; sensitivity: see `tabula-lab sweep`.
const SAMPLES_MIN: u32 = 4;

/// Greatest number of samples of a hole; objects may cut a table in two. Chosen;
/// sensitivity: see `tabula-lab sweep`.
const SAMPLES_MAX: u32 = 2_000;

/// Least mean height of a hole over the table, metres; through the handle of a cup the
/// table itself is visible. Chosen; sensitivity: see `tabula-lab sweep`.
const MEAN_HEIGHT_MIN_M: f32 = 0.0025;

/// Least share of a hole's neighbours that are higher than the table. Chosen; sensitivity:
/// see `tabula-lab sweep`.
const RIM_SHARE_MIN: f32 = 0.7;

/// Height range of a hole's points over the table, metres. Chosen; sensitivity: see
/// `tabula-lab sweep`.
const HEIGHT_M: std::ops::RangeInclusive<f32> = -0.006..=0.02;

/// Row range that contains no rows.
const NO_ROWS: [usize; 2] = [1, 0];

/// Holes of the support plane found last, with buffers.
#[derive(Debug, Default)]
pub(crate) struct SupportPlaneHoles {
    height_classes: Vec<HeightClass>,
    region_of: Vec<u16>,
    regions: Vec<LevelRegion>,
    stack: Vec<u32>,
    /// Stride: pixels between samples.
    stride: usize,
    width: usize,
    /// First and last row of samples with a hole; empty without any.
    rows: [usize; 2],
}

/// Connected region of samples level with the table.
#[derive(Debug, Clone, Copy, Default)]
struct LevelRegion {
    n: u32,
    height_sum_m: f32,
    /// Number of neighbours higher than the table.
    n_rim: u32,
    n_open: u32,
}

impl LevelRegion {
    fn is_hole(&self) -> bool {
        let surrounded = self.n_rim as f32 >= RIM_SHARE_MIN * (self.n_rim + self.n_open) as f32;
        (SAMPLES_MIN..=SAMPLES_MAX).contains(&self.n)
            && self.height_sum_m > MEAN_HEIGHT_MIN_M * self.n as f32
            && surrounded
    }
}

/// Height class of a sample relative to the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum HeightClass {
    /// Pixel level with the table.
    Level,
    /// Pixel above the table.
    Above,
    /// Lower than the table or without depth.
    BelowOrUnknown,
}

impl SupportPlaneHoles {
    /// Find the level regions that objects enclose in the image and that are a little above
    /// the table. `lowest_m` gives the least height over the table of a point at a depth,
    /// metres.
    pub(crate) fn find(
        &mut self,
        samples: &Samples,
        height: &AffineForm,
        lowest_m: impl Fn(f32) -> f32,
    ) {
        let height_class = |sample: usize| {
            let above = samples.coordinate(height, sample);
            let lowest_m = lowest_m(samples.depth(sample));
            if !samples.is_unassigned(sample) || above < -lowest_m {
                HeightClass::BelowOrUnknown
            } else if above > lowest_m {
                HeightClass::Above
            } else {
                HeightClass::Level
            }
        };
        self.height_classes.clear();
        self.height_classes
            .extend((0..samples.len()).map(height_class));
        (self.stride, self.width) = (samples.stride(), samples.width());
        self.region_of.clear();
        self.region_of.resize(samples.len(), NO_REGION);
        self.regions.clear();
        self.regions.push(LevelRegion::default());
        for start in 0..samples.len() {
            let is_new = self.region_of[start] == NO_REGION
                && self.height_classes[start] == HeightClass::Level;
            if is_new && self.regions.len() < usize::from(u16::MAX) {
                let region = self.flood(start, samples, height);
                self.regions.push(region);
            }
        }
        let is_in_hole = |region: &u16| self.regions[usize::from(*region)].is_hole();
        let row = |at: Option<usize>| at.map_or(usize::MAX, |at| at / self.width);
        self.rows = if self.regions.iter().any(LevelRegion::is_hole) {
            let regions = self.region_of.iter();
            [
                row(regions.clone().position(is_in_hole)),
                row(regions.clone().rposition(is_in_hole)),
            ]
        } else {
            NO_ROWS
        };
    }

    /// Flood fill of the level samples connected with `start`.
    fn flood(&mut self, start: usize, samples: &Samples, height: &AffineForm) -> LevelRegion {
        let (number, width) = (self.regions.len() as u16, self.width);
        let mut region = LevelRegion::default();
        self.region_of[start] = number;
        self.stack.push(start as u32);
        while let Some(sample) = self.stack.pop() {
            let sample = sample as usize;
            region.n += 1;
            region.height_sum_m += samples.coordinate(height, sample);
            let column = sample % width;
            let left = (column > 0).then(|| sample - 1);
            let right = (column + 1 < width).then_some(sample + 1);
            let up = sample.checked_sub(width);
            let down = Some(sample + width).filter(|&below| below < samples.len());
            let is_level = |at: Option<usize>| {
                at.is_some_and(|at| self.height_classes[at] == HeightClass::Level)
            };
            for (near, sides) in [
                (left, [up, down]),
                (right, [up, down]),
                (up, [left, right]),
                (down, [left, right]),
            ] {
                match near.map_or(HeightClass::BelowOrUnknown, |near| {
                    self.height_classes[near]
                }) {
                    HeightClass::Above => region.n_rim += 1,
                    HeightClass::BelowOrUnknown => region.n_open += 1,
                    HeightClass::Level => {
                        // Require a width of two: a thin wall seen edge-on leaves gaps of
                        // one sample.
                        let step = near.map(|near| near.wrapping_sub(sample));
                        let is_wide = sides.into_iter().any(|side| {
                            let ahead = side.zip(step).map(|(side, step)| side.wrapping_add(step));
                            is_level(side) && is_level(ahead.filter(|&at| at < samples.len()))
                        });
                        let new = near.filter(|&near| self.region_of[near] == NO_REGION);
                        if let Some(near) = new.filter(|_| is_wide) {
                            self.region_of[near] = number;
                            self.stack.push(near as u32);
                        }
                    }
                }
            }
        }
        region
    }

    /// `true` when a row of the image may contain a hole.
    pub(crate) fn intersects_row(&self, row: usize) -> bool {
        (self.rows[0]..=self.rows[1]).contains(&(row / self.stride))
    }

    /// `true` when a pixel with a point at a height, metres, is in a hole.
    #[inline]
    pub(crate) fn contains(&self, column: usize, row: usize, height_m: f32) -> bool {
        let sample_column = (column / self.stride).min(self.width - 1);
        let sample = row / self.stride * self.width + sample_column;
        let region = self
            .region_of
            .get(sample)
            .map(|&region| usize::from(region));
        region.is_some_and(|region| self.regions[region].is_hole()) && HEIGHT_M.contains(&height_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RawConfig;
    use geometry::Plane;
    use nalgebra::{Point3, Vector3};
    use point_cloud::{OrganizedCloud, Point, Rgba};

    /// Plane at 1 m seen from above, with a wall around a square floor; heights in metres.
    fn holes(wall_m: f32, floor_m: f32) -> SupportPlaneHoles {
        let points: Vec<Point> = (0..160 * 120)
            .map(|i| {
                let (column, row) = (i % 160, i / 160);
                let away = usize::abs_diff(column, 80).max(usize::abs_diff(row, 60));
                let height_m = match away {
                    0..8 => floor_m,
                    8..12 => wall_m,
                    _ => 0.0,
                };
                Point {
                    x: column as f32 * 0.002,
                    y: row as f32 * 0.002,
                    z: 1.0 - height_m,
                    color: Rgba::default(),
                }
            })
            .collect();
        let mut samples = Samples::default();
        samples.refill(
            &OrganizedCloud::new(&points, 160, 120).unwrap(),
            &RawConfig::default(),
        );
        let plane = Plane::through(&Point3::new(0.0, 0.0, 1.0), -Vector3::z_axis());
        let mut holes = SupportPlaneHoles::default();
        holes.find(&samples, &AffineForm::from(&plane), |_| 0.008);
        holes
    }

    #[test]
    fn pot_floor_is_a_hole_and_the_table_around_is_not() {
        let holes = holes(0.05, 0.005);
        assert!(holes.intersects_row(60) && !holes.intersects_row(20));
        assert!(holes.contains(80, 60, 0.005) && !holes.contains(20, 20, 0.005));
        assert!(!holes.contains(80, 60, 0.05), "too high for an island");
    }

    #[test]
    fn table_inside_a_ring_is_not_a_hole() {
        assert!((0..120).all(|row| !holes(0.05, 0.0).intersects_row(row)));
    }

    #[test]
    fn unenclosed_region_is_not_a_hole() {
        assert!((0..120).all(|row| !holes(0.0, 0.005).intersects_row(row)));
    }
}
