//! Catalogue of object shapes, in the object frame (z up, origin in the middle of the
//! base), and of the room in the world frame; metres.

use super::paint::{Paint, Pattern};
use super::surface::Surface;
use super::{TABLE_HALF_SIDES_M, TABLE_HEIGHT_M};
use nalgebra::Point3;

/// Geometric surface with its paint.
pub(super) type PaintedSurface = (Surface, Paint);

/// Shape and colours of one kind of object.
#[derive(Debug)]
pub(super) struct ObjectKind {
    pub(super) name: &'static str,
    /// Lowest and highest corner of the bounding box.
    pub(super) corners: [[f64; 3]; 2],
    pub(super) parts: &'static [PaintedSurface],
}

impl ObjectKind {
    /// Bounding sphere of the kind's box: centre and radius.
    pub(super) fn bounding_sphere(&self) -> (Point3<f64>, f64) {
        let [low, high] = self.corners.map(Point3::from);
        (nalgebra::center(&low, &high), 0.5 * (high - low).norm())
    }
}

/// Every kind of object, in the order of the arrangements.
pub(super) static KINDS: [ObjectKind; 8] = [
    // A hollow cylinder with a round handle along x.
    ObjectKind {
        name: "mug",
        corners: [[-0.041, -0.041, 0.0], [0.075, 0.041, 0.095]],
        parts: &[
            (Surface::cylinder(0.041, [0.0, 0.095]), BLUE),
            (Surface::handle([0.041, 0.05], [0.028, 0.006]), BLUE),
            (Surface::cylinder(0.037, [0.006, 0.095]), CREAM),
            (Surface::disc(0.037, 0.006), CREAM),
            (Surface::ring([0.037, 0.041], 0.095), CREAM),
        ],
    },
    // Parts of two spheres around one centre, on a foot.
    ObjectKind {
        name: "bowl",
        corners: [[-BOWL_RIM, -BOWL_RIM, 0.0], [BOWL_RIM, BOWL_RIM, 0.071]],
        parts: &[
            (Surface::cylinder(0.035, [0.0, 0.0136]), TEAL),
            (Surface::sphere(0.085, 0.091, [0.0135, 0.071]), TEAL),
            (Surface::sphere(0.081, 0.091, [0.01, 0.071]), MINT),
            (Surface::ring([0.0785, BOWL_RIM], 0.071), MINT),
        ],
    },
    ObjectKind {
        name: "box",
        corners: [[-0.025, -0.075, 0.0], [0.025, 0.075, 0.21]],
        parts: &[(
            Surface::cuboid([-0.025, -0.075, 0.0], [0.025, 0.075, 0.21]),
            CEREAL,
        )],
    },
    ObjectKind {
        name: "ball",
        corners: [[-0.04, -0.04, 0.0], [0.04, 0.04, 0.08]],
        parts: &[(Surface::sphere(0.04, 0.04, [0.0, 0.08]), RED_BANDS)],
    },
    // Body, shoulder, neck and cap.
    ObjectKind {
        name: "bottle",
        corners: [[-0.036, -0.036, 0.0], [0.036, 0.036, 0.25]],
        parts: &[
            (Surface::cylinder(0.036, [0.0, 0.15]), GREEN_BANDS),
            (Surface::frustum([0.036, 0.013], [0.15, 0.195]), GREEN_BANDS),
            (Surface::cylinder(0.013, [0.195, 0.235]), GREEN_BANDS),
            (Surface::cylinder(0.015, [0.235, 0.25]), YELLOW),
            (Surface::disc(0.015, 0.25), YELLOW),
        ],
    },
    // As the bowl, of larger spheres.
    ObjectKind {
        name: "plate",
        corners: [[-PLATE_RIM, -PLATE_RIM, 0.0], [PLATE_RIM, PLATE_RIM, 0.032]],
        parts: &[
            (Surface::cylinder(0.05, [0.0, 0.0136]), VIOLET),
            (Surface::sphere(0.17, 0.176, [0.0135, 0.032]), VIOLET),
            (Surface::sphere(0.166, 0.176, [0.01, 0.032]), LILAC),
            (Surface::ring([0.0826, PLATE_RIM], 0.032), LILAC),
        ],
    },
    // Blunt at its top.
    ObjectKind {
        name: "cone",
        corners: [[-0.05, -0.05, 0.0], [0.05, 0.05, 0.17]],
        parts: &[
            (Surface::frustum([0.05, 0.01], [0.0, 0.17]), ORANGE_BANDS),
            (Surface::disc(0.01, 0.17), ORANGE_BANDS),
        ],
    },
    // A drinks can with a sunk lid.
    ObjectKind {
        name: "can",
        corners: [[-0.033, -0.033, 0.0], [0.033, 0.033, 0.115]],
        parts: &[
            (Surface::cylinder(0.033, [0.0, 0.115]), PINK_BANDS),
            (Surface::cylinder(0.031, [0.111, 0.115]), SILVER),
            (Surface::disc(0.031, 0.111), SILVER),
            (Surface::ring([0.031, 0.033], 0.115), SILVER),
        ],
    },
];

/// Small blocks of one colour each, for crowds.
pub(super) static BLOCKS: [ObjectKind; 4] = [
    ObjectKind {
        name: "block",
        corners: [[-0.014, -0.013, 0.0], [0.014, 0.013, 0.036]],
        parts: &[(
            Surface::cuboid([-0.014, -0.013, 0.0], [0.014, 0.013, 0.036]),
            BLUE,
        )],
    },
    ObjectKind {
        name: "block",
        corners: [[-0.013, -0.014, 0.0], [0.013, 0.014, 0.042]],
        parts: &[(
            Surface::cuboid([-0.013, -0.014, 0.0], [0.013, 0.014, 0.042]),
            YELLOW,
        )],
    },
    ObjectKind {
        name: "block",
        corners: [[-0.015, -0.013, 0.0], [0.015, 0.013, 0.040]],
        parts: &[(
            Surface::cuboid([-0.015, -0.013, 0.0], [0.015, 0.013, 0.040]),
            RED,
        )],
    },
    ObjectKind {
        name: "block",
        corners: [[-0.013, -0.013, 0.0], [0.013, 0.013, 0.034]],
        parts: &[(
            Surface::cuboid([-0.013, -0.013, 0.0], [0.013, 0.013, 0.034]),
            TEAL,
        )],
    },
];

/// Outer radius of the bowl's rim, where the spheres end below their centre.
const BOWL_RIM: f64 = 0.082_614;
const PLATE_RIM: f64 = 0.090_355;

/// Room: the table with its dark rim on four legs, the floor, and the wall behind.
pub(super) static ROOM: [PaintedSurface; 8] = [
    (slab(0.0, [TABLE_HEIGHT_M - 0.004, TABLE_HEIGHT_M]), WOOD),
    (
        slab(0.001, [TABLE_HEIGHT_M - 0.03, TABLE_HEIGHT_M - 0.004]),
        DARK_WOOD,
    ),
    (leg(-1.0, -1.0), DARK_WOOD),
    (leg(-1.0, 1.0), DARK_WOOD),
    (leg(1.0, -1.0), DARK_WOOD),
    (leg(1.0, 1.0), DARK_WOOD),
    (Surface::cuboid([-6.0, -6.0, -0.1], [6.0, 6.0, 0.0]), TILES),
    (
        Surface::cuboid([-6.0, 1.4, 0.0], [6.0, 1.5, 4.0]),
        Paint::plain([200, 205, 195]),
    ),
];

const fn slab(inset: f64, z: [f64; 2]) -> Surface {
    let (x, y) = (TABLE_HALF_SIDES_M[0] - inset, TABLE_HALF_SIDES_M[1] - inset);
    Surface::cuboid([-x, -y, z[0]], [x, y, z[1]])
}

const fn leg(x: f64, y: f64) -> Surface {
    let (x, y) = (
        x * (TABLE_HALF_SIDES_M[0] - 0.05),
        y * (TABLE_HALF_SIDES_M[1] - 0.05),
    );
    let top = TABLE_HEIGHT_M - 0.03;
    Surface::cuboid([x - 0.025, y - 0.025, 0.0], [x + 0.025, y + 0.025, top])
}

const BLUE: Paint = Paint::plain([40, 80, 190]);
const CREAM: Paint = Paint::plain([225, 225, 215]);
const TEAL: Paint = Paint::plain([30, 150, 140]);
const MINT: Paint = Paint::plain([210, 235, 225]);
const YELLOW: Paint = Paint::plain([220, 220, 80]);
const VIOLET: Paint = Paint::plain([150, 130, 185]);
const LILAC: Paint = Paint::plain([225, 220, 235]);
const RED: Paint = Paint::plain([200, 50, 45]);
const SILVER: Paint = Paint::plain([175, 178, 182]);
const DARK_WOOD: Paint = Paint::plain([90, 65, 45]);
const CEREAL: Paint = Paint::new(Pattern::Checks(0.06), [[235, 190, 50], [150, 95, 40]]);
const RED_BANDS: Paint = Paint::new(Pattern::Bands(0.027), [[205, 35, 40], [230, 120, 110]]);
const GREEN_BANDS: Paint = Paint::new(Pattern::Bands(0.075), [[30, 100, 45], [60, 135, 60]]);
const ORANGE_BANDS: Paint = Paint::new(Pattern::Bands(0.05), [[240, 110, 20], [240, 235, 225]]);
const PINK_BANDS: Paint = Paint::new(Pattern::Bands(0.045), [[190, 40, 140], [215, 150, 200]]);
const WOOD: Paint = Paint::new(Pattern::Wood, [[205, 175, 130], [185, 150, 105]]);
const TILES: Paint = Paint::new(Pattern::Checks(0.3), [[120, 125, 130], [105, 108, 112]]);
