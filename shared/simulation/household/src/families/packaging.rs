//! Families of stackable packaging and print: cartons, magazines, cookie tins, open boxes.

use crate::finish::{BRUSHED, PLASTIC, PRINTED};
use crate::palette::{BRASS, METALS, PASTELS, PLASTICS, Rgb, WHITE, contrasting, mix, shaded};
use crate::pattern::{PrintedLabel, azimuth, is_stripe, mottled, noise, radius};
use crate::profile::{lathed_for_print, rounded};
use crate::variation::Variation;
use mesh::{ConvexPart, Solid, rounded_box};
use nalgebra::{Point3, Vector3};
use std::f32::consts::TAU;

/// Number of triangles of a carton or magazine, approximately.
const TRIANGLES: f32 = 6500.0;
/// Number of sides of the collision shape of a cookie tin.
const N_PRISM_SIDES: usize = 16;
/// Colours of printed covers: strong, dark and pale ones.
const COVERS: [Rgb; 12] = [
    [196, 40, 38],
    [28, 74, 150],
    [236, 190, 40],
    [34, 96, 66],
    [226, 118, 36],
    [84, 52, 110],
    [40, 140, 170],
    WHITE,
    [222, 214, 196],
    [46, 48, 56],
    [150, 190, 220],
    [120, 40, 48],
];
/// Colours of grey and brown board.
const BOARDS: [Rgb; 4] = [
    [176, 140, 98],
    [196, 166, 124],
    [150, 150, 146],
    [206, 204, 196],
];
/// Sides of common cartons, longest first, metres. Estimated from pictures.
const CARTON_SIDES_M: [[f32; 3]; 10] = [
    [0.15, 0.14, 0.13],
    [0.26, 0.19, 0.05],
    [0.27, 0.19, 0.065],
    [0.20, 0.13, 0.05],
    [0.16, 0.075, 0.04],
    [0.11, 0.075, 0.065],
    [0.29, 0.21, 0.085],
    [0.09, 0.085, 0.08],
    [0.13, 0.07, 0.025],
    [0.23, 0.08, 0.075],
];

/// Print of a whole cover: a label with a photograph in it.
struct PrintedCover {
    label: PrintedLabel,
    /// Corners of the photograph, left, bottom, right, top, 0 to 1.
    photo: [f32; 4],
    photo_colors: [Rgb; 3],
    seed: u64,
}

impl PrintedCover {
    fn new(v: &mut Variation, palette: &[Rgb]) -> Self {
        let (left, bottom) = (v.between(0.04, 0.4), v.between(0.04, 0.4));
        let has_photo = v.with_probability(0.6);
        let size = if has_photo { 1.0 } else { 0.0 };
        Self {
            label: PrintedLabel::new(v, palette),
            photo: [
                left,
                bottom,
                left + size * v.between(0.3, 0.55),
                bottom + size * v.between(0.2, 0.5),
            ],
            photo_colors: [v.color(&COVERS), v.color(&COVERS), v.color(&PASTELS)],
            seed: v.seed(),
        }
    }

    /// Colour at a position on the cover, `u` to the right and `w` upwards, 0 to 1.
    fn at(&self, u: f32, w: f32) -> Rgb {
        let [left, bottom, right, top] = self.photo;
        if !((left..right).contains(&u) && (bottom..top).contains(&w)) {
            return self.label.at(u, w);
        }
        let p = Point3::new(u, w, 0.0);
        let [a, b, sky] = self.photo_colors;
        let ground = mix(a, b, (noise(&p, 0.09, self.seed) - 0.3) * 2.5);
        mix(ground, sky, (noise(&p, 0.22, !self.seed) - 0.45) * 5.0)
    }

    /// Print on all faces of a box of these sides, centred at the origin; narrow faces have the
    /// ground colour and lines of text.
    fn boxed(&self, p: &Point3<f32>, n: &Vector3<f32>, sides: [f32; 3]) -> Rgb {
        let (across, up) = [(1, 2), (0, 2), (0, 1)][n.iamax()];
        let at = |axis: usize| p[axis] / sides[axis] + 0.5;
        let (u, w) = (at(across), at(up));
        if sides[up] > 2.0 * sides[across] {
            return self.at(w, 1.0 - u);
        }
        if sides[up] > 0.45 * sides[across] {
            return self.at(u, w);
        }
        let ground = self.label.ground;
        if (0.1..0.6).contains(&u) && (0.25..0.75).contains(&w) && is_stripe(u, 7) {
            return mix(ground, contrasting(ground), 0.7);
        }
        if u > 0.8 {
            shaded(self.photo_colors[0], 0.9)
        } else {
            ground
        }
    }
}

/// Grid width with which a box has about [`TRIANGLES`] triangles, metres.
fn print_cell_m([x, y, z]: [f32; 3]) -> f32 {
    (4.0 * (x * y + y * z + z * x) / TRIANGLES).sqrt()
}

pub(crate) fn carton(v: &mut Variation) -> Solid {
    let common = CARTON_SIDES_M[v.count(0, CARTON_SIDES_M.len() - 1)];
    let sides = common.map(|side| side * v.between(0.88, 1.12));
    let cover = PrintedCover::new(v, &COVERS);
    let (plain, board, seed) = (v.color(&COVERS), v.color(&BOARDS), v.seed());
    let look = v.between(0.0, 1.0);
    let tape = v.between(0.1, 0.16) * sides[1];
    let body = rounded_box(sides, 0.001, print_cell_m(sides));
    let body = body.painted(|p, n| match look {
        share if share < 0.66 => cover.boxed(p, n, sides),
        share if share < 0.86 => plain,
        _ if p.y.abs() < tape && n.y.abs() < 0.5 => shaded(board, 1.12),
        _ => mottled(p, board, 0.012, 0.12, seed),
    });
    body.with_surface(PRINTED)
}

pub(crate) fn magazine(v: &mut Variation) -> Solid {
    let sides = v.each_between([(0.17, 0.215), (0.24, 0.3), (0.0035, 0.011)]);
    let (front, back) = (
        PrintedCover::new(v, &COVERS),
        PrintedCover::new(v, &PLASTICS),
    );
    let title = v.color(&COVERS);
    rounded_box(sides, 0.0004, print_cell_m(sides))
        .painted(|p, n| {
            let (u, w) = (p.x / sides[0] + 0.5, p.y / sides[1] + 0.5);
            match n.z {
                z if z > 0.7 && w > 0.9 && is_stripe(u + 0.1, 6) => title,
                z if z > 0.7 => front.at(u, w),
                z if z < -0.7 => back.at(u, w),
                _ => [226, 222, 212],
            }
        })
        .with_surface(PRINTED)
}

/// Regular prism on z = 0 as the collision shape of a flat cylinder: its even base does not rock.
fn prism(radius_m: f32, height_m: f32) -> ConvexPart {
    let corner = |i: usize, z: f32| {
        let (sin, cos) = (i as f32 / N_PRISM_SIDES as f32 * TAU).sin_cos();
        Point3::new(radius_m * cos, radius_m * sin, z)
    };
    let corners = (0..N_PRISM_SIDES).flat_map(|i| [corner(i, 0.0), corner(i, height_m)]);
    ConvexPart {
        points: corners.collect(),
    }
}

pub(crate) fn cookie_tin(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.07, 0.108), v.between(0.045, 0.09));
    let lid = h * v.between(0.6, 0.78);
    let (label, picture) = (PrintedLabel::new(v, &COVERS), PrintedCover::new(v, &COVERS));
    let (metal, is_bare) = (
        v.color(&[METALS[0], METALS[3], BRASS]),
        v.with_probability(0.15),
    );
    let profile = rounded(
        &[
            (0.0, 0.0),
            (r, 0.0),
            (r, lid),
            (r * 1.015, lid),
            (r * 1.015, h),
            (0.0, h),
        ],
        0.0012,
    );
    let color = |p: &Point3<f32>, n: &Vector3<f32>| match p.z {
        _ if is_bare => metal,
        z if n.z > 0.7 && z > lid && radius(p) < 0.86 * r => {
            picture.at(p.x / (2.0 * r) + 0.5, p.y / (2.0 * r) + 0.5)
        }
        z if z > lid => label.ground,
        z => label.at((azimuth(p) * 3.0).fract(), z / lid),
    };
    let mut tin = lathed_for_print(&profile)
        .painted(color)
        .with_surface(BRUSHED);
    tin.convex_parts = vec![prism(r * 1.01, h)];
    tin
}

pub(crate) fn open_box(v: &mut Variation) -> Solid {
    let [x, y, z] = v.each_between([(0.16, 0.28), (0.12, 0.2), (0.05, 0.1)]);
    let is_board = v.with_probability(0.5);
    let wall = if is_board { 0.004 } else { 0.003 };
    let (outside, seed) = (
        v.color(if is_board { &BOARDS } else { &PLASTICS }),
        v.seed(),
    );
    let inside = shaded(outside, 0.94);
    let panel =
        |sides: [f32; 3], at: [f32; 3]| rounded_box(sides, 0.0008, 0.02).moved(at[0], at[1], at[2]);
    // No two panels share a corner, so that each stays a closed part of its own.
    let gap = 0.0005;
    let low = z - gap;
    let (half_x, half_y) = ((x - wall) / 2.0, (y - wall) / 2.0);
    let panels = [
        panel([x - gap, y - gap, wall], [0.0, 0.0, wall / 2.0]),
        panel([wall, y, z], [-half_x, 0.0, z / 2.0]),
        panel([wall, y, z], [half_x, 0.0, z / 2.0]),
        panel([x - 2.0 * gap, wall, low], [0.0, -half_y, z / 2.0]),
        panel([x - 2.0 * gap, wall, low], [0.0, half_y, z / 2.0]),
    ];
    let body: Solid = panels.into_iter().collect();
    let body = body.painted(|p, n| {
        let is_inner = p.x * n.x + p.y * n.y < 0.0;
        mottled(p, if is_inner { inside } else { outside }, 0.01, 0.08, seed)
    });
    body.with_surface(if is_board { PRINTED } else { PLASTIC })
}
