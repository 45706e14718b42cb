//! Families of electric devices: phones, remote controls, lamps.

use crate::finish::{DARK_GLASS, PLASTIC};
use crate::palette::{
    BLACK, BRASS, GLAZES, METALS, PASTELS, PLASTICS, Rgb, WHITE, contrasting, mix, shaded,
};
use crate::pattern::{azimuth, is_stripe};
use crate::profile::{Profile, cylinder, lathed, polyline, rounded, rounded_outline, subdivided};
use crate::sweep::rod;
use crate::variation::Variation;
use mesh::{Solid, extrude, lathe, rounded_box, superellipsoid};
use nalgebra::{Point3, Vector3};
use std::f32::consts::TAU;

/// Colours of plastic shells.
const SHELLS: [Rgb; 5] = [BLACK, [90, 92, 98], [206, 208, 210], WHITE, [52, 60, 84]];

/// Slab with round corners, its lower face at z = 0.
fn slab(x: f32, y: f32, z: f32, corner: f32) -> Solid {
    let (a, b) = (x / 2.0, y / 2.0);
    let outline = rounded_outline(&[(-a, -b), (a, -b), (a, b), (-a, b)], corner);
    extrude(&outline, z, z * 0.2)
}

pub(crate) fn phone(v: &mut Variation) -> Solid {
    let [x, y, z] = v.each_between([(0.064, 0.078), (0.135, 0.165), (0.008, 0.011)]);
    let body = v.color(&[BLACK, METALS[0], WHITE, PLASTICS[0], PLASTICS[1], BRASS]);
    let (top, bottom, is_on) = (
        v.color(&PLASTICS),
        v.color(&PLASTICS),
        v.with_probability(0.5),
    );
    let corner = v.between(0.008, 0.014);
    let case = slab(x, y, z, corner).colored(body);
    let glass = slab(x * 0.93, y * 0.965, 0.0012, corner * 0.8)
        .colored([18, 18, 22])
        .moved(0.0, 0.0, z - 0.0004);
    // A lit display shows a gradient and rows of icons.
    let display = rounded_box([x * 0.86, y * 0.86, 0.001], 0.0003, 0.004).painted(|p, _| {
        let (u, w) = (p.x / (x * 0.86) + 0.5, p.y / (y * 0.86) + 0.5);
        let is_icon = (u * 4.0).fract() > 0.3 && (w * 7.0).fract() > 0.35 && w > 0.12;
        let back = mix(bottom, top, w);
        match is_on {
            true if is_icon => mix(back, WHITE, 0.75),
            true => back,
            false => [24, 24, 30],
        }
    });
    let display = display.moved(0.0, 0.0, z + 0.0006);
    let lens = cylinder(0.0025, 0.001, 0.0)
        .moved(0.0, y * 0.455, z + 0.0002)
        .colored([60, 62, 80]);
    let front = glass
        .joined(display)
        .joined(lens)
        .decorative()
        .with_surface(DARK_GLASS);
    case.with_surface(PLASTIC).joined(front)
}

pub(crate) fn remote_control(v: &mut Variation) -> Solid {
    let [x, y, z] = v.each_between([(0.042, 0.052), (0.15, 0.21), (0.016, 0.022)]);
    let (body, key) = (v.color(&SHELLS), v.color(&PLASTICS));
    let plain = contrasting(body);
    let plain = mix(plain, body, 0.35);
    let waist = v.between(0.0, 0.12);
    let case = rounded_box([x, y, z], z * 0.4, 0.01)
        .warped(|p| {
            Point3::new(
                p.x * (1.0 - waist * (1.0 - (p.y / (0.5 * y)).powi(2))),
                p.y,
                p.z,
            )
        })
        .colored(body);
    let n_rows = v.count(4, 6);
    let button = |i: usize| {
        let (column, row) = (i % 3, i / 3);
        cylinder(0.0042, 0.003, 0.0008)
            .moved(
                (column as f32 - 1.0) * x * 0.26,
                y * (-0.38 + 0.085 * row as f32),
                z / 2.0 - 0.001,
            )
            .colored(plain)
    };
    let buttons: Solid = (0..3 * n_rows).map(button).collect();
    let power = cylinder(0.005, 0.004, 0.001)
        .moved(-x * 0.26, y * 0.43, z / 2.0 - 0.001)
        .colored([206, 36, 34]);
    let r = x * 0.3;
    let dial = lathed(&polyline(&[
        (r * 0.45, 0.0),
        (r, 0.0),
        (r * 0.96, 0.003),
        (r * 0.5, 0.003),
    ]));
    let dial = dial
        .joined(cylinder(r * 0.36, 0.0034, 0.001))
        .moved(0.0, y * 0.24, z / 2.0 - 0.001)
        .colored(key);
    case.joined(buttons.joined(power).joined(dial).decorative())
        .with_surface(PLASTIC)
}

pub(crate) fn computer_mouse(v: &mut Variation) -> Solid {
    let [x, y, z] = v.each_between([(0.028, 0.034), (0.05, 0.06), (0.032, 0.04)]);
    let [body, key] = v.colors([&SHELLS, &[BLACK, [120, 122, 126], PLASTICS[0], PLASTICS[1]]]);
    let back = v.between(0.1, 0.35);
    let is_two_tone = v.with_probability(0.4);
    let side = mix(body, key, 0.8);
    let shell = superellipsoid([x, y, z], 0.85, 0.75, 56)
        .painted(|p, _| {
            let groove = p.y > 0.25 * y && p.x.abs() < 0.0026 || (p.y - 0.22 * y).abs() < 0.0026;
            match p.z {
                up if up > 0.25 * z && groove => shaded(body, 0.4),
                up if is_two_tone && up < 0.5 * z => side,
                _ => body,
            }
        })
        .warped(|p| {
            // Flat below, highest towards the palm.
            let up = if p.z > 0.0 {
                1.0 - back * (p.y / y)
            } else {
                0.08
            };
            Point3::new(
                p.x * (1.0 - 0.08 * (1.0 - (p.y / y).powi(2))),
                p.y,
                p.z * up,
            )
        })
        .with_convex_hull();
    let wheel = cylinder(0.0095, 0.006, 0.0015)
        .rotated(Vector3::y(), TAU / 4.0)
        .moved(-0.003, y * 0.55, z * 0.52);
    shell
        .joined(wheel.colored(key).decorative())
        .with_surface(PLASTIC)
}

pub(crate) fn keyboard(v: &mut Variation) -> Solid {
    let [x, y, z] = v.each_between([(0.28, 0.36), (0.105, 0.13), (0.012, 0.018)]);
    let (body, key, accent) = (
        v.color(&SHELLS),
        v.color(&[BLACK, WHITE, [70, 72, 78], [214, 212, 202]]),
        v.color(&PLASTICS),
    );
    let tilt = v.between(0.03, 0.08);
    let case = slab(x, y, z, 0.008).colored(body);
    let (n_columns, n_rows) = (v.count(13, 15), 5);
    let (w, h) = (x * 0.95 / n_columns as f32, y * 0.88 / n_rows as f32);
    let cap = |i: usize| {
        let (column, row) = (i % n_columns, i / n_columns);
        let is_space = row == 0 && (4..9).contains(&column);
        if is_space && column != 6 {
            return Solid::default();
        }
        let width = if is_space { w * 4.84 } else { w * 0.84 };
        let is_accent = column == n_columns - 1 && row == 2 || column == 0 && row == 4;
        rounded_box([width, h * 0.82, 0.007], 0.0, 1.0)
            .warped(|p| {
                if p.z > 0.0 {
                    Point3::new(p.x * 0.84, p.y * 0.84, p.z)
                } else {
                    p
                }
            })
            .moved(
                -x * 0.475 + w * (column as f32 + 0.5),
                -y * 0.44 + h * (row as f32 + 0.5),
                z + 0.001,
            )
            .colored(if is_accent { accent } else { key })
    };
    let caps: Solid = (0..n_columns * n_rows).map(cap).collect();
    let keys = caps.with_convex_hull();
    case.joined(keys)
        .rotated(Vector3::x(), tilt)
        .with_surface(PLASTIC)
}

pub(crate) fn lamp(v: &mut Variation) -> Solid {
    let [r, h, tall] = v.each_between([(0.05, 0.062), (0.27, 0.36), (0.11, 0.14)]);
    let low = h - tall;
    let kind = v.count(0, 2);
    let base = lathed(&lamp_base(kind, r, low)).colored(v.color(&GLAZES));
    let (wide, narrow) = (v.between(0.075, 0.095), v.between(0.04, 0.06));
    let shade = shade(v, wide, narrow, tall).moved(0.0, 0.0, low);
    // A cross of wire holds the shade.
    let z = h - 0.008;
    let arm = |angle: f32| {
        rod(&[[-narrow, 0.0, z], [narrow, 0.0, z]], 0.002).rotated(Vector3::z(), angle)
    };
    let wires = arm(0.0).joined(arm(TAU / 4.0)).colored(BRASS);
    let bulb = superellipsoid([0.024, 0.024, 0.034], 1.0, 1.0, 20)
        .moved(0.0, 0.0, low + 0.055)
        .colored([252, 246, 222]);
    base.joined(shade).joined(wires).joined(bulb)
}

/// Lamp base: a disc with a pole, a jar, or a lathed column.
fn lamp_base(kind: usize, r: f32, low: f32) -> Profile {
    let pole = 0.007;
    let (mut points, edge) = match kind {
        0 => (vec![(0.0, 0.0), (r, 0.0), (r, 0.012), (pole, 0.02)], 0.006),
        1 => {
            let jar = [(r * 0.7, 0.0), (r * 0.95, low * 0.45), (r * 0.3, low * 0.9)];
            (vec![(0.0, 0.0), jar[0], jar[1], jar[2], (pole, low)], 0.02)
        }
        _ => {
            let column = [
                (1.0, 0.0),
                (0.8, 0.12),
                (0.35, 0.3),
                (0.55, 0.55),
                (0.25, 0.85),
            ];
            let mut points = vec![(0.0, 0.0)];
            points.extend(column.map(|(x, z)| (x * r, z * low)));
            points.push((pole, low));
            (points, 0.015)
        }
    };
    points.extend([(pole, low + 0.03), (0.0, low + 0.03)]);
    rounded(&points, edge)
}

/// Lamp shade: a cone of cloth, open at both ends.
fn shade(v: &mut Variation, wide: f32, narrow: f32, tall: f32) -> Solid {
    let (cloth, trim, n) = (v.color(&PASTELS), v.color(&PLASTICS), v.count(5, 9));
    let is_striped = v.with_probability(0.35);
    let wall = 0.003;
    let section = [
        (wide, 0.0),
        (narrow, tall),
        (narrow - wall, tall),
        (wide - wall, 0.0),
        (wide, 0.0),
    ];
    let mut section = subdivided(&polyline(&section), 0.012);
    section.pop();
    lathe(&section, 48).painted(|p, _| {
        let share = p.z / tall;
        let is_trim = !(0.06..=0.94).contains(&share);
        let is_strip = is_striped && is_stripe(azimuth(p), n);
        if is_trim || is_strip {
            trim
        } else {
            mix(cloth, WHITE, share * 0.4)
        }
    })
}

pub(crate) fn headphones(v: &mut Variation) -> Solid {
    let (r, cup) = (v.between(0.07, 0.08), v.between(0.032, 0.038));
    let [band, pad, accent] = v.colors([&SHELLS, &[BLACK, [60, 50, 46]], &PLASTICS]);
    let points: Vec<[f32; 3]> = (0..=10)
        .map(|i| ((i as f32 / 10.0 - 0.5) * 3.3).sin_cos())
        .map(|(sin, cos)| [r * sin, r * 1.15 * cos, 0.0])
        .collect();
    let bow = crate::sweep::swept(&points, Vector3::z(), |_| (0.004, 0.011)).colored(band);
    let ear = |side: f32| {
        let shell = lathed(&rounded(
            &[
                (0.0, -0.012),
                (cup * 0.8, -0.012),
                (cup, 0.0),
                (cup, 0.006),
                (0.0, 0.006),
            ],
            0.006,
        ))
        .colored(accent);
        let cushion = lathed(&rounded(
            &[
                (0.0, 0.004),
                (cup * 0.98, 0.004),
                (cup * 0.9, 0.02),
                (cup * 0.5, 0.02),
                (cup * 0.45, 0.014),
                (0.0, 0.012),
            ],
            0.005,
        ))
        .colored(pad);
        shell
            .joined(cushion)
            .rotated(Vector3::y(), -side * TAU / 4.0)
            .moved(side * (r - 0.002), -0.012, 0.0)
    };
    bow.joined(ear(1.0)).joined(ear(-1.0)).with_surface(PLASTIC)
}
