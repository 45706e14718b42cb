//! Families of packets: cartons, boxes, books, tubes.

use crate::finish::{PLASTIC, PRINTED};
use crate::palette::{PASTELS, PLASTICS, Rgb, WHITE, contrasting, mix, shaded};
use crate::pattern::{PrintedLabel, is_stripe, mottled, speckled};
use crate::profile::{cylinder, polyline};
use crate::sweep::rod;
use crate::variation::Variation;
use mesh::{Solid, extrude, rounded_box};
use nalgebra::{Point3, Vector3};

/// Printed box that stands on z = 0.
fn printed_box(sides: [f32; 3], edge: f32, cell: f32, print: &PrintedLabel) -> Solid {
    rounded_box(sides, edge, cell)
        .painted(|p, n| print.boxed(p, n, sides))
        .moved(0.0, 0.0, sides[2] / 2.0)
        .with_surface(PRINTED)
}

pub(crate) fn cereal_box(v: &mut Variation) -> Solid {
    let sides = v.each_between([(0.17, 0.21), (0.05, 0.07), (0.25, 0.31)]);
    let print = PrintedLabel::new(v, &PLASTICS);
    printed_box(sides, 0.001, 0.01, &print)
}

pub(crate) fn tissue_box(v: &mut Variation) -> Solid {
    let is_cube = v.with_probability(0.35);
    let sides = if is_cube {
        let side = v.between(0.108, 0.12);
        [side, side * 1.02, side * 1.1]
    } else {
        v.each_between([(0.21, 0.24), (0.11, 0.125), (0.055, 0.085)])
    };
    let (ground, spot, seed) = (v.color(&PASTELS), v.color(&PLASTICS), v.seed());
    let half = sides[0].min(0.14) * 0.36;
    let body = rounded_box(sides, 0.0015, 0.008)
        .painted(|p, n| match n.z {
            z if z > 0.8 && (p.x / half).hypot(p.y / 0.022) < 1.0 => shaded(ground, 0.45),
            _ => speckled(p, (ground, mix(ground, spot, 0.6)), 0.022, 0.33, seed),
        })
        .moved(0.0, 0.0, sides[2] / 2.0);
    // The next tissue: a folded sheet that stands up.
    let rise = v.between(0.035, 0.05);
    let turn = v.between(4.0, 7.0);
    let outline: Vec<_> = crate::profile::ellipse(half * 0.8, 0.007, 36);
    let tissue = extrude(&outline, rise, 0.001)
        .warped(|p| {
            let up = p.z / rise;
            let fold = 0.012 * (p.x / half * turn).sin() * up;
            Point3::new(
                p.x * (0.75 + 0.5 * up),
                p.y + fold,
                p.z - up * p.x.abs() * 0.5,
            )
        })
        .with_convex_hull()
        .colored([246, 246, 244])
        .moved(0.0, 0.0, sides[2] - 0.002);
    body.joined(tissue).with_surface(PRINTED)
}

pub(crate) fn matchbox(v: &mut Variation) -> Solid {
    let [x, y, z] = v.each_between([(0.05, 0.058), (0.034, 0.038), (0.012, 0.017)]);
    let print = PrintedLabel::new(v, &PLASTICS);
    let sleeve = rounded_box([x, y, z], 0.0006, 0.003).painted(|p, n| match n.z {
        up if up.abs() > 0.7 => print.at(p.y / y + 0.5, p.x / x + 0.5),
        _ if n.y.abs() > 0.7 => [86, 52, 44],
        _ => WHITE,
    });
    let out = v.between(0.006, 0.02);
    let drawer = rounded_box([x, y - 0.003, z - 0.003], 0.0006, 0.004)
        .moved(out, 0.0, 0.0)
        .colored([214, 196, 160]);
    // Heads in a row in the open end of the drawer.
    let head = |i: usize| {
        let at = (i as f32 - 3.0) * (y - 0.01) / 6.0;
        rounded_box([out - 0.002, 0.0022, 0.0022], 0.0008, 0.01).moved(
            x / 2.0 + out / 2.0,
            at,
            z / 2.0 - 0.001,
        )
    };
    let heads: Solid = (0..7).map(head).collect();
    let color = v.color(&[[170, 40, 36], [110, 60, 40], [40, 40, 44]]);
    sleeve
        .joined(drawer)
        .joined(heads.colored(color).decorative())
        .with_surface(PRINTED)
}

pub(crate) fn milk_carton(v: &mut Variation) -> Solid {
    let (w, h) = (v.between(0.066, 0.076), v.between(0.155, 0.2));
    let roof = w * v.between(0.42, 0.55);
    let print = PrintedLabel::new(
        v,
        &[WHITE, PLASTICS[1], PLASTICS[3], PLASTICS[0], PASTELS[1]],
    );
    let sides = [w, w, h];
    let body = rounded_box(sides, 0.0008, 0.007)
        .painted(|p, n| print.boxed(p, n, sides))
        .moved(0.0, 0.0, h / 2.0);
    let gable = polyline(&[
        (-w / 2.0, 0.0),
        (w / 2.0, 0.0),
        (0.002, roof),
        (0.002, roof + 0.016),
        (-0.002, roof + 0.016),
        (-0.002, roof),
    ]);
    let quarter = std::f32::consts::FRAC_PI_2;
    let gable = extrude(&gable, w, 0.0)
        .rotated(Vector3::x(), quarter)
        .moved(0.0, w / 2.0, h - 0.001);
    let edge = h + roof;
    let gable = gable.painted(|p, _| {
        if p.z > edge {
            WHITE
        } else {
            print.at(0.01, 0.8)
        }
    });
    let has_cap = v.with_probability(0.6);
    let cap = if has_cap {
        cylinder(0.013, 0.014, 0.002)
    } else {
        Solid::default()
    };
    let tilt = roof.atan2(w / 2.0);
    let color = v.color(&PLASTICS);
    let cap =
        cap.colored(color)
            .rotated(Vector3::y(), tilt)
            .moved(w / 4.0, 0.0, h + roof / 2.0 - 0.003);
    body.joined(gable).joined(cap).with_surface(PRINTED)
}

pub(crate) fn juice_box(v: &mut Variation) -> Solid {
    let sides = v.each_between([(0.047, 0.055), (0.036, 0.042), (0.1, 0.125)]);
    let print = PrintedLabel::new(v, &PLASTICS);
    let body = printed_box(sides, 0.001, 0.005, &print);
    let (h, x) = (sides[2], sides[0] * 0.22);
    let lean = v.between(0.012, 0.024);
    let straw = rod(
        &[
            [x, 0.0, h - 0.004],
            [x, 0.0, h + 0.028],
            [x - lean, 0.0, h + 0.05],
        ],
        0.003,
    );
    let color = v.color(&[WHITE, PLASTICS[0], PLASTICS[2]]);
    let straw = straw.painted(|p, _| {
        if is_stripe((p.z - h) / 0.03 + 1.0, 2) {
            WHITE
        } else {
            color
        }
    });
    body.joined(straw)
}

pub(crate) fn book(v: &mut Variation) -> Solid {
    let [x, y, z] = v.each_between([(0.12, 0.17), (0.18, 0.24), (0.015, 0.04)]);
    let print = PrintedLabel::new(
        v,
        &[
            PLASTICS[0],
            PLASTICS[1],
            PLASTICS[3],
            [70, 40, 32],
            [40, 48, 80],
            [220, 204, 170],
        ],
    );
    let cover =
        |cell_m: f32, height: f32| rounded_box([x, y, 0.003], 0.0, cell_m).moved(0.0, 0.0, height);
    let front =
        cover(0.008, (z - 0.003) / 2.0).painted(|p, _| print.at(p.x / x + 0.5, p.y / y + 0.5));
    let back = cover(0.1, (0.003 - z) / 2.0).colored(print.ground);
    let spine = rounded_box([0.004, y, z], 0.0015, 0.007).moved(-x / 2.0, 0.0, 0.0);
    let ink = contrasting(print.ground);
    let spine = spine.painted(|p, n| {
        let is_title = n.x < -0.7 && (0.08..0.3).contains(&(p.y / y)) && p.z.abs() < 0.25 * z;
        if is_title { ink } else { print.ground }
    });
    let pages = rounded_box([x - 0.008, y - 0.01, z - 0.004], 0.0, 0.1)
        .moved(-0.002, 0.0, 0.0)
        .colored([236, 228, 206]);
    [front, back, spine, pages]
        .into_iter()
        .collect::<Solid>()
        .with_surface(PRINTED)
}

pub(crate) fn sponge(v: &mut Variation) -> Solid {
    let [x, y, z] = v.each_between([(0.085, 0.115), (0.055, 0.07), (0.028, 0.042)]);
    let (foam, scour) = (
        v.color(&[
            [246, 214, 60],
            [240, 150, 60],
            [120, 190, 220],
            [238, 130, 170],
            [150, 210, 90],
        ]),
        v.color(&[[30, 110, 60], [40, 60, 130], [80, 80, 80]]),
    );
    let (seed, pad) = (
        v.seed(),
        if v.with_probability(0.75) {
            z / 2.0 - 0.008
        } else {
            1.0
        },
    );
    let dent = v.between(0.0, 0.006);
    rounded_box([x, y, z], 0.004, 0.004)
        .painted(|p, _| match p.z {
            up if up > pad => mottled(p, scour, 0.002, 0.5, seed),
            _ => speckled(p, (foam, shaded(foam, 0.62)), 0.0045, 0.27, seed),
        })
        .warped(|p| {
            // Pinched in at the sides, as many are.
            let middle = 1.0 - (p.x / (0.5 * x)).powi(2);
            Point3::new(
                p.x,
                p.y - p.y.signum() * dent * middle * (p.y.abs() / (0.5 * y)),
                p.z,
            )
        })
}

pub(crate) fn toothpaste(v: &mut Variation) -> Solid {
    let [length, w, r] = v.each_between([(0.13, 0.17), (0.024, 0.028), (0.015, 0.019)]);
    let palette: [Rgb; 5] = [WHITE, PLASTICS[0], PLASTICS[1], PLASTICS[6], PLASTICS[3]];
    let (print, cap) = (PrintedLabel::new(v, &palette), v.color(&palette));
    // Round at the shoulder, flat at the crimp.
    let section = |t: f32| (w * (1.0 - 0.25 * t), 0.0014 + (r - 0.0014) * t.powf(0.7));
    let points = [
        [0.0, 0.0, 0.0],
        [length / 3.0, 0.0, 0.0],
        [length / 1.5, 0.0, 0.0],
        [length, 0.0, 0.0],
    ];
    let tube = crate::sweep::swept(&points, Vector3::z(), section);
    let tube = tube.painted(|p, _| {
        let side = if p.z >= 0.0 { p.y } else { -p.y };
        print.at(side / (2.0 * w) + 0.5, 1.0 - p.x / length)
    });
    let head = cylinder(0.011, v.between(0.016, 0.026), 0.002);
    let head = crate::sweep::lying(head)
        .colored(cap)
        .moved(length + 0.008, 0.0, 0.0);
    let crimp = rounded_box([0.009, 2.1 * w, 0.0022], 0.0006, 0.006).moved(-0.003, 0.0, 0.0);
    // It rests on its flat end and its shoulder.
    let tilt = (r - 0.001) / length;
    tube.joined(crimp.colored(cap))
        .joined(head)
        .rotated(Vector3::y(), -tilt)
        .with_surface(PLASTIC)
}
