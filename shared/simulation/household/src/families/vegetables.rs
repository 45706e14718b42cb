//! Families of vegetables.

use crate::families::fruit::{irregular_lathe, stem};
use crate::finish::WAXY;
use crate::palette::{BARK, LEAF, mix, shaded};
use crate::pattern::{azimuth, mottled, noise};
use crate::profile::{lathed, spline};
use crate::sweep::{interpolate, lying, resting_on_two_points, rod, swept};
use crate::variation::Variation;
use mesh::{Solid, extrude};
use nalgebra::{Point2, Point3, Vector3};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Calyx: a star of sepals at z.
fn calyx(z: f32, n: usize, reach: f32, droop: f32) -> Solid {
    let outline: Vec<Point2<f32>> = (0..n * 4)
        .map(|i| {
            let r = reach * [1.0, 0.62, 0.28, 0.62][i % 4];
            let wide = [0.0, 0.22, 0.0, -0.22][i % 4];
            let (sin, cos) = ((i as f32 / 4.0 + wide) / n as f32 * TAU).sin_cos();
            Point2::new(r * cos, r * sin)
        })
        .collect();
    extrude(&outline, 0.0018, 0.0)
        .warped(|p| {
            Point3::new(
                p.x,
                p.y,
                p.z - droop * (p.x * p.x + p.y * p.y) / (reach * reach),
            )
        })
        .moved(0.0, 0.0, z)
        .colored(LEAF)
        .decorative()
}

pub(crate) fn tomato(v: &mut Variation) -> Solid {
    let r = v.between(0.028, 0.041);
    let h = r * v.between(1.45, 1.7);
    let profile = spline(
        &[
            (0.0, 0.02 * h),
            (r * 0.5, 0.01 * h),
            (r * 0.88, 0.2 * h),
            (r, 0.5 * h),
            (r * 0.7, 0.92 * h),
            (r * 0.25, h),
            (0.0, 0.93 * h),
        ],
        6,
    );
    let skin = v.color(&[[208, 36, 28], [222, 58, 34], [196, 28, 30], [232, 110, 36]]);
    let (n, depth) = (v.count(4, 6) as f32, v.between(0.0, 0.035));
    let body = irregular_lathe(&profile, v)
        .warped(|p| {
            let k = 1.0 + depth * (p.z / h) * (azimuth(&p) * n * TAU).cos();
            Point3::new(p.x * k, p.y * k, p.z)
        })
        .painted(|p, _| mix(skin, [226, 150, 50], (p.z / h - 0.88) * 4.0));
    let green = calyx(h + 0.0005, 5, r * v.between(0.45, 0.6), 0.002);
    body.joined(green)
        .joined(stem(v, h - 0.003, (0.01, 0.014), 0.0018, LEAF))
        .with_surface(WAXY)
}

pub(crate) fn carrot(v: &mut Variation) -> Solid {
    let (length, r) = (v.between(0.14, 0.2), v.between(0.013, 0.018));
    let profile = spline(
        &[
            (0.0, 0.0),
            (0.0022, 0.006),
            (r * 0.5, length * 0.35),
            (r * 0.85, length * 0.75),
            (r, length * 0.95),
            (r * 0.5, length),
            (0.0, length),
        ],
        6,
    );
    let (skin, seed, bend) = (
        v.color(&[[236, 120, 30], [226, 104, 26], [244, 138, 50]]),
        v.seed(),
        v.between(-0.5, 0.5),
    );
    let root = lying(lathed(&profile))
        .warped(|p| Point3::new(p.x, p.y + bend * (p.x - length * 0.5).powi(2), p.z))
        .painted(|p, _| {
            let ring = noise(&Point3::new(p.x * 8.0, p.y * 0.5, p.z * 0.5), 0.02, seed);
            let lit = shaded(skin, if ring < 0.25 { 0.75 } else { 0.95 + 0.1 * ring });
            mix(lit, [120, 130, 50], (p.x / length - 0.965) * 25.0)
        });
    let (n, tuft) = (v.count(4, 7), v.between(0.02, 0.06));
    let end = bend * (length * 0.5).powi(2);
    let greens: Solid = (0..n)
        .map(|i| {
            let (sin, cos) = (i as f32 / n as f32 * TAU).sin_cos();
            let out = r * 0.8;
            rod(
                &[
                    [length - 0.004, end, 0.0],
                    [length + tuft * 0.5, end + cos * out * 0.5, sin * out * 0.5],
                    [length + tuft, end + cos * out, sin * out],
                ],
                0.0022,
            )
        })
        .collect();
    root.joined(greens.colored(LEAF).with_convex_hull())
}

pub(crate) fn bell_pepper(v: &mut Variation) -> Solid {
    let r = v.between(0.034, 0.043);
    let h = r * v.between(1.8, 2.3);
    let profile = spline(
        &[
            (0.0, 0.08 * h),
            (r * 0.35, 0.01 * h),
            (r * 0.75, 0.12 * h),
            (r * 0.95, 0.5 * h),
            (r, 0.82 * h),
            (r * 0.62, 0.99 * h),
            (r * 0.25, 0.94 * h),
            (0.0, 0.9 * h),
        ],
        5,
    );
    let skin = v.color(&[[196, 30, 32], [244, 190, 36], [60, 132, 48], [236, 120, 32]]);
    let (n, depth) = (v.count(3, 4) as f32, v.between(0.09, 0.14));
    let body = lathed(&profile)
        .warped(|p| {
            // Lobes, deepest at both ends.
            let lobe = (azimuth(&p) * n * TAU / 2.0).sin().abs().sqrt() - 1.0;
            let k = 1.0 + 1.6 * depth * lobe * (0.6 + 0.4 * (2.0 * p.z / h - 1.0).powi(2));
            Point3::new(p.x * k, p.y * k, p.z)
        })
        .colored(skin);
    let stalk = stem(v, h * 0.88, (0.024, 0.032), 0.004, [86, 128, 50]);
    body.joined(stalk)
        .joined(calyx(h * 0.93, 5, r * 0.4, -0.003))
        .with_surface(WAXY)
}

pub(crate) fn eggplant(v: &mut Variation) -> Solid {
    let (length, r) = (v.between(0.15, 0.2), v.between(0.029, 0.038));
    let neck = r * v.between(0.5, 0.65);
    let bend = v.between(0.0, 0.03);
    let skin = v.color(&[[60, 28, 68], [44, 24, 50], [82, 36, 88]]);
    let widths = [r * 0.55, r * 0.95, r, r * 0.8, neck, neck * 0.8];
    let at = |t: f32| [length * t, bend * (2.0 * t - 1.0).powi(2), 0.0];
    let points: Vec<[f32; 3]> = (0..=6).map(|i| at(i as f32 / 6.0)).collect();
    let body = swept(&points, Vector3::z(), |t| {
        (interpolate(&widths, t), interpolate(&widths, t))
    })
    .colored(skin);
    // Resting it on two points would count a part that is longer than the neck is thick.
    let cap = calyx(0.0, 5, neck * 1.4, 0.014)
        .with_convex_hull()
        .rotated(Vector3::y(), FRAC_PI_2);
    let stalk = rod(
        &[[0.0, 0.0, 0.0], [0.014, 0.001, 0.0], [0.028, 0.006, 0.0]],
        0.0045,
    );
    let [x, y, _] = at(1.0);
    let green = cap
        .moved(0.004, 0.0, 0.0)
        .joined(stalk.colored([98, 130, 60]));
    resting_on_two_points(body.joined(green.moved(x + neck * 0.5, y, 0.0))).with_surface(WAXY)
}

pub(crate) fn mushroom(v: &mut Variation) -> Solid {
    let r = v.between(0.018, 0.03);
    let (stalk, h) = (r * v.between(0.36, 0.5), r * v.between(1.8, 2.2));
    let cap = h * v.between(0.45, 0.54);
    let profile = spline(
        &[
            (0.0, 0.0),
            (stalk * 1.15, 0.002),
            (stalk, cap * 0.6),
            (stalk * 1.1, cap - 0.002),
        ],
        5,
    )
    .into_iter()
    .chain(spline(
        &[
            (r * 0.75, cap - 0.001),
            (r * 0.98, cap - 0.004),
            (r, cap + 0.1 * r),
            (r * 0.7, cap + 0.75 * (h - cap)),
            (0.0, h),
        ],
        5,
    ))
    .collect::<Vec<_>>();
    let skin = v.color(&[
        [232, 222, 206],
        [176, 132, 92],
        [150, 106, 70],
        [240, 234, 224],
    ]);
    let seed = v.seed();
    lathed(&profile).painted(|p, n| match p.z {
        z if z < cap - 0.003 => mottled(p, [236, 228, 212], 0.004, 0.1, seed),
        _ if n.z < -0.3 => mix(BARK, [200, 170, 140], 0.4),
        _ => mottled(p, skin, 0.006, 0.16, seed),
    })
}
