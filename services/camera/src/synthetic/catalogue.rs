//! The things that can stand on the table, in their own frame: z up, origin in
//! the middle of the base, metres.

use super::paint::{Paint, Pattern};
use super::surface::Surface;
use nalgebra::Point3;

/// A painted surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub(super) surface: Surface,
    pub(super) paint: Paint,
}

/// One kind of object.
#[derive(Debug)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    /// Lowest and highest corner of the smallest box around it.
    pub(super) corners: [[f64; 3]; 2],
    build: fn() -> Vec<(Surface, Paint)>,
}

impl Kind {
    const fn new(
        name: &'static str,
        corners: [[f64; 3]; 2],
        build: fn() -> Vec<(Surface, Paint)>,
    ) -> Self {
        Self {
            name,
            corners,
            build,
        }
    }

    pub(super) fn parts(&self) -> Vec<Part> {
        (self.build)()
            .into_iter()
            .map(|(surface, paint)| Part { surface, paint })
            .collect()
    }
}

/// Every kind, in the order in which the arrangements go through them.
pub(super) static KINDS: [Kind; 8] = [
    Kind::new("mug", [[-0.041, -0.041, 0.0], [0.075, 0.041, 0.095]], mug),
    Kind::new(
        "bowl",
        [[-BOWL_RIM, -BOWL_RIM, 0.0], [BOWL_RIM, BOWL_RIM, 0.065]],
        bowl,
    ),
    Kind::new(
        "box",
        [[-0.085, -0.0275, 0.0], [0.085, 0.0275, 0.24]],
        cereal_box,
    ),
    Kind::new("ball", [[-0.055, -0.055, 0.0], [0.055, 0.055, 0.11]], ball),
    Kind::new(
        "bottle",
        [[-0.036, -0.036, 0.0], [0.036, 0.036, 0.25]],
        bottle,
    ),
    Kind::new("plate", [[-0.09, -0.09, 0.0], [0.09, 0.09, 0.028]], plate),
    Kind::new("cone", [[-0.055, -0.055, 0.0], [0.055, 0.055, 0.17]], cone),
    Kind::new("can", [[-0.033, -0.033, 0.0], [0.033, 0.033, 0.115]], can),
];

/// A hollow cylinder with a round handle along x.
fn mug() -> Vec<(Surface, Paint)> {
    let (outside, inside) = (Paint::plain([40, 80, 190]), Paint::plain([225, 225, 215]));
    let handle = Surface::Handle {
        centre_x: 0.041,
        centre_z: 0.05,
        radii: [0.028, 0.006],
    };
    vec![
        (Surface::cylinder(0.041, [0.0, 0.095]), outside),
        (Surface::cylinder(0.037, [0.006, 0.095]), inside),
        (Surface::disc(0.037, 0.006), inside),
        (
            Surface::Ring {
                z: 0.095,
                radii: [0.037, 0.041],
            },
            inside,
        ),
        (handle, outside),
    ]
}

/// Outer radius of the bowl's rim: its sphere's, 20 mm below the centre.
const BOWL_RIM: f64 = 0.082_614;

/// Two parts of spheres around one centre, on a foot.
fn bowl() -> Vec<(Surface, Paint)> {
    let (outside, inside) = (Paint::plain([30, 150, 140]), Paint::plain([210, 235, 225]));
    vec![
        (Surface::sphere(0.085, 0.085, [0.0075, 0.065]), outside),
        (Surface::sphere(0.081, 0.085, [0.004, 0.065]), inside),
        (
            Surface::Ring {
                z: 0.065,
                radii: [0.0785, BOWL_RIM],
            },
            inside,
        ),
        (Surface::cylinder(0.035, [0.0, 0.0076]), outside),
    ]
}

fn cereal_box() -> Vec<(Surface, Paint)> {
    let paint = Paint {
        pattern: Pattern::Checks(0.06),
        colors: [[235, 190, 50], [150, 95, 40]],
    };
    vec![(
        Surface::cuboid([-0.085, -0.0275, 0.0], [0.085, 0.0275, 0.24]),
        paint,
    )]
}

fn ball() -> Vec<(Surface, Paint)> {
    let paint = Paint {
        pattern: Pattern::Bands(0.037),
        colors: [[205, 35, 40], [230, 120, 110]],
    };
    vec![(Surface::sphere(0.055, 0.055, [0.0, 0.11]), paint)]
}

/// Body, shoulder, neck and cap.
fn bottle() -> Vec<(Surface, Paint)> {
    let glass = Paint {
        pattern: Pattern::Bands(0.075),
        colors: [[30, 100, 45], [60, 135, 60]],
    };
    let cap = Paint::plain([220, 220, 80]);
    vec![
        (Surface::cylinder(0.036, [0.0, 0.15]), glass),
        (Surface::frustum([0.036, 0.013], [0.15, 0.195]), glass),
        (Surface::cylinder(0.013, [0.195, 0.235]), glass),
        (Surface::cylinder(0.015, [0.235, 0.25]), cap),
        (Surface::disc(0.015, 0.25), cap),
    ]
}

/// A deep plate: a flat floor in a wide, low rim.
fn plate() -> Vec<(Surface, Paint)> {
    let (rim, floor) = (Paint::plain([150, 130, 185]), Paint::plain([225, 220, 235]));
    vec![
        (Surface::frustum([0.055, 0.09], [0.0, 0.028]), rim),
        (Surface::frustum([0.052, 0.086], [0.013, 0.028]), floor),
        (Surface::disc(0.052, 0.013), floor),
        (
            Surface::Ring {
                z: 0.028,
                radii: [0.086, 0.09],
            },
            rim,
        ),
    ]
}

/// A marking cone on its square foot.
fn cone() -> Vec<(Surface, Paint)> {
    let cone = Paint {
        pattern: Pattern::Bands(0.05),
        colors: [[240, 110, 20], [240, 235, 225]],
    };
    vec![
        (
            Surface::cuboid([-0.055, -0.055, 0.0], [0.055, 0.055, 0.01]),
            Paint::plain([50, 50, 55]),
        ),
        (Surface::frustum([0.045, 0.01], [0.01, 0.17]), cone),
        (Surface::disc(0.01, 0.17), cone),
    ]
}

/// A drinks can with a sunk lid.
fn can() -> Vec<(Surface, Paint)> {
    let label = Paint {
        pattern: Pattern::Bands(0.045),
        colors: [[190, 40, 140], [215, 150, 200]],
    };
    let lid = Paint::plain([175, 178, 182]);
    vec![
        (Surface::cylinder(0.033, [0.0, 0.115]), label),
        (Surface::cylinder(0.031, [0.111, 0.115]), lid),
        (Surface::disc(0.031, 0.111), lid),
        (
            Surface::Ring {
                z: 0.115,
                radii: [0.031, 0.033],
            },
            lid,
        ),
    ]
}

/// The room in the world frame: the table with a dark rim on four legs, the
/// floor, the wall behind.
pub(super) fn room(table_height_m: f64, [half_x, half_y]: [f64; 2]) -> Vec<Part> {
    let wood = Paint {
        pattern: Pattern::Wood,
        colors: [[205, 175, 130], [185, 150, 105]],
    };
    let rim = Paint::plain([90, 65, 45]);
    let slab = |inset: f64, z: [f64; 2]| {
        let (x, y) = (half_x - inset, half_y - inset);
        Surface::cuboid([-x, -y, z[0]], [x, y, z[1]])
    };
    let leg = |x: f64, y: f64| {
        let (x, y) = (x * (half_x - 0.05), y * (half_y - 0.05));
        Surface::cuboid(
            [x - 0.025, y - 0.025, 0.0],
            [x + 0.025, y + 0.025, table_height_m],
        )
    };
    let tiles = Paint {
        pattern: Pattern::Checks(0.3),
        colors: [[120, 125, 130], [105, 108, 112]],
    };
    let floor = Surface::cuboid([-6.0, -6.0, -0.1], [6.0, 6.0, 0.0]);
    let wall = Surface::cuboid([-6.0, 1.4, 0.0], [6.0, 1.5, 4.0]);
    let mut parts = vec![
        (slab(0.0, [table_height_m - 0.004, table_height_m]), wood),
        (
            slab(0.001, [table_height_m - 0.03, table_height_m - 0.004]),
            rim,
        ),
        (floor, tiles),
        (wall, Paint::plain([200, 205, 195])),
    ];
    for (x, y) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        parts.push((leg(x, y), rim));
    }
    parts
        .into_iter()
        .map(|(surface, paint)| Part { surface, paint })
        .collect()
}

/// The smallest sphere around a kind's box: centre and radius.
pub(super) fn bounding_sphere(kind: &Kind) -> (Point3<f64>, f64) {
    let [low, high] = kind.corners.map(Point3::from);
    (nalgebra::center(&low, &high), 0.5 * (high - low).norm())
}
