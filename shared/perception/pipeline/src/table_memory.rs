//! Memory of the support surface: the table of a frame is that of the frames before while it is
//! seen, and another one only when most frames would choose it.

use crate::frame_pose::FramePose;
use detection::{Table, is_same_surface};
use geometry::Plane;

/// Greatest number of votes of a surface: after one second at 30 Hz its past counts no more. Chosen.
const N_VOTES_MAX: u32 = 30;

/// Greatest number of surfaces that compete. Chosen.
const N_SURFACES_MAX: usize = 4;

/// Surface that images have chosen as the table.
#[derive(Debug, Clone, Copy)]
struct KnownSurface {
    plane_in_world: Plane,
    /// Number of images that chose it, less those that chose another one.
    n_votes: u32,
}

/// Surfaces that compete for being the table; the first one is.
#[derive(Debug, Clone, Default)]
pub(crate) struct TableMemory(Vec<KnownSurface>);

impl TableMemory {
    /// Plane of the table predicted to a frame, camera frame; `None` before the first one.
    pub(crate) fn expected(&self, frame: &FramePose) -> Option<Plane> {
        let table = self.0.first()?;
        let camera_from_world = frame.world_from_camera.inverse();
        Some(table.plane_in_world.transformed(&camera_from_world))
    }

    /// Takes account of the table of a frame. A frame without one says nothing.
    pub(crate) fn update(&mut self, table: Option<&Table>, frame: &FramePose) {
        let Some(table) = table else { return };
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
                });
            }
        }
        self.vote(in_world(&table.plane_by_image), |known, chosen| {
            is_same_surface(known, chosen, &middle)
        });
    }

    /// Adds the vote of an image for a surface, and takes one of each other.
    fn vote(&mut self, chosen: Plane, is_same: impl Fn(&Plane, &Plane) -> bool) {
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
            }),
            Some(_) | None => {}
        }
        let mut is_first = true;
        self.0
            .retain(|known| std::mem::take(&mut is_first) || known.n_votes > 0);
    }

    /// Forgets all surfaces.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
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

    /// Memory after votes of images for planes at these heights, the first of which is the table.
    fn after(heights_m: impl IntoIterator<Item = f64>) -> TableMemory {
        let mut memory = TableMemory::default();
        for height_m in heights_m {
            if memory.0.is_empty() {
                memory.0.push(KnownSurface {
                    plane_in_world: level(height_m),
                    n_votes: 0,
                });
            }
            memory.vote(level(height_m), |one, other| {
                (one.offset_m - other.offset_m).abs() < 0.01
            });
        }
        memory
    }

    fn height_m(memory: &TableMemory) -> f64 {
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
    fn surfaces_that_compete_are_few() {
        let memory = after((0..100).map(|i| 0.5 + 0.1 * f64::from(i % 7)));
        assert!(memory.0.len() <= N_SURFACES_MAX);
    }
}
