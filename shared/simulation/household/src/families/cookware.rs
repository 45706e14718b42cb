//! Families of cookware: pots, pans, kettles, trays.

use crate::finish::{BRUSHED, PLASTIC, POLISHED};
use crate::palette::{BLACK, GLAZES, GRIPS, METALS, PLASTICS, WOODS, shaded};
use crate::pattern::{is_inside, wood};
use crate::profile::{cylinder, lathed, polyline, rounded, shell};
use crate::sweep::{rod, swept};
use crate::variation::Variation;
use mesh::{Solid, rounded_box};
use nalgebra::{Point3, Vector3};

pub(crate) fn pot(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.075, 0.1), v.between(0.08, 0.125));
    let (metal, is_enamel) = (v.color(&METALS), v.with_probability(0.5));
    let (enamel, grip) = (v.color(&GLAZES), v.color(&[BLACK, METALS[0], GRIPS[0]]));
    let outer = rounded(&[(0.0, 0.0), (r, 0.0), (r, h)], 0.01);
    let body = lathed(&shell(&outer, 0.003, 0.005)).painted(|p, n| {
        if is_enamel && !is_inside(p, n) {
            enamel
        } else {
            metal
        }
    });
    let w = v.between(0.022, 0.03);
    let z = h * 0.82;
    let handle = rod(
        &[
            [r + 0.003, -w, z],
            [r + 0.022, -w * 0.9, z + 0.004],
            [r + 0.03, 0.0, z + 0.005],
            [r + 0.022, w * 0.9, z + 0.004],
            [r + 0.003, w, z],
        ],
        0.0055,
    )
    .colored(grip);
    let other = handle.clone().rotated(Vector3::z(), std::f32::consts::PI);
    let pot = body.joined(handle).joined(other);
    pot.joined(lid(v, r, h, metal)).with_surface(BRUSHED)
}

/// Lid with a knob; some pots come without.
fn lid(v: &mut Variation, r: f32, h: f32, metal: [u8; 3]) -> Solid {
    if v.with_probability(0.4) {
        return Solid::default();
    }
    let rise = v.between(0.012, 0.022);
    let profile = polyline(&[
        (0.0, h - 0.002),
        (r * 1.01, h - 0.002),
        (r * 1.02, h + 0.003),
        (r * 0.6, h + rise * 0.8),
        (0.007, h + rise),
        (0.007, h + rise + 0.008),
        (0.016, h + rise + 0.012),
        (0.016, h + rise + 0.02),
        (0.0, h + rise + 0.022),
    ]);
    let knob = h + rise + 0.001;
    lathed(&profile).painted(|p, _| if p.z > knob { BLACK } else { metal })
}

pub(crate) fn pan(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.08, 0.1), v.between(0.032, 0.045));
    let outer = rounded(&[(0.0, 0.0), (r * 0.82, 0.0), (r, h)], 0.012);
    let (coat, inner) = (
        v.color(&[BLACK, [70, 70, 74], GRIPS[0], METALS[2]]),
        v.color(&[[44, 44, 46], [60, 58, 56]]),
    );
    let body = lathed(&shell(&outer, 0.0035, 0.004))
        .painted(|p, n| if is_inside(p, n) { inner } else { coat });
    let length = v.between(0.14, 0.18);
    let grip = v.color(&[BLACK, WOODS[1], GRIPS[0]]);
    let handle = swept(
        &[
            [r * 0.946 + 0.004, 0.0, h * 0.7],
            [r + 0.3 * length, 0.0, h * 0.9],
            [r + length, 0.0, h * 1.15],
        ],
        Vector3::z(),
        |t| (0.007 + 0.005 * t, 0.005 + 0.002 * t),
    );
    let handle = handle.painted(|p, _| if p.x < r + 0.03 { METALS[0] } else { grip });
    body.joined(handle).with_surface(BRUSHED)
}

pub(crate) fn tray(v: &mut Variation) -> Solid {
    let [x, y, h] = v.each_between([(0.26, 0.34), (0.18, 0.24), (0.028, 0.042)]);
    let (wall, is_wood) = (0.009, v.with_probability(0.5));
    let base = if is_wood {
        v.color(&WOODS)
    } else {
        v.color(&PLASTICS)
    };
    let (floor, seed) = (
        if v.with_probability(0.4) {
            v.color(&PLASTICS)
        } else {
            base
        },
        v.seed(),
    );
    let long = |side: f32| {
        rounded_box([x, wall, h], 0.003, 0.03).moved(0.0, side * (y - wall) / 2.0, h / 2.0)
    };
    let short = |side: f32| {
        // Open in the middle: a bar above two posts leaves room for fingers.
        let at = side * (x - wall) / 2.0;
        let (outer, inner) = (y - 0.0006, y - 0.0012);
        let bar = rounded_box([wall - 0.0003, outer, 0.01], 0.003, 0.03).moved(at, 0.0, h + 0.01);
        let foot =
            rounded_box([wall - 0.0006, inner, h * 0.55], 0.003, 0.03).moved(at, 0.0, h * 0.275);
        let post = |s: f32| {
            rounded_box([wall - 0.0009, y * 0.3, h + 0.012], 0.003, 0.03).moved(
                at,
                s * (y * 0.35 - 0.001),
                h / 2.0 + 0.006,
            )
        };
        bar.joined(foot).joined(post(-1.0)).joined(post(1.0))
    };
    let bottom = rounded_box([x - 0.002, y - 0.002, 0.006], 0.0, 0.012).moved(0.0, 0.0, 0.0031);
    let bottom = bottom.painted(|p, _| if is_wood { wood(p, floor, seed) } else { floor });
    let frame: Solid = [long(-1.0), long(1.0), short(-1.0), short(1.0)]
        .into_iter()
        .collect();
    let frame = frame.painted(|p, _| {
        if is_wood {
            wood(p, shaded(base, 0.9), seed)
        } else {
            base
        }
    });
    bottom.joined(frame).with_surface(PLASTIC)
}

pub(crate) fn rolling_pin(v: &mut Variation) -> Solid {
    let [r, length, grip] = v.each_between([(0.021, 0.028), (0.19, 0.23), (0.06, 0.075)]);
    let (base, dark, seed) = (v.color(&WOODS), v.with_probability(0.4), v.seed());
    let knob = |x: f32, t: f32| (x * r, length / 2.0 + grip * t);
    let half = [
        knob(1.0, 0.0),
        knob(0.35, 0.02),
        knob(0.45, 0.35),
        knob(0.55, 0.7),
        knob(0.45, 0.95),
        knob(0.0, 1.0),
    ];
    let mut points: Vec<(f32, f32)> = half.iter().rev().map(|&(x, z)| (x, -z)).collect();
    points.extend(half);
    let color = |p: &Point3<f32>| {
        let is_grip = dark && p.x.abs() > length / 2.0;
        wood(p, if is_grip { shaded(base, 0.55) } else { base }, seed)
    };
    crate::sweep::lying(lathed(&rounded(&points, 0.006))).painted(|p, _| color(p))
}

pub(crate) fn kettle(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.065, 0.08), v.between(0.1, 0.13));
    let metal = v.color(&[METALS[0], METALS[1], GRIPS[0], GLAZES[2], [236, 226, 200]]);
    let grip = v.color(&[BLACK, WOODS[2], GRIPS[0]]);
    let profile = rounded(
        &[
            (0.0, 0.0),
            (r, 0.0),
            (r * 0.98, h * 0.45),
            (r * 0.45, h * 0.95),
            (r * 0.42, h),
            (0.0, h * 1.03),
        ],
        v.between(0.012, 0.022),
    );
    let body = lathed(&profile).joined(cylinder(0.01, 0.018, 0.004).moved(0.0, 0.0, h));
    let spout = swept(
        &[
            [-r * 0.7, 0.0, h * 0.45],
            [-r * 1.15, 0.0, h * 0.7],
            [-r * 1.4, 0.0, h * 0.98],
        ],
        Vector3::y(),
        |t| (0.016 - 0.008 * t, 0.016 - 0.008 * t),
    );
    // The handle is a bow over the lid.
    let top = h + v.between(0.055, 0.075);
    let bow = [
        [-r * 0.72, 0.0, h * 0.7],
        [-r * 0.7, 0.0, h * 1.15],
        [-r * 0.3, 0.0, top],
        [r * 0.3, 0.0, top],
        [r * 0.7, 0.0, h * 1.15],
        [r * 0.72, 0.0, h * 0.7],
    ];
    let handle = swept(&bow, Vector3::y(), |_| (0.005, 0.008));
    body.joined(spout)
        .colored(metal)
        .joined(handle.colored(grip))
        .with_surface(POLISHED)
}
