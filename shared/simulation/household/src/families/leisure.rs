//! Families of leisure objects: balls, candles, caps.

use crate::finish::{PLASTIC, RUBBER, WAXY};
use crate::palette::{BLACK, PASTELS, PLASTICS, WHITE, mix, shaded};
use crate::pattern::{azimuth, is_inside, is_stripe, mottled};
use crate::profile::{ellipse, lathed, rounded, rounded_outline, shell, spline};
use crate::sweep::{rod, swept};
use crate::variation::Variation;
use mesh::{Solid, ellipsoid, extrude};
use nalgebra::{Point3, Vector3};
use std::f32::consts::{FRAC_PI_2, PI, TAU};

pub(crate) fn tennis_ball(v: &mut Variation) -> Solid {
    let r = v.between(0.032, 0.0345);
    let (felt, seed) = (
        v.color(&[
            [206, 226, 60],
            [220, 236, 90],
            [190, 214, 50],
            [236, 140, 60],
        ]),
        v.seed(),
    );
    let seam: Vec<Vector3<f32>> = (0..96)
        .map(|i| i as f32 / 96.0 * TAU)
        .map(|t| {
            Vector3::new(
                0.75 * t.cos() + 0.25 * (3.0 * t).cos(),
                0.75 * t.sin() - 0.25 * (3.0 * t).sin(),
                0.866 * (2.0 * t).sin(),
            )
        })
        .collect();
    let (tilt, turn) = (v.between(0.0, TAU), v.between(0.0, TAU));
    ellipsoid([r, r, r], 64)
        .painted(|p, _| {
            let on_seam = seam
                .iter()
                .any(|s| (p.coords / r - s).norm_squared() < 0.012);
            if on_seam {
                WHITE
            } else {
                mottled(p, felt, 0.002, 0.3, seed)
            }
        })
        .rotated(Vector3::x(), tilt)
        .rotated(Vector3::z(), turn)
        .with_surface(RUBBER)
}

pub(crate) fn soccer_ball(v: &mut Variation) -> Solid {
    let r = v.between(0.07, 0.092);
    let (spot, ground) = (
        v.color(&[BLACK, BLACK, PLASTICS[0], PLASTICS[1]]),
        v.color(&[WHITE, WHITE, [244, 226, 120]]),
    );
    let golden = 1.0_f32.midpoint(5.0_f32.sqrt());
    let corner = |i: usize| {
        let (a, b) = (
            if i & 1 == 0 { 1.0 } else { -1.0 },
            if i & 2 == 0 { golden } else { -golden },
        );
        match i / 4 {
            0 => Vector3::new(0.0, a, b).normalize(),
            1 => Vector3::new(a, b, 0.0).normalize(),
            _ => Vector3::new(b, 0.0, a).normalize(),
        }
    };
    let pentagons: Vec<Vector3<f32>> = (0..12).map(corner).collect();
    let tilt = v.between(0.0, TAU);
    ellipsoid([r, r, r], 76)
        .painted(|p, _| {
            let mut near: Vec<f32> = pentagons.iter().map(|c| c.dot(&p.coords) / r).collect();
            near.sort_by(|a, b| b.total_cmp(a));
            // A pentagon extends less far towards its neighbours.
            let edge = 0.945 - 0.12 * (near[1] - 0.447);
            let seam = shaded(ground, 0.72 + 6.0 * (near[0] - near[1]).min(0.046));
            mix(seam, spot, (near[0] - edge) / 0.03 + 0.5)
        })
        .rotated(Vector3::new(1.0, 0.4, 0.2), tilt)
        .with_surface(PLASTIC)
}

pub(crate) fn candle(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.025, 0.036), v.between(0.075, 0.14));
    let (wax, seed, dip) = (
        v.color(&[
            [240, 228, 200],
            PLASTICS[0],
            [190, 210, 180],
            PASTELS[0],
            PASTELS[4],
            [226, 170, 70],
            [90, 40, 60],
        ]),
        v.seed(),
        v.between(0.004, 0.01),
    );
    let profile = spline(
        &[
            (r * 0.96, h - 0.004),
            (r * 0.9, h),
            (r * 0.6, h - dip * 0.7),
            (0.0, h - dip),
        ],
        5,
    );
    let mut points = rounded(&[(0.0, 0.0), (r, 0.0), (r, h - 0.008)], 0.002);
    points.extend(profile);
    let (n_bands, band) = (v.count(0, 3), v.color(&PASTELS));
    let body = lathed(&points).painted(|p, _| {
        let is_band = (0..n_bands).any(|i| (p.z / h - 0.3 - 0.16 * i as f32).abs() < 0.035);
        let glow = ((p.z / h - 0.85) * 5.0).clamp(0.0, 1.0);
        mix(
            mottled(p, if is_band { band } else { wax }, 0.01, 0.06, seed),
            [250, 236, 190],
            glow * 0.4,
        )
    });
    let bend = v.between(-0.004, 0.004);
    let wick = rod(
        &[
            [0.0, 0.0, h - dip - 0.002],
            [bend * 0.3, 0.0, h + 0.004],
            [bend, 0.0, h + 0.012],
        ],
        0.0013,
    )
    .colored([36, 32, 30]);
    // Wax has run down.
    let n = v.count(0, 4);
    let mut drips = Solid::default();
    for _ in 0..n {
        let (angle, length) = (v.between(0.0, TAU), v.between(0.15, 0.5) * h);
        let drop = swept(
            &[[r, 0.0, h - 0.006], [r, 0.0, h - length]],
            Vector3::y(),
            |t| (0.0018 + 0.0016 * t, 0.0025 + 0.0018 * t),
        );
        drips = drips.joined(drop.rotated(Vector3::z(), angle));
    }
    let wax_drip = mix(wax, WHITE, 0.15);
    body.joined(drips.colored(wax_drip).decorative())
        .joined(wick)
        .with_surface(WAXY)
}

pub(crate) fn cap(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.08, 0.092), v.between(0.1, 0.12));
    let (cloth, brim) = (v.color(&PLASTICS), v.color(&PLASTICS));
    let (n, is_panelled, is_same) = (3, v.with_probability(0.4), v.with_probability(0.5));
    let brim = if is_same { cloth } else { brim };
    let outer = spline(
        &[
            (0.0, -h),
            (r * 0.5, -h * 0.9),
            (r * 0.9, -h * 0.5),
            (r, -h * 0.2),
            (r * 0.98, 0.0),
        ],
        5,
    );
    let dome = lathed(&shell(&outer, 0.004, 0.004 - h))
        .painted(|p, n_| {
            if is_inside(p, n_) {
                return shaded(cloth, 0.6);
            }
            let seam = (azimuth(p) * 6.0).fract() < 0.06;
            let color = if is_panelled && is_stripe(azimuth(p), n) {
                brim
            } else {
                cloth
            };
            shaded(color, if seam { 0.75 } else { 1.0 })
        })
        .rotated(Vector3::x(), PI)
        .stretched(1.12, 0.95, 1.0);
    let reach = v.between(0.06, 0.075);
    let arc = |k: f32, a: f32| (k * r * 1.08 * a.cos(), 0.86 * r * a.sin());
    let mut points: Vec<(f32, f32)> = (0..=14)
        .map(|i| arc(1.0, -1.25 + 2.5 * i as f32 / 14.0))
        .map(|(x, y)| (x * 0.98, y))
        .collect();
    points.reverse();
    points.extend((0..=14).map(|i| -1.25 + 2.5 * i as f32 / 14.0).map(|a| {
        (
            arc(1.0, a).0 + reach * a.cos().max(0.0).powf(0.6),
            arc(1.0, a).1,
        )
    }));
    let visor = extrude(&rounded_outline(&points, 0.001), 0.003, 0.0005)
        .warped(|p| Point3::new(p.x, p.y, p.z + 0.012 - 2.6 * p.y * p.y))
        .colored(brim);
    let button = ellipsoid([0.006, 0.006, 0.004], 14)
        .moved(0.0, 0.0, h)
        .colored(brim)
        .decorative();
    let badge = extrude(&ellipse(0.022, 0.02, 20), 0.002, 0.0)
        .rotated(Vector3::y(), FRAC_PI_2 - 0.35)
        .moved(r * 1.06, 0.0, h * 0.42);
    let badge = badge.colored(v.color(&PLASTICS)).decorative();
    dome.joined(visor).joined(button).joined(badge)
}
