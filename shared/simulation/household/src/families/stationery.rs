//! Families of stationery.

use crate::finish::{BRUSHED, DARK_GLASS, PLASTIC};
use crate::palette::{BLACK, GRIPS, METALS, PLASTICS, WHITE, contrasting, mix, shaded};
use crate::pattern::{PrintedLabel, is_stripe, radius};
use crate::profile::{
    cylinder, lathed, lathed_for_print, polyline, rounded, rounded_outline, subdivided,
};
use crate::sweep::{lying, swept};
use crate::variation::Variation;
use mesh::{Solid, TubeSection, extrude, lathe, rounded_box, tube};
use nalgebra::{Point2, Point3, Vector3};
use std::f32::consts::{FRAC_PI_2, TAU};

pub(crate) fn scissors(v: &mut Variation) -> Solid {
    let (blade, w) = (v.between(0.08, 0.11), v.between(0.0075, 0.0095));
    let [grip, metal] = v.colors([&[GRIPS[0], GRIPS[1], BLACK, GRIPS[3], GRIPS[4]], &METALS]);
    let [opening, rx, ry] = v.each_between([(0.06, 0.26), (0.022, 0.028), (0.016, 0.02)]);
    let arm = |side: f32| {
        let s = side;
        let points = [
            (blade, 0.0),
            (0.0, s * w),
            (-0.028, s * w * 0.9),
            (-0.028, -s * w * 0.2),
            (0.0, -s * w * 0.5),
            (blade * 0.6, -s * w * 0.35),
        ];
        let steel = extrude(&rounded_outline(&points, 0.003), 0.0022, 0.0004).colored(metal);
        // The bow crosses over to the other side.
        let centre = (-0.03 - rx * 0.9, -s * (ry + 0.004));
        let ring: Vec<TubeSection> = (0..=20)
            .map(|i| (i as f32 / 20.0 * TAU + 0.3).sin_cos())
            .map(|(sin, cos)| Point3::new(centre.0 + rx * cos, centre.1 - s * ry * sin, 0.0011))
            .map(|centre| TubeSection::round(centre, 0.0046))
            .collect();
        let ring = tube(&ring, Vector3::z(), 10);
        let bridge = swept(
            &[
                [-0.014, -s * 0.001, 0.0011],
                [-0.026, -s * 0.004, 0.0011],
                [centre.0 + rx * 0.75, centre.1 + s * ry * 0.5, 0.0011],
            ],
            Vector3::z(),
            |_| (0.0062, 0.0044),
        );
        steel
            .joined(ring.joined(bridge).colored(grip))
            .moved(0.0, 0.0, s * 0.0011)
            .rotated(Vector3::z(), s * opening / 2.0)
    };
    let screw = cylinder(0.0042, 0.0075, 0.0008)
        .moved(0.0, 0.0, -0.0026)
        .colored(shaded(metal, 0.7))
        .decorative();
    arm(1.0)
        .joined(arm(-1.0))
        .joined(screw)
        .with_surface(BRUSHED)
}

pub(crate) fn tape_roll(v: &mut Variation) -> Solid {
    let (r, w) = (v.between(0.036, 0.055), v.between(0.02, 0.05));
    let hole = r * v.between(0.62, 0.76);
    let (tape, core) = (
        v.color(&[
            [200, 160, 100],
            [40, 40, 44],
            [214, 214, 206],
            PLASTICS[0],
            PLASTICS[1],
            PLASTICS[2],
        ]),
        v.color(&[[190, 160, 120], WHITE, [120, 110, 100]]),
    );
    let wall = 0.003;
    let section = rounded_outline(&[(hole, 0.0), (r, 0.0), (r, w), (hole, w)], 0.0008);
    let section = subdivided(&section, 0.004);
    lathe(&section, 48)
        .painted(|p, n| {
            let from_axis = radius(p);
            let layer = is_stripe(from_axis / 0.004 + 0.1, 1);
            match n.z.abs() {
                _ if from_axis < hole + wall => core,
                z if z > 0.7 => shaded(tape, if layer { 0.8 } else { 0.92 }),
                _ => tape,
            }
        })
        .with_surface(PLASTIC)
}

pub(crate) fn marker(v: &mut Variation) -> Solid {
    let (r, length) = (v.between(0.0075, 0.0105), v.between(0.115, 0.14));
    let [ink, body] = v.colors([&PLASTICS, &[WHITE, BLACK, [200, 202, 206]]]);
    let cap = length * v.between(0.62, 0.7);
    let (is_full, has_band) = (v.with_probability(0.3), v.with_probability(0.5));
    let profile = rounded(
        &[
            (0.0, 0.0),
            (r * 0.9, 0.0),
            (r * 0.94, 0.01),
            (r * 0.94, cap),
            (r * 1.1, cap + 0.001),
            (r * 1.02, length - 0.006),
            (r * 0.6, length),
            (0.0, length),
        ],
        0.0012,
    );
    let letter = contrasting(body);
    let pen = lathed(&profile).painted(|p, n| match p.z / cap {
        s if is_full || !(0.07..=1.0).contains(&s) => ink,
        s if has_band && (0.8..0.9).contains(&s) => ink,
        s if (0.25..0.65).contains(&s) && n.x < -0.6 => mix(body, letter, 0.7),
        _ => body,
    });
    let clip = rounded_box([0.0025, 0.004, (length - cap) * 0.8], 0.001, 0.01).moved(
        -r * 1.12,
        0.0,
        cap.midpoint(length),
    );
    lying(pen.joined(clip.colored(ink))).with_surface(PLASTIC)
}

pub(crate) fn stapler(v: &mut Variation) -> Solid {
    let [x, y, h] = v.each_between([(0.12, 0.155), (0.028, 0.034), (0.044, 0.056)]);
    let (color, base) = (
        v.color(&[BLACK, GRIPS[0], GRIPS[1], [120, 122, 128], PLASTICS[6]]),
        v.color(&[BLACK, [90, 92, 96]]),
    );
    let foot = rounded_box([x, y, 0.009], 0.004, 0.012)
        .moved(0.0, 0.0, 0.0045)
        .colored(base);
    let upright = FRAC_PI_2;
    // The arm seen from the side, hinged at the back.
    let arm = [
        (-x / 2.0, 0.014),
        (x * 0.47, h * 0.62),
        (x * 0.5, h * 0.74),
        (x * 0.42, h * 0.92),
        (-x * 0.1, h),
        (-x * 0.42, h * 0.75),
        (-x / 2.0, h * 0.5),
    ];
    let arm = extrude(&rounded_outline(&arm, 0.01), y * 0.82, 0.004)
        .rotated(Vector3::x(), upright)
        .moved(0.0, y * 0.41, 0.0)
        .colored(color);
    let rail = [
        (-x * 0.46, 0.012),
        (x * 0.485, h * 0.5),
        (x * 0.485, h * 0.66),
        (-x * 0.46, h * 0.3),
    ];
    let rail = extrude(&polyline(&rail), y * 0.55, 0.0005)
        .rotated(Vector3::x(), upright)
        .moved(0.0, y * 0.275, 0.0)
        .colored(METALS[0]);
    let hinge = rounded_box([0.018, y * 0.95, h * 0.5], 0.003, 0.012)
        .moved(-x * 0.42, 0.0, h * 0.27)
        .colored(METALS[2]);
    let anvil = rounded_box([0.012, y * 0.6, 0.003], 0.001, 0.01)
        .moved(x * 0.44, 0.0, 0.0095)
        .colored(METALS[1])
        .decorative();
    [foot, arm, rail, hinge, anvil]
        .into_iter()
        .collect::<Solid>()
        .with_surface(PLASTIC)
}

pub(crate) fn glue_stick(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.0125, 0.0165), v.between(0.085, 0.105));
    let (cap, print) = (
        v.color(&PLASTICS),
        PrintedLabel::new(v, &[PLASTICS[2], PLASTICS[0], WHITE, PLASTICS[1]]),
    );
    let split = h * v.between(0.66, 0.74);
    let foot = h * 0.1;
    let profile = rounded(
        &[
            (0.0, 0.0),
            (r * 0.95, 0.0),
            (r * 0.95, foot - 0.001),
            (r * 0.86, foot),
            (r * 0.96, foot + 0.001),
            (r * 0.96, split),
            (r * 1.06, split + 0.001),
            (r, h),
            (0.0, h),
        ],
        0.0015,
    );
    let stick = lathed_for_print(&profile).painted(|p, _| match p.z {
        z if z < foot || z > split => cap,
        z => print.wrapped(&Point3::new(p.x, p.y, z), foot, split),
    });
    stick.with_surface(PLASTIC)
}

pub(crate) fn calculator(v: &mut Variation) -> Solid {
    let [x, y, z] = v.each_between([(0.07, 0.095), (0.12, 0.16), (0.01, 0.016)]);
    let (body, key) = (
        v.color(&[BLACK, [92, 96, 104], WHITE, PLASTICS[1], PLASTICS[7]]),
        v.color(&[[210, 210, 206], [70, 72, 78], WHITE]),
    );
    let (accent, n_columns, n_rows) = (
        v.color(&[PLASTICS[4], PLASTICS[0], PLASTICS[1]]),
        v.count(4, 5),
        v.count(5, 6),
    );
    let case = rounded_box([x, y, z], z * 0.35, 0.012).colored(body);
    let display =
        rounded_box([x * 0.84, y * 0.2, 0.003], 0.001, 0.004).moved(0.0, y * 0.34, z / 2.0);
    let display = display
        .colored([150, 166, 142])
        .with_surface(DARK_GLASS)
        .decorative();
    let (w, h) = (x * 0.86 / n_columns as f32, y * 0.6 / n_rows as f32);
    let button = |i: usize| {
        let (column, row) = (i % n_columns, i / n_columns);
        let is_accent = column == n_columns - 1 || row == n_rows - 1 && column == 0;
        rounded_box([w * 0.78, h * 0.72, 0.005], 0.0012, 0.02)
            .moved(
                -x * 0.43 + w * (column as f32 + 0.5),
                y * 0.17 - h * (row as f32 + 0.5),
                z / 2.0,
            )
            .colored(if is_accent { accent } else { key })
    };
    let buttons: Solid = (0..n_columns * n_rows).map(button).collect();
    case.joined(buttons.decorative())
        .with_surface(PLASTIC)
        .joined(display)
}

pub(crate) fn pencil_cup(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.034, 0.042), v.between(0.09, 0.105));
    let (outside, stripe) = (v.color(&PLASTICS), v.color(&PLASTICS));
    let (n, is_ringed) = (v.count(5, 9), v.with_probability(0.5));
    let wall: Vec<Point2<f32>> = rounded(&[(0.0, 0.0), (r * 0.92, 0.0), (r, h)], 0.004);
    let cup = lathed(&crate::profile::shell(&wall, 0.003, 0.004)).painted(|p, _| {
        let t = if is_ringed {
            p.z / h
        } else {
            crate::pattern::azimuth(p)
        };
        if is_stripe(t, n) { stripe } else { outside }
    });
    let n_pencils = v.count(3, 6);
    let pencil = |i: usize, v: &mut Variation| {
        let length = v.between(0.12, 0.165);
        let color = v.color(&GRIPS);
        let profile = polyline(&[
            (0.0, 0.0),
            (0.0036, 0.0),
            (0.0036, length - 0.016),
            (0.001, length - 0.001),
            (0.0, length),
        ]);
        let lean = v.between(0.1, 0.2);
        lathe(&subdivided(&profile, 0.008), 10)
            .painted(|p, _| match length - p.z {
                from_tip if from_tip < 0.004 => mix(color, BLACK, 0.4),
                from_tip if from_tip < 0.017 => [222, 190, 140],
                _ => color,
            })
            .rotated(Vector3::y(), lean)
            .moved(r * 0.1, 0.0, 0.006)
            .rotated(Vector3::z(), i as f32 / n_pencils as f32 * TAU + 0.3)
    };
    let pencils: Solid = (0..n_pencils).map(|i| pencil(i, v)).collect();
    cup.joined(pencils).with_surface(PLASTIC)
}
