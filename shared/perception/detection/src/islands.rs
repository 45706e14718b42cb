//! Parts of the table's plane that are no table: the floor of a pot, the middle
//! of a plate.

use crate::axis::Axis;
use crate::samples::Samples;

/// Number of the part of samples that are not level with the table.
const NO_PART: u16 = 0;

/// An island has this many samples at least,
const SAMPLES_MIN: u32 = 4;

/// and at most: a table between objects may be cut in two by them.
const SAMPLES_MAX: u32 = 2_000;

/// Its mean height over the table is more than this, metres: through the
/// handle of a cup the table itself is seen.
const MEAN_HEIGHT_MIN_M: f32 = 0.0025;

/// This share of what surrounds it must be higher than the table.
const RIM_SHARE_MIN: f32 = 0.7;

/// How high over the table an island's points lie, metres.
const HEIGHT_M: std::ops::RangeInclusive<f32> = -0.006..=0.02;

/// Rows when there are no islands.
const NO_ROWS: [usize; 2] = [1, 0];

/// The islands found last, and buffers.
#[derive(Debug, Default)]
pub(crate) struct Islands {
    places: Vec<Place>,
    part_of: Vec<u16>,
    parts: Vec<Part>,
    stack: Vec<u32>,
    /// Pixels between samples, columns of samples.
    stride: usize,
    width: usize,
    /// First and last row of samples with an island; empty without any.
    rows: [usize; 2],
}

/// A connected part of the samples level with the table.
#[derive(Debug, Clone, Copy, Default)]
struct Part {
    n: u32,
    height_sum_m: f32,
    /// Neighbours higher than the table, and all others.
    n_rim: u32,
    n_open: u32,
}

impl Part {
    fn is_island(&self) -> bool {
        let surrounded = self.n_rim as f32 >= RIM_SHARE_MIN * (self.n_rim + self.n_open) as f32;
        (SAMPLES_MIN..=SAMPLES_MAX).contains(&self.n)
            && self.height_sum_m > MEAN_HEIGHT_MIN_M * self.n as f32
            && surrounded
    }
}

/// Where a sample is, seen from the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Level,
    Above,
    BelowOrUnknown,
}

impl Islands {
    /// Finds the parts of the plane that objects surround in the image and that
    /// lie a little higher than the table. `lowest_m` tells, by depth, how high
    /// a point must be to be over the table.
    pub(crate) fn find(&mut self, samples: &Samples, height: &Axis, lowest_m: impl Fn(f32) -> f32) {
        let place = |sample: usize| {
            let above = samples.along(height, sample);
            let lowest_m = lowest_m(samples.depth(sample));
            if !samples.is_free(sample) || above < -lowest_m {
                Place::BelowOrUnknown
            } else if above > lowest_m {
                Place::Above
            } else {
                Place::Level
            }
        };
        self.places.clear();
        self.places.extend((0..samples.len()).map(place));
        (self.stride, self.width) = (samples.stride(), samples.width());
        self.part_of.clear();
        self.part_of.resize(samples.len(), NO_PART);
        self.parts.clear();
        self.parts.push(Part::default());
        for start in 0..samples.len() {
            let is_new = self.part_of[start] == NO_PART && self.places[start] == Place::Level;
            if is_new && self.parts.len() < usize::from(u16::MAX) {
                let part = self.flood(start, samples, height);
                self.parts.push(part);
            }
        }
        let is_on_island = |part: &u16| self.parts[usize::from(*part)].is_island();
        let row = |at: Option<usize>| at.map_or(usize::MAX, |at| at / self.width);
        self.rows = if self.parts.iter().any(Part::is_island) {
            let parts = self.part_of.iter();
            [
                row(parts.clone().position(is_on_island)),
                row(parts.clone().rposition(is_on_island)),
            ]
        } else {
            NO_ROWS
        };
    }

    /// Marks the level samples connected with `start`.
    fn flood(&mut self, start: usize, samples: &Samples, height: &Axis) -> Part {
        let (number, width) = (self.parts.len() as u16, self.width);
        let mut part = Part::default();
        self.part_of[start] = number;
        self.stack.push(start as u32);
        while let Some(sample) = self.stack.pop() {
            let sample = sample as usize;
            part.n += 1;
            part.height_sum_m += samples.along(height, sample);
            let column = sample % width;
            let left = (column > 0).then(|| sample - 1);
            let right = (column + 1 < width).then_some(sample + 1);
            let up = sample.checked_sub(width);
            let down = Some(sample + width).filter(|&below| below < samples.len());
            let is_level = |at: Option<usize>| at.is_some_and(|at| self.places[at] == Place::Level);
            for (near, sides) in [
                (left, [up, down]),
                (right, [up, down]),
                (up, [left, right]),
                (down, [left, right]),
            ] {
                match near.map_or(Place::BelowOrUnknown, |near| self.places[near]) {
                    Place::Above => part.n_rim += 1,
                    Place::BelowOrUnknown => part.n_open += 1,
                    Place::Level => {
                        // Two abreast: a thin wall seen edge-on leaves gaps of one.
                        let step = near.map(|near| near.wrapping_sub(sample));
                        let is_wide = sides.into_iter().any(|side| {
                            let ahead = side.zip(step).map(|(side, step)| side.wrapping_add(step));
                            is_level(side) && is_level(ahead.filter(|&at| at < samples.len()))
                        });
                        let new = near.filter(|&near| self.part_of[near] == NO_PART);
                        if let Some(near) = new.filter(|_| is_wide) {
                            self.part_of[near] = number;
                            self.stack.push(near as u32);
                        }
                    }
                }
            }
        }
        part
    }

    /// Whether a row of the image may have some.
    pub(crate) fn reach_row(&self, row: usize) -> bool {
        (self.rows[0]..=self.rows[1]).contains(&(row / self.stride))
    }

    /// Whether a pixel whose point lies at a height lies on an island.
    #[inline]
    pub(crate) fn hold(&self, column: usize, row: usize, height_m: f32) -> bool {
        let sample_column = (column / self.stride).min(self.width - 1);
        let sample = row / self.stride * self.width + sample_column;
        let part = self.part_of.get(sample).map(|&part| usize::from(part));
        part.is_some_and(|part| self.parts[part].is_island()) && HEIGHT_M.contains(&height_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RawConfig;
    use geometry::Plane;
    use nalgebra::{Point3, Vector3};
    use point_cloud::{OrganizedCloud, Point, Rgba};

    /// A plane at 1 m seen straight from above, on which a wall around a square
    /// floor stands; heights in metres.
    fn islands(wall_m: f32, floor_m: f32) -> Islands {
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
        let mut islands = Islands::default();
        islands.find(&samples, &Axis::from(&plane), |_| 0.008);
        islands
    }

    #[test]
    fn the_floor_of_a_pot_is_an_island_and_the_table_around_is_none() {
        let islands = islands(0.05, 0.005);
        assert!(islands.reach_row(60) && !islands.reach_row(20));
        assert!(islands.hold(80, 60, 0.005) && !islands.hold(20, 20, 0.005));
        assert!(!islands.hold(80, 60, 0.05), "too high for an island");
    }

    #[test]
    fn the_table_seen_through_a_ring_is_none() {
        assert!((0..120).all(|row| !islands(0.05, 0.0).reach_row(row)));
    }

    #[test]
    fn what_nothing_surrounds_is_none() {
        assert!((0..120).all(|row| !islands(0.0, 0.005).reach_row(row)));
    }
}
