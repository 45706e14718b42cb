//! Families of fruit.

use crate::finish::WAXY;
use crate::palette::{BARK, LEAF, Rgb, mix, shaded};
use crate::pattern::{azimuth, mottled, noise, radius, speckled};
use crate::profile::{Profile, ellipse, lathed, spline};
use crate::sweep::{interpolate, resting_on_two_points, rod, swept};
use crate::variation::Variation;
use mesh::{Solid, ellipsoid, extrude};
use nalgebra::{Point3, Vector3};
use std::f32::consts::TAU;

/// Body of revolution with random deviations from roundness.
pub(crate) fn irregular_lathe(profile: &Profile, v: &mut Variation) -> Solid {
    let (squash, lean) = (v.between(0.93, 1.0), v.between(-0.08, 0.08));
    lathed(profile).warped(|p| Point3::new(p.x * squash + lean * p.z, p.y, p.z))
}

/// Short bent stem that starts at z, with a random length in a range.
pub(crate) fn stem(v: &mut Variation, z: f32, length: (f32, f32), r: f32, color: Rgb) -> Solid {
    let length = v.between(length.0, length.1);
    let bend = v.between(-0.4, 0.4) * length;
    rod(
        &[
            [0.0, 0.0, z],
            [bend * 0.3, 0.0, z + 0.6 * length],
            [bend, 0.0, z + length],
        ],
        r,
    )
    .colored(color)
    .decorative()
}

/// Flat leaf at z, pointing away from the axis.
fn leaf(z: f32, length: f32, angle: f32, color: Rgb) -> Solid {
    extrude(&ellipse(length / 2.0, length / 4.5, 16), 0.0012, 0.0)
        .moved(length / 2.0 + 0.0006, 0.0, z)
        .warped(|p| Point3::new(p.x, p.y, p.z + 0.25 * p.x - 6.0 * p.x * p.x))
        .rotated(Vector3::z(), angle)
        .colored(color)
        .decorative()
}

pub(crate) fn apple(v: &mut Variation) -> Solid {
    let r = v.between(0.033, 0.042);
    let h = r * v.between(1.65, 1.85);
    let profile = spline(
        &[
            (0.0, 0.08 * h),
            (r * 0.3, 0.0),
            (r * 0.78, 0.16 * h),
            (r, 0.58 * h),
            (r * 0.72, 0.92 * h),
            (r * 0.28, 0.98 * h),
            (0.0, 0.82 * h),
        ],
        5,
    );
    let ground = v.color(&[[176, 196, 70], [224, 206, 96], [140, 176, 52]]);
    let blush = v.color(&[[178, 28, 36], [206, 52, 44], [150, 24, 40]]);
    let (redness, side, seed) = (v.between(-0.1, 1.1), v.between(0.0, TAU), v.seed());
    let body = irregular_lathe(&profile, v).painted(|p, _| {
        let (sin, cos) = side.sin_cos();
        let lit = (p.x * cos + p.y * sin) / r * 0.4 + redness;
        let streak = noise(&Point3::new(azimuth(p) * 0.3, 0.0, p.z * 0.1), 0.006, seed) - 0.5;
        let skin = mix(ground, blush, lit * 1.4 + streak * 0.6);
        mix([120, 110, 50], skin, radius(p) / (0.3 * r))
    });
    let body = body.joined(stem(v, 0.82 * h, (0.014, 0.022), 0.0014, BARK));
    let leaved = v.with_probability(0.3);
    let body = if leaved {
        body.joined(leaf(0.95 * h, 0.03, side, LEAF))
    } else {
        body
    };
    body.with_surface(WAXY)
}

pub(crate) fn pear(v: &mut Variation) -> Solid {
    let r = v.between(0.03, 0.037);
    let h = r * v.between(2.6, 3.1);
    let neck = r * v.between(0.42, 0.56);
    let profile = spline(
        &[
            (0.0, 0.03 * h),
            (r * 0.45, 0.0),
            (r * 0.86, 0.11 * h),
            (r, 0.3 * h),
            (r * 0.82, 0.52 * h),
            (neck, 0.78 * h),
            (neck * 0.72, 0.95 * h),
            (0.0, h),
        ],
        5,
    );
    let skin = v.color(&[
        [190, 196, 76],
        [214, 198, 88],
        [150, 168, 62],
        [172, 130, 70],
    ]);
    let (blush, seed) = (v.color(&[[190, 90, 50], [160, 120, 60]]), v.seed());
    let share = v.between(0.0, 0.7);
    let body = irregular_lathe(&profile, v).painted(|p, _| {
        let color = mix(skin, blush, (p.x / r * 0.5 + 0.3) * share);
        speckled(p, (color, shaded(color, 0.75)), 0.0045, 0.18, seed)
    });
    body.joined(stem(v, h - 0.004, (0.018, 0.026), 0.0016, BARK))
        .with_surface(WAXY)
}

pub(crate) fn banana(v: &mut Variation) -> Solid {
    let (bow, r) = (v.between(0.085, 0.115), v.between(0.0155, 0.0195));
    let sweep = v.between(1.5, 2.0);
    let skin = v.color(&[
        [240, 208, 62],
        [226, 190, 50],
        [196, 200, 80],
        [244, 216, 92],
    ]);
    let (spots, seed) = (v.between(0.05, 0.3), v.seed());
    let at = |t: f32| {
        let (sin, cos) = ((t - 0.5) * sweep).sin_cos();
        [bow * sin, bow * (1.0 - cos), 0.0]
    };
    let points: Vec<[f32; 3]> = (0..=8).map(|i| at(i as f32 / 8.0)).collect();
    let widths = [0.34, 0.5, 0.9, 1.0, 1.0, 0.95, 0.85, 0.5, 0.28].map(|w| w * r);
    let reach = at(1.0)[0];
    let body = swept(&points, Vector3::z(), |t| {
        (interpolate(&widths, t), interpolate(&widths, t))
    })
    .warped(|p| Point3::new(p.x, p.y, p.z * 0.94))
    .painted(|p, _| {
        let end = p.x / reach;
        let tip = mix(
            [110, 100, 40],
            skin,
            ((1.0 - end.abs()) * 9.0).clamp(0.0, 1.0),
        );
        speckled(p, (tip, [96, 64, 30]), 0.008, spots, seed)
    });
    // The stem continues straight from one end.
    let [x, y, _] = at(0.0);
    let stalk = rod(
        &[
            [x, y, 0.0],
            [x - 0.008, y + 0.011, 0.0],
            [x - 0.012, y + 0.022, 0.001],
        ],
        r * 0.3,
    );
    body.joined(stalk.colored([128, 120, 48]))
        .with_surface(WAXY)
}

pub(crate) fn orange(v: &mut Variation) -> Solid {
    let r = v.between(0.034, 0.044);
    let flat = v.between(0.92, 1.0);
    let (skin, seed) = (
        v.color(&[[238, 134, 28], [246, 150, 44], [226, 112, 22]]),
        v.seed(),
    );
    let body = ellipsoid([r, r, r * flat], 48).painted(|p, _| {
        let navel = (p.x.hypot(p.y) / (0.09 * r)).min(1.0);
        let pores = mottled(p, skin, 0.0035, 0.22, seed);
        mix(
            if p.z > 0.0 {
                [88, 110, 40]
            } else {
                shaded(skin, 0.7)
            },
            pores,
            navel,
        )
    });
    body.joined(
        ellipsoid([0.0035, 0.0035, 0.0016], 12)
            .colored(LEAF)
            .moved(0.0, 0.0, r * flat)
            .decorative(),
    )
    .with_surface(WAXY)
}

pub(crate) fn lemon(v: &mut Variation) -> Solid {
    let r = v.between(0.024, 0.03);
    let half = r * v.between(1.35, 1.55);
    let nip = r * v.between(0.2, 0.28);
    let profile = spline(
        &[
            (0.0, -half),
            (nip, -half * 0.9),
            (r * 0.8, -half * 0.5),
            (r, 0.0),
            (r * 0.8, half * 0.5),
            (nip, half * 0.88),
            (nip * 0.6, half * 0.98),
            (0.0, half),
        ],
        4,
    );
    let is_lime = v.with_probability(0.25);
    let skin = if is_lime {
        v.color(&[[110, 160, 50]])
    } else {
        v.color(&[[246, 220, 62], [238, 206, 48], [250, 228, 96]])
    };
    let seed = v.seed();
    crate::sweep::lying(irregular_lathe(&profile, v))
        .painted(|p, _| {
            let tip = mix([150, 170, 60], skin, (1.0 - p.x / half) * 8.0);
            mottled(p, tip, 0.004, 0.16, seed)
        })
        .with_surface(WAXY)
}

pub(crate) fn strawberry(v: &mut Variation) -> Solid {
    let r = v.between(0.014, 0.019);
    let h = r * v.between(2.1, 2.6);
    let profile = spline(
        &[
            (0.0, 0.0),
            (r * 0.35, 0.1 * h),
            (r * 0.75, 0.42 * h),
            (r, 0.76 * h),
            (r * 0.6, 0.97 * h),
            (0.0, h),
        ],
        5,
    );
    let (skin, seed) = (
        v.color(&[[206, 30, 38], [188, 24, 34], [222, 56, 48]]),
        v.seed(),
    );
    let body = lathed(&profile).painted(|p, _| {
        let ripe = mix([236, 180, 130], skin, (h - p.z) / (0.12 * h));
        mottled(p, ripe, 0.003, 0.2, seed)
    });
    // The seeds form a spiral.
    let pip = |i: usize| {
        let t = (i as f32 + 0.5) / 44.0;
        let z = h * (0.08 + 0.82 * t);
        let rz = profile
            .windows(2)
            .find(|w| w[1].y >= z && w[0].y < z)
            .map_or(r, |w| {
                w[0].x + (w[1].x - w[0].x) * (z - w[0].y) / (w[1].y - w[0].y)
            });
        let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
        ellipsoid([0.0007, 0.0007, 0.0011], 6).moved(rz * cos * 0.97, rz * sin * 0.97, z)
    };
    let pips: Solid = (4..44).map(pip).collect();
    let n = v.count(5, 7);
    let crown: Solid = (0..n)
        .map(|i| leaf(h - 0.001, r * 0.8, (i as f32 + 0.5) / n as f32 * TAU, LEAF))
        .collect();
    let stalk = stem(v, h - 0.002, (0.008, 0.01), 0.0012, LEAF).with_convex_hull();
    let berry = body
        .joined(pips.colored([236, 206, 96]).decorative())
        .joined(crown.with_convex_hull())
        .joined(stalk);
    resting_on_two_points(berry.rotated(Vector3::y(), 1.9)).with_surface(WAXY)
}

pub(crate) fn peach(v: &mut Variation) -> Solid {
    let r = v.between(0.031, 0.039);
    let h = r * v.between(1.75, 1.95);
    let profile = spline(
        &[
            (0.0, 0.0),
            (r * 0.45, 0.0),
            (r * 0.86, 0.18 * h),
            (r, 0.5 * h),
            (r * 0.75, 0.88 * h),
            (r * 0.25, 0.98 * h),
            (0.0, 0.9 * h),
        ],
        6,
    );
    let (skin, blush) = (
        v.color(&[[246, 190, 110], [248, 204, 140]]),
        v.color(&[[214, 92, 70], [196, 70, 74]]),
    );
    let (seed, share) = (v.seed(), v.between(0.2, 0.7));
    let body = irregular_lathe(&profile, v)
        .warped(|p| {
            // A furrow down one side.
            let furrow = (-(p.y / 0.0045).powi(2)).exp() * f32::from(p.x > 0.0) * 0.07;
            Point3::new(p.x * (1.0 - furrow), p.y, p.z)
        })
        .painted(|p, _| {
            let cloud = noise(p, 0.02, seed) - 0.5 + p.y / r * 0.5;
            mottled(p, mix(skin, blush, share + cloud), 0.002, 0.08, seed)
        });
    body.joined(leaf(
        h * 0.93,
        v.between(0.025, 0.04),
        v.between(0.0, TAU),
        LEAF,
    ))
}
