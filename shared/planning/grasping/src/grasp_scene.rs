//! Grasp scene: depth image, the objects of its pixels, support surfaces and people.

use crate::contact_point::ContactPoint;
use crate::hand_boxes::lowest_m;
use crate::observed_space::ObservedSpace;
use geometry::{Capsule, ConvexPolygon, OrientedBox, Plane};
use nalgebra::{Point2, Point3, Vector3};

/// Distance from a support surface within which a measured place belongs to it, metres. Chosen:
/// the noise of a Kinect at 1.2 m.
const ON_SURFACE_M: f64 = 0.008;
/// Owner of a pixel that shows no object.
const NO_OBJECT: u16 = u16::MAX;
/// Distance by which a support surface reaches beyond what is seen of it, metres. Chosen.
const BEYOND_OUTLINE_M: f64 = 0.05;
/// Thickness of a board, metres. Chosen: nobody sees it from above.
const BOARD_M: f64 = 0.03;
/// Least vertical part of a surface's normal by which heights are divided.
const LEAST_SLOPE: f64 = 0.1;

/// Support surface: a horizontal or slightly inclined plane with an outline.
#[derive(Debug, Clone)]
pub struct SupportPlane {
    /// Plane with an upward normal, frame of planning.
    pub plane: Plane,
    /// Outline of what is seen, x and y of the frame of planning, metres.
    pub outline: ConvexPolygon,
    /// Name for people, such as `the table`.
    pub name: String,
    /// True if nothing reaches the space below it: the table and the floor; false for a board.
    pub is_solid_below: bool,
}

/// Object of a grasp scene.
#[derive(Debug, Clone, Default)]
pub struct GraspObject {
    /// Track-id.
    pub track: u64,
    /// Measured points, frame of the camera, metres.
    pub points_in_camera: Vec<[f32; 3]>,
    /// Surface of its stored model at its estimated pose; empty without one.
    pub model: Vec<ContactPoint>,
}

/// Everything that is known about the surroundings of a grasp, frame of planning: z against
/// gravity, metres.
#[derive(Debug, Clone)]
pub struct GraspScene<'a> {
    /// Depth image.
    pub space: ObservedSpace<'a>,
    /// Objects in the order of their track-ids.
    pub objects: Vec<GraspObject>,
    /// Support surfaces.
    pub surfaces: Vec<SupportPlane>,
    /// Bodies of people.
    pub people: Vec<Capsule>,
    /// Links of the robot's arm, which is no obstacle to itself where the camera sees it.
    pub robot: Vec<Capsule>,
    /// Index of the object that each pixel shows, or [`NO_OBJECT`].
    owners: Vec<u16>,
    /// Pixels of each object, ascending.
    pixels: Vec<Vec<usize>>,
}

impl SupportPlane {
    /// Height of the surface at a place seen from above, metres.
    pub fn height_at(&self, place: &Point2<f64>) -> f64 {
        let slope = self.plane.normal.z.max(LEAST_SLOPE);
        -self.plane.height_m(&Point3::new(place.x, place.y, 0.0)) / slope
    }

    /// True if a box meets the surface or what is below it, within its outline and a margin.
    pub fn is_hit_by_box(&self, body: &OrientedBox) -> bool {
        let middle_m = self.plane.height_m(&body.centre());
        let low_m = lowest_m(body, &self.plane);
        self.is_below(&body.centre()) && self.is_between(low_m, 2.0 * middle_m - low_m)
    }

    /// True if a capsule, such as a link of the arm, meets the surface or what is below it.
    pub fn is_hit_by_link(&self, link: &Capsule) -> bool {
        let heights_m = [link.from, link.to].map(|end| self.plane.height_m(&end));
        let low_m = heights_m[0].min(heights_m[1]) - link.radius_m;
        let high_m = heights_m[0].max(heights_m[1]) + link.radius_m;
        let middle = nalgebra::center(&link.from, &link.to);
        let mut places = [link.from, middle, link.to].into_iter();
        places.any(|place| self.is_below(&place)) && self.is_between(low_m, high_m)
    }

    /// True if a range of heights over the surface meets it.
    fn is_between(&self, low_m: f64, high_m: f64) -> bool {
        low_m < 0.0 && (self.is_solid_below || high_m > -BOARD_M)
    }

    /// True if a place is on the surface or in the air above it, within its outline and a margin.
    pub(crate) fn is_below(&self, place: &Point3<f64>) -> bool {
        self.outline
            .signed_distance_m(&Point2::new(place.x, place.y))
            > -BEYOND_OUTLINE_M
    }
}

impl<'a> GraspScene<'a> {
    /// Scene of an image: assigns pixels to the objects; of more than 65,534 the rest has none.
    pub fn new(
        space: ObservedSpace<'a>,
        objects: Vec<GraspObject>,
        surfaces: Vec<SupportPlane>,
        people: Vec<Capsule>,
        robot: Vec<Capsule>,
    ) -> Self {
        let mut scene = Self {
            owners: vec![NO_OBJECT; space.n_pixels()],
            pixels: Vec::with_capacity(objects.len()),
            space,
            objects,
            surfaces,
            people,
            robot,
        };
        scene.assign_objects();
        scene
    }

    fn assign_objects(&mut self) {
        for (index, object) in (0..NO_OBJECT).zip(&self.objects) {
            let points = object.points_in_camera.iter();
            let mut pixels: Vec<usize> = points
                .filter_map(|point| self.space.pixel_of(&Point3::from(*point).cast::<f64>()))
                .collect();
            pixels.sort_unstable();
            pixels.dedup();
            for &pixel in &pixels {
                self.owners[pixel] = index;
            }
            self.pixels.push(pixels);
        }
    }

    /// Pixels of an object, ascending.
    pub(crate) fn pixels(&self, object: usize) -> &[usize] {
        &self.pixels[object]
    }

    /// Index of the object that a pixel shows.
    pub(crate) fn owner(&self, pixel: usize) -> Option<usize> {
        let owner = self.owners[pixel];
        (owner != NO_OBJECT).then_some(owner.into())
    }

    /// Index of the support surface that a measured place is on.
    pub(crate) fn surface_at(&self, place: &Point3<f64>) -> Option<usize> {
        self.surfaces.iter().position(|surface| {
            surface.plane.height_m(place).abs() < ON_SURFACE_M && surface.is_below(place)
        })
    }

    /// Index of the surface that carries an object: the highest one below most of its points.
    pub fn carrier_of(&self, contacts: &[ContactPoint]) -> Option<usize> {
        let places = contacts.iter().map(|contact| contact.position.coords);
        let middle = Point3::from(places.sum::<Vector3<f64>>() / contacts.len().max(1) as f64);
        let carries = |(_, surface): &(usize, &SupportPlane)| {
            surface.plane.height_m(&middle) > 0.0 && surface.is_below(&middle)
        };
        let height_m = |surface: &SupportPlane| surface.plane.height_m(&middle);
        self.surfaces
            .iter()
            .enumerate()
            .filter(carries)
            .min_by(|a, b| height_m(a.1).total_cmp(&height_m(b.1)))
            .map(|(index, _)| index)
    }
}
