//! Support-plane holes: regions level with the table that an object encloses, such as the
//! floor of a pot or the middle of a plate.

use crate::affine_form::AffineForm;
use crate::samples::Samples;
use union_find::union;

/// Label of samples that are not level with the table.
const NO_REGION: u32 = 0;

/// Least number of samples of a hole. Chosen.
const SAMPLES_MIN: u32 = 4;

/// Greatest number of samples of a hole; objects may cut a table in two. Chosen.
const SAMPLES_MAX: u32 = 2_000;

/// Least mean height of a hole over the table, metres; through the handle of a cup the
/// table itself is visible. Chosen.
const MEAN_HEIGHT_MIN_M: f32 = 0.0025;

/// Least share of a hole's neighbours that are higher than the table. Chosen.
const RIM_SHARE_MIN: f32 = 0.7;

/// Height range of a hole's points over the table, metres. Chosen.
const HEIGHT_M: std::ops::RangeInclusive<f32> = -0.006..=0.02;

/// Row range that contains no rows.
const NO_ROWS: [usize; 2] = [1, 0];

/// Holes of the support plane found last, with buffers.
#[derive(Debug, Default)]
pub(crate) struct SupportPlaneHoles {
    height_classes: Vec<HeightClass>,
    /// Per sample, `width + 1` places later: `true` when it and its neighbours right, below
    /// and right below are level.
    is_level_square: Vec<bool>,
    /// Per sample: [`NO_REGION`] or its label.
    label_of: Vec<u32>,
    /// Union-find forest, per label: the parent label; a root is its own parent.
    parents: Vec<u32>,
    /// Per root label: the region.
    regions: Vec<LevelRegion>,
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
    fn has_size_of_hole(&self) -> bool {
        (SAMPLES_MIN..=SAMPLES_MAX).contains(&self.n)
    }

    fn is_hole(&self) -> bool {
        let surrounded = self.n_rim as f32 >= RIM_SHARE_MIN * (self.n_rim + self.n_open) as f32;
        self.has_size_of_hole()
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
        let height_class = |([x, y, z], is_unassigned): ([f32; 3], bool)| {
            let (above, lowest_m) = (height.at(x, y, z), lowest_m(z));
            if !is_unassigned || above < -lowest_m {
                HeightClass::BelowOrUnknown
            } else if above > lowest_m {
                HeightClass::Above
            } else {
                HeightClass::Level
            }
        };
        self.height_classes.clear();
        self.height_classes
            .extend(samples.points().map(height_class));
        (self.stride, self.width) = (samples.stride(), samples.width());
        self.find_level_squares();
        self.label_regions();
        self.count_samples();
        self.measure_regions(samples, height);
    }

    /// Mark the squares of two by two level samples by their upper left one.
    fn find_level_squares(&mut self) {
        let Self {
            height_classes,
            is_level_square,
            width,
            ..
        } = self;
        is_level_square.clear();
        is_level_square.resize(height_classes.len() + *width + 1, false);
        let is_level = |class: HeightClass| class == HeightClass::Level;
        let rows = height_classes.chunks_exact((*width).max(1));
        let squares = is_level_square[*width + 1..].chunks_exact_mut((*width).max(1));
        for ((upper, lower), squares) in rows.clone().zip(rows.skip(1)).zip(squares) {
            for (i, square) in squares.iter_mut().take(*width - 1).enumerate() {
                *square = is_level(upper[i])
                    & is_level(upper[i + 1])
                    & is_level(lower[i])
                    & is_level(lower[i + 1]);
            }
        }
    }

    /// Label the regions of level samples. Neighbours are connected within a level square
    /// only: a thin wall seen edge-on leaves gaps of one sample.
    fn label_regions(&mut self) {
        let Self {
            height_classes,
            is_level_square,
            label_of,
            parents,
            width,
            ..
        } = self;
        label_of.clear();
        parents.clear();
        parents.push(NO_REGION);
        for (sample, class) in height_classes.iter().enumerate() {
            if *class != HeightClass::Level {
                label_of.push(NO_REGION);
                continue;
            }
            // Squares whose lower right, upper right and lower left sample this is.
            let is_last = is_level_square[sample];
            let is_right = is_level_square[sample + *width];
            let is_lower = is_level_square[sample + 1];
            label_of.push(match (is_last || is_right, is_last || is_lower) {
                (true, true) if !is_last => {
                    union(parents, label_of[sample - 1], label_of[sample - *width])
                }
                (true, _) => label_of[sample - 1],
                (false, true) => label_of[sample - *width],
                (false, false) => {
                    parents.push(parents.len() as u32);
                    parents.len() as u32 - 1
                }
            });
        }
    }

    /// Count the samples of each region and relabel them with the roots.
    fn count_samples(&mut self) {
        let Self {
            label_of,
            parents,
            regions,
            ..
        } = self;
        for i in 0..parents.len() {
            // A root is its own parent and precedes its members.
            parents[i] = parents[parents[i] as usize];
        }
        regions.clear();
        regions.resize(parents.len(), LevelRegion::default());
        for label in label_of.iter_mut().filter(|label| **label != NO_REGION) {
            *label = parents[*label as usize];
            regions[*label as usize].n += 1;
        }
    }

    /// Measure the regions that have the size of a hole, and find the rows with holes.
    fn measure_regions(&mut self, samples: &Samples, height: &AffineForm) {
        let n_samples = self.label_of.len();
        for sample in 0..n_samples {
            let region = &mut self.regions[self.label_of[sample] as usize];
            if !region.has_size_of_hole() {
                continue;
            }
            region.height_sum_m += samples.coordinate(height, sample);
            let column = sample % self.width;
            let neighbours = [
                (column > 0).then(|| sample - 1),
                (column + 1 < self.width).then_some(sample + 1),
                sample.checked_sub(self.width),
                Some(sample + self.width).filter(|&below| below < n_samples),
            ];
            for near in neighbours {
                match near.map(|near| self.height_classes[near]) {
                    Some(HeightClass::Above) => region.n_rim += 1,
                    Some(HeightClass::BelowOrUnknown) | None => region.n_open += 1,
                    Some(HeightClass::Level) => {}
                }
            }
        }
        let is_in_hole = |label: &u32| self.regions[*label as usize].is_hole();
        self.rows = NO_ROWS;
        if self.regions.iter().any(LevelRegion::is_hole) {
            let row = |at: Option<usize>| at.map_or(usize::MAX, |at| at / self.width);
            let labels = self.label_of.iter();
            self.rows = [
                row(labels.clone().position(is_in_hole)),
                row(labels.clone().rposition(is_in_hole)),
            ];
        }
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
        let region = self.label_of.get(sample).map(|&label| label as usize);
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
