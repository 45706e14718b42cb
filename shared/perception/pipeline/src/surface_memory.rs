//! Memory of the support surfaces: the table of a frame is that of the frames before while it is
//! seen, and another one only when most frames would choose it. A further level carries objects
//! while more frames show it than not.

use crate::frame_pose::FramePose;
use detection::{SurfaceRole, Table, TableChoice, is_same_surface};
use geometry::Plane;
use nalgebra::Point3;

/// Greatest number of votes of a surface: after one second at 30 Hz its past counts no more. Chosen.
const N_VOTES_MAX: u32 = 30;

/// Greatest number of surfaces that compete. Chosen.
const N_SURFACES_MAX: usize = 4;

/// Number of votes from which a level carries objects: a quarter of a second at 30 Hz. Chosen.
const LEVEL_VOTES_MIN: u32 = 8;

/// Time after which a level that is not seen is forgotten, nanoseconds. Chosen.
const LEVEL_KEPT_NS: u64 = 60_000_000_000;

/// Surface that images have chosen as the table, or shown as a level.
#[derive(Debug, Clone, Copy)]
struct KnownSurface {
    plane_in_world: Plane,
    /// Number of images that chose it, less those that did not.
    n_votes: u32,
    /// Capture stamp of the last image that showed it.
    last_seen_ns: u64,
}

/// Surfaces of earlier frames.
#[derive(Debug, Clone, Default)]
pub(crate) struct SurfaceMemory {
    table: TableVotes,
    levels: Levels,
}

impl SurfaceMemory {
    /// Writes the planes of the surfaces predicted to a frame, camera frame: the table first, none
    /// before the first one.
    pub(crate) fn predict(&self, frame: &FramePose, expected: &mut Vec<Plane>) {
        let camera_from_world = frame.world_from_camera.inverse();
        let table = self.table.0.first();
        let levels = self
            .levels
            .0
            .iter()
            .filter(|level| level.n_votes >= LEVEL_VOTES_MIN);
        let known = table.into_iter().chain(levels);
        expected.clear();
        expected.extend(known.map(|one| one.plane_in_world.transformed(&camera_from_world)));
    }

    /// Takes account of the surfaces of a frame, the table first. A frame without one says nothing.
    pub(crate) fn update(&mut self, surfaces: &[Table], frame: &FramePose) {
        if let Some(table) = surfaces.first() {
            self.table.update(table, frame);
            self.levels.update(surfaces, frame);
        }
    }

    /// Forgets all surfaces.
    pub(crate) fn clear(&mut self) {
        self.table.0.clear();
        self.levels.0.clear();
    }
}

/// Further levels of the furniture.
#[derive(Debug, Clone, Default)]
struct Levels(Vec<KnownSurface>);

impl Levels {
    fn update(&mut self, surfaces: &[Table], frame: &FramePose) {
        let pose = &frame.world_from_camera;
        for surface in surfaces {
            let plane = surface.plane.transformed(pose);
            let middle = pose * surface.middle_in_camera();
            match surface.role {
                SurfaceRole::Table => self
                    .0
                    .retain(|known| !is_same_surface(&known.plane_in_world, &plane, &middle)),
                SurfaceRole::Level | SurfaceRole::NewLevel => {
                    let is_shown = surface.choice != TableChoice::Kept;
                    self.vote((plane, middle), is_shown, frame.capture_ns);
                }
                SurfaceRole::Floor => {}
            }
        }
        self.0.retain(|known| {
            let unseen_ns = frame.capture_ns.saturating_sub(known.last_seen_ns);
            known.n_votes > 0 && unseen_ns <= LEVEL_KEPT_NS
        });
    }

    /// Adds the vote of an image that shows a level, or takes one when it is only kept.
    fn vote(&mut self, (plane, middle): (Plane, Point3<f64>), is_shown: bool, now_ns: u64) {
        let is_it =
            |known: &&mut KnownSurface| is_same_surface(&known.plane_in_world, &plane, &middle);
        if let Some(known) = self.0.iter_mut().find(is_it) {
            known.plane_in_world = plane;
            known.last_seen_ns = now_ns;
            known.n_votes = if is_shown {
                (known.n_votes + 1).min(N_VOTES_MAX)
            } else {
                known.n_votes.saturating_sub(1)
            };
        } else if self.0.len() < N_SURFACES_MAX {
            self.0.push(KnownSurface {
                plane_in_world: plane,
                n_votes: 1,
                last_seen_ns: now_ns,
            });
        }
    }
}

/// Surfaces that compete for being the table; the first one is.
#[derive(Debug, Clone, Default)]
struct TableVotes(Vec<KnownSurface>);

impl TableVotes {
    fn update(&mut self, table: &Table, frame: &FramePose) {
        let now_ns = frame.capture_ns;
        let in_world = |plane: &Plane| plane.transformed(&frame.world_from_camera);
        let middle = frame.world_from_camera * table.middle_in_camera();
        let used = in_world(&table.plane);
        match self.0.first_mut() {
            Some(first) if is_same_surface(&first.plane_in_world, &used, &middle) => {
                first.plane_in_world = used;
            }
            // The table is not in its place any more, or out of view.
            _ => {
                self.0.clear();
                self.0.push(KnownSurface {
                    plane_in_world: used,
                    n_votes: 0,
                    last_seen_ns: now_ns,
                });
            }
        }
        self.vote(in_world(&table.plane_by_image), now_ns, |known, chosen| {
            is_same_surface(known, chosen, &middle)
        });
    }

    /// Adds the vote of an image for a surface, and takes one of each other.
    fn vote(&mut self, chosen: Plane, now_ns: u64, is_same: impl Fn(&Plane, &Plane) -> bool) {
        let mut of_chosen = None;
        for (index, known) in self.0.iter_mut().enumerate() {
            if of_chosen.is_none() && is_same(&known.plane_in_world, &chosen) {
                known.n_votes = (known.n_votes + 1).min(N_VOTES_MAX);
                of_chosen = Some(index);
            } else {
                known.n_votes = known.n_votes.saturating_sub(1);
            }
        }
        match of_chosen {
            Some(index) if self.0[index].n_votes > self.0[0].n_votes => self.0.swap(0, index),
            None if self.0.len() < N_SURFACES_MAX => self.0.push(KnownSurface {
                plane_in_world: chosen,
                n_votes: 1,
                last_seen_ns: now_ns,
            }),
            Some(_) | None => {}
        }
        let mut is_first = true;
        self.0
            .retain(|known| std::mem::take(&mut is_first) || known.n_votes > 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Unit, Vector3};

    /// Level plane at a height over the camera, which looks up.
    fn level(height_m: f64) -> Plane {
        let up = Unit::new_normalize(Vector3::z());
        Plane::through(&Point3::new(0.0, 0.0, height_m), up)
    }

    /// Votes of images for planes at these heights, the first of which is the table.
    fn after(heights_m: impl IntoIterator<Item = f64>) -> TableVotes {
        let mut memory = TableVotes::default();
        for height_m in heights_m {
            if memory.0.is_empty() {
                memory.0.push(KnownSurface {
                    plane_in_world: level(height_m),
                    n_votes: 0,
                    last_seen_ns: 0,
                });
            }
            memory.vote(level(height_m), 0, |one, other| {
                (one.offset_m - other.offset_m).abs() < 0.01
            });
        }
        memory
    }

    fn height_m(memory: &TableVotes) -> f64 {
        -memory.0[0].plane_in_world.offset_m
    }

    #[test]
    fn table_is_the_one_that_most_images_choose() {
        let mostly = |rare_m: f64, often_m: f64| {
            move |i: usize| if i.is_multiple_of(3) { rare_m } else { often_m }
        };
        // The first image chooses the rare one.
        assert_eq!(height_m(&after((0..90).map(mostly(0.7, 0.5)))), 0.5);
        assert_eq!(height_m(&after((1..90).map(mostly(0.7, 0.5)))), 0.5);
    }

    #[test]
    fn table_stays_against_fewer_images_than_have_chosen_it() {
        let votes = |n_first: usize, n_then: usize| {
            let first = std::iter::repeat_n(0.7, n_first);
            after(first.chain(std::iter::repeat_n(0.5, n_then)))
        };
        assert_eq!(height_m(&votes(20, 9)), 0.7);
        assert_eq!(height_m(&votes(20, 20)), 0.5);
        // A long past counts no more than a second.
        assert_eq!(height_m(&votes(1000, N_VOTES_MAX as usize)), 0.5);
    }

    #[test]
    fn level_carries_objects_while_more_images_show_it_than_not() {
        let seen = (level(0.5), Point3::new(0.0, 0.0, 0.5));
        let is_used = |levels: &Levels| levels.0.iter().any(|one| one.n_votes >= LEVEL_VOTES_MIN);
        let mut levels = Levels::default();
        levels.vote(seen, true, 0);
        assert!(!is_used(&levels), "one image may be wrong");
        for _ in 0..2 * LEVEL_VOTES_MIN {
            levels.vote(seen, true, 0);
        }
        for _ in 0..LEVEL_VOTES_MIN {
            levels.vote(seen, false, 0);
        }
        assert!(
            is_used(&levels),
            "it is kept through images that do not show it"
        );
        for _ in 0..LEVEL_VOTES_MIN {
            levels.vote(seen, false, 0);
        }
        assert!(!is_used(&levels));
    }

    #[test]
    fn surfaces_that_compete_are_few() {
        let memory = after((0..100).map(|i| 0.5 + 0.1 * f64::from(i % 7)));
        assert!(memory.0.len() <= N_SURFACES_MAX);
    }
}
