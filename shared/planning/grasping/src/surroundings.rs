//! Surroundings of one object: what the hand and the arm would hit, and what nobody has seen.

use crate::contact_point::ContactPoint;
use crate::grasp_scene::GraspScene;
use crate::hand_boxes::lowest_m;
use crate::observed_space::SpaceState;
use crate::obstacles::{Obstacle, Obstacles};
use geometry::{Capsule, OrientedBox, Plane};
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;

/// Distance that the hand keeps from the surface that carries the object, metres. Chosen: the
/// error of a plane fitted to Kinect depth.
pub(crate) const SURFACE_CLEARANCE_M: f64 = 0.003;
/// Side of the columns by which things on an object are found, metres.
const COLUMN_M: f64 = 0.01;
/// Height over the top of the object in a column from which on something lies on it, metres.
const ON_TOP_M: f64 = 0.015;
/// Number of voxels of a thing from which on it lies on the object: fewer are noise at its edge.
const N_ON_TOP: usize = 4;
/// Distance between the places at which a box is asked for unseen space, metres.
const UNSEEN_STEP_M: f64 = 0.02;

/// Surroundings of an object of a scene.
pub(crate) struct Surroundings<'a> {
    scene: &'a GraspScene<'a>,
    obstacles: &'a Obstacles,
    object: usize,
    carrier: Option<usize>,
}

impl<'a> Surroundings<'a> {
    /// Surroundings of an object with its contact points.
    pub(crate) fn new(
        scene: &'a GraspScene<'a>,
        obstacles: &'a Obstacles,
        object: usize,
        contacts: &[ContactPoint],
    ) -> Self {
        Self {
            scene,
            obstacles,
            object,
            carrier: scene.carrier_of(contacts),
        }
    }

    /// Plane of the surface that carries the object.
    pub(crate) fn carrier_plane(&self) -> Option<&Plane> {
        self.carrier
            .map(|carrier| &self.scene.surfaces[carrier].plane)
    }

    /// The carrying surface is a plane, not the voxels that show it.
    fn is_ignored(&self, obstacle: Obstacle) -> bool {
        obstacle == Obstacle::Object(self.object)
            || self.carrier.map(Obstacle::Surface) == Some(obstacle)
    }

    /// Surface that carries the object, as an obstacle, if a box comes nearer to it than allowed.
    fn carrier_below(&self, body: &OrientedBox) -> Option<Obstacle> {
        let carrier = self.carrier?;
        let height_m = lowest_m(body, &self.scene.surfaces[carrier].plane);
        // Rounding must not reject what was set down at exactly the clearance.
        (height_m < SURFACE_CLEARANCE_M - 1e-6).then_some(Obstacle::Surface(carrier))
    }

    /// First thing that a box would hit.
    pub(crate) fn hit_by_box(&self, body: &OrientedBox) -> Option<Obstacle> {
        self.carrier_below(body).or_else(|| {
            self.obstacles
                .hit_by(body, |obstacle| self.is_ignored(obstacle))
        })
    }

    /// First thing that a link of the arm would hit.
    pub(crate) fn hit_by_link(&self, link: &Capsule) -> Option<Obstacle> {
        let is_low = |plane: &&Plane| {
            plane.height_m(&link.from).min(plane.height_m(&link.to)) < link.radius_m
        };
        if self.carrier_plane().as_ref().is_some_and(is_low) {
            return self.carrier.map(Obstacle::Surface);
        }
        self.obstacles
            .hit_by_link(link, |obstacle| self.is_ignored(obstacle))
    }

    /// Thing that lies on the object: it stands in the way of any lift.
    pub(crate) fn cover(&self, contacts: &[ContactPoint]) -> Option<Obstacle> {
        let column =
            |place: &Point3<f64>| [place.x, place.y].map(|c| (c / COLUMN_M).floor() as i32);
        let mut tops_m = BTreeMap::<[i32; 2], f64>::new();
        for contact in contacts {
            let top_m = tops_m
                .entry(column(&contact.position))
                .or_insert(f64::NEG_INFINITY);
            *top_m = top_m.max(contact.position.z);
        }
        let mut n_above = BTreeMap::<Obstacle, usize>::new();
        for (place, owner) in self.obstacles.voxels() {
            // What stands beside the object may share a column of its edge.
            let [x, y] = column(place);
            let around = [[x, y], [x - 1, y], [x + 1, y], [x, y - 1], [x, y + 1]];
            let is_inside = around.iter().all(|column| tops_m.contains_key(column));
            let top_m = tops_m.get(&[x, y]);
            if is_inside
                && top_m.is_some_and(|top_m| place.z > top_m + ON_TOP_M)
                && !self.is_ignored(*owner)
                && matches!(owner, Obstacle::Object(_))
            {
                *n_above.entry(*owner).or_default() += 1;
            }
        }
        let covering = n_above.into_iter().filter(|(_, n)| *n >= N_ON_TOP);
        covering.max_by_key(|(_, n)| *n).map(|(owner, _)| owner)
    }

    /// Share of boxes that lies in space which nobody has seen, 0 to 1: hidden behind something
    /// other than the object, or outside of the image.
    pub(crate) fn unseen_share(&self, boxes: &[OrientedBox]) -> f64 {
        let (mut n, mut n_unseen) = (0, 0);
        for body in boxes {
            let steps = body
                .half_sides_m
                .map(|half| (half / UNSEEN_STEP_M).ceil() as i32);
            for x in -steps.x..=steps.x {
                for y in -steps.y..=steps.y {
                    for z in -steps.z..=steps.z {
                        let share = |i: i32, n: i32| f64::from(i) / f64::from(n.max(1));
                        let place = Vector3::new(
                            share(x, steps.x) * body.half_sides_m.x,
                            share(y, steps.y) * body.half_sides_m.y,
                            share(z, steps.z) * body.half_sides_m.z,
                        );
                        let state = self
                            .scene
                            .space
                            .state(&(body.frame_from_box * Point3::from(place)));
                        n += 1;
                        n_unseen += i32::from(matches!(
                            state,
                            SpaceState::Hidden(_) | SpaceState::Unmeasured
                        ));
                    }
                }
            }
        }
        f64::from(n_unseen) / f64::from(n.max(1))
    }
}
