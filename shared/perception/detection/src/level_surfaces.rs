//! Levels of furniture: further support surfaces over or under the table, such as the boards of a
//! shelf, and the floor.
//!
//! The top of a box is level, too, but a face goes down from it; under a board or the top of a
//! table one sees free space. That, and a size that no object has, tells a level.

use crate::RawConfig;
use crate::affine_form::AffineForm;
use crate::footprint::Footprint;
use crate::plane_region::{RegionFilter, find_region, region_plane_and_middle};
use crate::samples::Samples;
use crate::table::{FLOOR_GAP_M, SurfaceRole, Table, TableChoice, is_same_surface};
use crate::table_selection::{
    ChosenPlane, PlaneCandidate, TableSelectionBuffers, find_again, outlined_table,
};
use geometry::{BoundingRectangle, Plane};
use nalgebra::Point3;

/// Least cosine of the angle between two levels (8 degrees). Chosen.
const PARALLEL_COS_MIN: f64 = 0.99;

/// Least gap between two levels, metres; the floors of trays and the tops of most objects are
/// nearer. Chosen.
const LEVEL_GAP_MIN_M: f64 = 0.12;

/// Least sides of the visible part of a level, metres; the tops of most objects and the seats of
/// chairs are smaller. Chosen.
const LEVEL_SIDES_MIN_M: [f64; 2] = [0.5, 0.12];

/// Greatest ratio of the lengths of two levels of one piece of furniture: the seat of a chair is
/// shorter than its table, and the floor goes on around it. Chosen.
const LENGTH_RATIO_MAX: f64 = 1.4;

/// Greatest number of surfaces in a frame.
const N_SURFACES_MAX: usize = 6;

/// Level beside the table.
#[derive(Debug, Clone, Copy)]
struct Level {
    plane: Plane,
    /// Middle of what is seen of it.
    middle: Point3<f64>,
    /// Height over the table, metres.
    gap_m: f64,
    /// Longest side of what is seen of it, metres.
    length_m: f64,
}

/// Levels of an image beside its table.
pub(crate) struct LevelSearch<'a> {
    pub(crate) samples: &'a Samples,
    pub(crate) config: &'a RawConfig,
    /// Surfaces of earlier frames predicted to this one, the table first; without any, each level
    /// that the image shows carries objects at once.
    pub(crate) expected: &'a [Plane],
    /// Least number of samples of a surface.
    pub(crate) n_min: usize,
}

impl LevelSearch<'_> {
    /// Append the levels to the surfaces, of which the table is the first; those that carry
    /// objects come first.
    pub(crate) fn find(&self, buffers: &mut TableSelectionBuffers, surfaces: &mut Vec<Table>) {
        let Some(table) = surfaces.first() else {
            return;
        };
        let (table, table_length_m) = (table.plane, length_m(table));
        let mut is_table_raised = None;
        // Height over the table of the lowest level so far.
        let mut lowest_m = 0.0_f64;
        let distance_m = |found: &PlaneCandidate| (found.plane.offset_m - table.offset_m).abs();
        buffers
            .found
            .sort_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
        for index in 0..buffers.found.len() {
            if !self.may_be_level(&buffers.found[index], &table) {
                continue;
            }
            let Some(level) = self.level(index, &table, buffers) else {
                continue;
            };
            // Whether a floor far below is under a raised table makes no difference.
            let is_raised = if level.gap_m > 0.0 {
                self.is_raised(&level.plane, buffers)
            } else {
                lowest_m - level.gap_m <= self.config.height_max_m
                    && *is_table_raised.get_or_insert_with(|| self.is_raised(&table, buffers))
            };
            let is_found =
                |found: &Table| is_same_surface(&found.plane, &level.plane, &level.middle);
            if surfaces.len() < N_SURFACES_MAX
                && !surfaces.iter().any(is_found)
                && let Some(role) = self.role(&level, is_raised, table_length_m)
            {
                if role != SurfaceRole::Floor {
                    lowest_m = lowest_m.min(level.gap_m);
                }
                self.append(&level.plane, TableChoice::Level, role, buffers, surfaces);
            }
        }
        self.keep_known(buffers, surfaces);
        surfaces[1..].sort_by_key(|surface| surface.role);
    }

    /// Append the levels of earlier frames that are seen in their places, although this image
    /// alone does not show that they are levels.
    fn keep_known(&self, buffers: &mut TableSelectionBuffers, surfaces: &mut Vec<Table>) {
        for known in self.expected.iter().skip(1) {
            let again = find_again(self.samples, known, self.n_min, &mut buffers.region);
            let Some((plane, middle)) = again else {
                continue;
            };
            let is_found = |found: &Table| is_same_surface(&found.plane, &plane, &middle);
            if surfaces.len() < N_SURFACES_MAX && !surfaces.iter().any(is_found) {
                let role = SurfaceRole::Level;
                self.append(&plane, TableChoice::Kept, role, buffers, surfaces);
            }
        }
    }

    /// `true` for a plane that is parallel to the table and not in it.
    fn may_be_level(&self, found: &PlaneCandidate, table: &Plane) -> bool {
        // At the foot of the camera the planes are as far apart as anywhere.
        let gap_m = found.plane.offset_m - table.offset_m;
        found.n_samples >= self.n_min
            && is_parallel(&found.plane, table)
            && gap_m.abs() >= 0.5 * LEVEL_GAP_MIN_M
    }

    /// Level in one of the planes of the image; `None` when it is none.
    fn level(
        &self,
        index: usize,
        table: &Plane,
        buffers: &mut TableSelectionBuffers,
    ) -> Option<Level> {
        let (samples, region) = (self.samples, &mut buffers.region);
        let found = &buffers.found[index].plane;
        find_region(samples, found, RegionFilter::WideOnly, region);
        let (plane, middle) = region_plane_and_middle(samples, region)?;
        let gap_m = table.height_m(&middle);
        let length_m = self.length_of_level(&plane, buffers)?;
        let is_level = is_parallel(&plane, table) && gap_m.abs() >= LEVEL_GAP_MIN_M;
        is_level.then_some(Level {
            plane,
            middle,
            gap_m,
            length_m,
        })
    }

    /// Longest side of the region found last, metres; `None` when it is too small for a level.
    fn length_of_level(&self, plane: &Plane, buffers: &TableSelectionBuffers) -> Option<f64> {
        let [u, v, _] = AffineForm::coordinates_of(&plane.plane_from_source());
        let mut footprint = Footprint::new();
        for sample in buffers.region.samples() {
            let [u, v] = [&u, &v].map(|axis| self.samples.coordinate(axis, sample));
            footprint.add(u, v);
        }
        let [longest_m, second_m] = footprint.bounding_rectangle()?.half_sides_m.into();
        let [longest_m, second_m] = [2.0 * longest_m, 2.0 * second_m];
        let [longest_min_m, second_min_m] = LEVEL_SIDES_MIN_M;
        (longest_m >= longest_min_m && second_m >= second_min_m).then_some(longest_m)
    }

    /// `true` when free space is seen beneath a plane, which is then the top of no object.
    fn is_raised(&self, plane: &Plane, buffers: &mut TableSelectionBuffers) -> bool {
        let TableSelectionBuffers { region, rim, .. } = buffers;
        find_region(self.samples, plane, RegionFilter::WideOnly, region);
        rim.is_free_beneath(self.samples, plane, region, self.config)
    }

    /// Role of a level; `None` when it may be the top of an object, or the surface under the object
    /// whose top is the table. `is_raised` tells whether the level is within reach of the lowest
    /// one so far, with free space seen beneath the upper of the two.
    fn role(&self, level: &Level, is_raised: bool, table_length_m: f64) -> Option<SurfaceRole> {
        let below_m = -level.gap_m;
        let ratio = level.length_m / table_length_m.max(1e-3);
        let is_of_furniture =
            is_raised && (1.0 / LENGTH_RATIO_MAX..=LENGTH_RATIO_MAX).contains(&ratio);
        if !is_of_furniture {
            return (below_m >= FLOOR_GAP_M).then_some(SurfaceRole::Floor);
        }
        let is_known = |known: &Plane| is_same_surface(known, &level.plane, &level.middle);
        let is_certain = self.expected.is_empty() || self.expected[1..].iter().any(is_known);
        Some(if is_certain {
            SurfaceRole::Level
        } else {
            SurfaceRole::NewLevel
        })
    }

    fn append(
        &self,
        plane: &Plane,
        choice: TableChoice,
        role: SurfaceRole,
        buffers: &mut TableSelectionBuffers,
        surfaces: &mut Vec<Table>,
    ) {
        let parts = RegionFilter::WideOnly;
        find_region(self.samples, plane, parts, &mut buffers.region);
        let chosen = ChosenPlane {
            plane: *plane,
            parts,
            choice,
        };
        let level = outlined_table(self.samples, &chosen, *plane, buffers);
        surfaces.extend(level.map(|level| Table { role, ..level }));
    }
}

fn is_parallel(plane: &Plane, table: &Plane) -> bool {
    plane.normal.dot(&table.normal) >= PARALLEL_COS_MIN
}

/// Longest side of the bounding rectangle of what is seen of a surface, metres.
fn length_m(surface: &Table) -> f64 {
    let rectangle = BoundingRectangle::of_outline(surface.polygon.corners());
    rectangle.map_or(0.0, |rectangle| 2.0 * rectangle.half_sides_m.x)
}
