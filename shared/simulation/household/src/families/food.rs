//! Families of prepared food: bread, pastry, eggs.

use crate::finish::{GLAZED, WAXY};
use crate::palette::{PLASTICS, WHITE, mix, shaded};
use crate::pattern::{mottled, noise, radius, speckled};
use crate::profile::{lathed, polyline, spline};
use crate::variation::Variation;
use mesh::{Solid, ellipsoid, lathe, rounded_box};
use nalgebra::{Point2, Point3, Vector3};
use std::f32::consts::{PI, TAU};

pub(crate) fn donut(v: &mut Variation) -> Solid {
    let (ring, thick) = (v.between(0.026, 0.031), v.between(0.0145, 0.019));
    let flat = v.between(0.75, 0.95);
    let section: Vec<Point2<f32>> = (0..20)
        .map(|i| (i as f32 / 20.0 * TAU).sin_cos())
        .map(|(sin, cos)| Point2::new(ring + thick * cos, thick * flat * sin))
        .collect();
    let (dough, icing) = (
        v.color(&[[206, 150, 84], [186, 124, 64]]),
        v.color(&[[240, 140, 170], [92, 52, 32], WHITE, [250, 220, 140]]),
    );
    let (seed, is_iced) = (v.seed(), v.with_probability(0.85));
    let body = lathe(&section, 48).painted(|p, _| {
        let edge = thick * flat * (0.05 + 0.5 * (noise(p, 0.014, seed) - 0.5));
        if is_iced && p.z > edge {
            icing
        } else {
            mottled(p, dough, 0.008, 0.2, seed)
        }
    });
    let n_sprinkles = if v.with_probability(0.6) && is_iced {
        v.count(24, 40)
    } else {
        0
    };
    let sprinkle = |i: usize| {
        let angle = (i as f32 * 0.569_84).fract() * TAU;
        let tilt = (i as f32 * 0.754_88).fract() * 1.8 - 0.9;
        let (r, z) = (ring + thick * tilt.sin(), thick * flat * tilt.cos());
        rounded_box([0.006, 0.0016, 0.0016], 0.0, 0.01)
            .rotated(Vector3::z(), i as f32 * 1.7)
            .moved(r * angle.cos(), r * angle.sin(), z + 0.0003)
            .colored(PLASTICS[i % 8])
    };
    let sprinkles: Solid = (0..n_sprinkles).map(sprinkle).collect();
    body.joined(sprinkles.decorative()).with_surface(WAXY)
}

pub(crate) fn bread(v: &mut Variation) -> Solid {
    let (half, w) = (v.between(0.1, 0.13), v.between(0.04, 0.052));
    let h = w * v.between(0.62, 0.8);
    let (crust, crumb, seed) = (
        v.color(&[[186, 122, 62], [166, 100, 50], [204, 146, 84]]),
        [236, 206, 156],
        v.seed(),
    );
    let n_cuts = v.count(3, 5) as f32;
    let slant = v.between(0.3, 0.8);
    // A cut opens where the wave along the loaf is near its crest.
    let cut = move |x: f32, y: f32| {
        let phase = ((x + slant * y) / half * n_cuts * 0.5 + 0.25).rem_euclid(1.0) - 0.5;
        (1.0 - phase.abs() * 7.0).clamp(0.0, 1.0) * (1.0 - (x / half).powi(4)).max(0.0)
    };
    mesh::superellipsoid([half, w, h], 0.9, 0.85, 64)
        .painted(|p, n| {
            let open = if n.z > 0.45 && p.y.abs() < 0.7 * w {
                cut(p.x, p.y)
            } else {
                0.0
            };
            mix(
                mottled(p, shaded(crust, 0.8 + 0.25 * n.z.abs()), 0.012, 0.3, seed),
                crumb,
                open * 1.5,
            )
        })
        .warped(|p| {
            let flat = if p.z < 0.0 { 0.45 } else { 1.0 };
            let dip = if p.z > 0.5 * h {
                cut(p.x, p.y) * 0.1
            } else {
                0.0
            };
            Point3::new(p.x, p.y, p.z * flat * (1.0 - dip))
        })
}

pub(crate) fn egg(v: &mut Variation) -> Solid {
    let r = v.between(0.0205, 0.0235);
    let long = v.between(1.28, 1.42);
    let taper = v.between(0.1, 0.2);
    let shell = v.color(&[
        [232, 190, 150],
        [240, 226, 206],
        [212, 160, 120],
        [244, 242, 236],
    ]);
    let (seed, share) = (v.seed(), v.pick(&[0.0, 0.0, 0.24]));
    ellipsoid([r * long, r, r], 40)
        .warped(|p| {
            let k = 1.0 - taper * p.x / (r * long);
            Point3::new(p.x, p.y * k, p.z * k)
        })
        .painted(|p, _| speckled(p, (shell, shaded(shell, 0.6)), 0.003, share, seed))
}

pub(crate) fn cupcake(v: &mut Variation) -> Solid {
    let [foot, r, h] = v.each_between([(0.022, 0.026), (0.031, 0.036), (0.035, 0.042)]);
    let paper = v.color(&PLASTICS);
    let n = 10.0;
    let cup = lathed(&polyline(&[(0.0, 0.0), (foot, 0.0), (r, h), (0.0, h)]))
        .warped(|p| {
            let k = 1.0 + 0.03 * (p.y.atan2(p.x) * n).cos() * f32::from(radius(&p) > 0.8 * foot);
            Point3::new(p.x * k, p.y * k, p.z)
        })
        .painted(|p, _| {
            shaded(
                paper,
                if (p.y.atan2(p.x) * n).cos() > 0.0 {
                    1.0
                } else {
                    0.72
                },
            )
        });
    // Icing in rings, each smaller.
    let (n_rings, top) = (v.count(3, 4), v.between(0.03, 0.04));
    let mut points = vec![(0.0, h - 0.003), (r * 0.9, h - 0.003)];
    for i in 0..n_rings {
        let t = i as f32 / n_rings as f32;
        let (z, step) = (h + top * t, top / n_rings as f32);
        let width = r * 1.08 * (1.0 - t.powf(1.4));
        points.extend([
            (width, z + 0.3 * step),
            (width * 0.98, z + 0.65 * step),
            (width * 0.8, z + 0.98 * step),
        ]);
    }
    points.push((0.0, h + top));
    let icing = v.color(&[
        [250, 190, 206],
        WHITE,
        [110, 66, 42],
        [200, 226, 180],
        [250, 226, 150],
    ]);
    let cherry = ellipsoid([0.008, 0.008, 0.0075], 20)
        .colored([186, 22, 36])
        .moved(0.0, 0.0, h + top + 0.003);
    cup.joined(lathed(&spline(&points, 3)).colored(icing))
        .joined(cherry)
        .with_surface(GLAZED)
}

pub(crate) fn croissant(v: &mut Variation) -> Solid {
    let (bow, r) = (v.between(0.05, 0.06), v.between(0.022, 0.027));
    let sweep = v.between(2.3, 2.8);
    let (crust, seed) = (
        v.color(&[[206, 142, 70], [190, 120, 56], [220, 164, 92]]),
        v.seed(),
    );
    let n_turns = v.pick(&[5.0, 7.0_f32]);
    let points: Vec<[f32; 3]> = (0..=10)
        .map(|i| ((i as f32 / 10.0 - 0.5) * sweep).sin_cos())
        .map(|(sin, cos)| [bow * sin, bow * (1.0 - cos), 0.0])
        .collect();
    // Layers of the rolled dough are steps in its thickness.
    let width = |t: f32| {
        let from_middle = (2.0 * t - 1.0).abs();
        let step = (from_middle * n_turns * 0.5).floor() / (n_turns * 0.5);
        r * (1.0 - 0.72 * step.mul_add(0.7, 0.3 * from_middle))
    };
    crate::sweep::swept(&points, Vector3::z(), |t| (width(t), width(t) * 0.85)).painted(|p, n| {
        let angle = p.x.atan2(bow - p.y).abs() / sweep * 2.0;
        let seam = ((angle * n_turns * 0.5).fract() * PI).sin();
        mottled(
            p,
            shaded(crust, 0.66 + 0.3 * seam + 0.1 * n.z),
            0.006,
            0.2,
            seed,
        )
    })
}
