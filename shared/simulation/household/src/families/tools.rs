//! Families of tools, lying along x.

use crate::finish::{BRUSHED, PLASTIC, POLISHED};
use crate::palette::{BLACK, GRIPS, METALS, Rgb, WHITE, WOODS, shaded};
use crate::pattern::{is_stripe, wood};
use crate::profile::{cylinder, lathed, polyline, rounded, rounded_outline};
use crate::sweep::{interpolate, lying, resting_on_two_points, rod, swept};
use crate::variation::Variation;
use mesh::{Solid, extrude, rounded_box};
use nalgebra::{Point3, Vector3};
use std::f32::consts::{FRAC_PI_2, PI};

pub(crate) fn hammer(v: &mut Variation) -> Solid {
    let (length, r) = (v.between(0.22, 0.28), v.between(0.011, 0.014));
    let (base, grip, seed) = (v.color(&WOODS), v.color(&GRIPS), v.seed());
    let (has_grip, metal) = (
        v.with_probability(0.6),
        v.color(&[METALS[0], METALS[2], [70, 72, 78]]),
    );
    let edge = -length * v.between(0.4, 0.55);
    let widths = [r * 1.15, r * 1.2, r, r * 0.85, r * 0.8];
    let handle = swept(
        &[
            [-length, 0.0, 0.0],
            [-length * 0.5, 0.0, 0.0],
            [0.012, 0.0, 0.0],
        ],
        Vector3::z(),
        |t| (interpolate(&widths, t), interpolate(&widths, t) * 0.8),
    );
    let handle = handle.painted(|p, _| {
        if has_grip && p.x < edge {
            grip
        } else {
            wood(p, base, seed)
        }
    });
    // Face to one side, claw or peen to the other, along y.
    let (face, out) = (v.between(0.0125, 0.015), v.between(0.034, 0.044));
    let profile = rounded(
        &[
            (0.0, -0.014),
            (face * 0.8, -0.014),
            (face * 0.72, out * 0.55),
            (face, out * 0.62),
            (face, out),
            (0.0, out),
        ],
        0.002,
    );
    let head = lathed(&profile).rotated(Vector3::x(), -FRAC_PI_2);
    let tail = if v.with_probability(0.6) {
        claw()
    } else {
        peen()
    };
    let head = head.joined(tail).colored(metal).with_surface(BRUSHED);
    handle.with_surface(PLASTIC).joined(head)
}

/// Hammer claw: two bent prongs.
fn claw() -> Solid {
    let prong = |side: f32| {
        let s = side * 0.006;
        let points = [
            [0.0, -0.008, s],
            [-0.002, -0.03, s * 1.1],
            [-0.011, -0.052, s * 1.6],
            [-0.022, -0.064, s * 2.0],
        ];
        swept(&points, Vector3::z(), |t| {
            (0.0075 - 0.0055 * t, 0.0058 - 0.001 * t)
        })
    };
    prong(-1.0).joined(prong(1.0))
}

/// Hammer peen: a wedge across the handle.
fn peen() -> Solid {
    let wedge = polyline(&[
        (-0.011, -0.01),
        (0.011, -0.01),
        (0.002, -0.052),
        (-0.002, -0.052),
    ]);
    extrude(&wedge, 0.021, 0.001).moved(0.0, 0.0, -0.0105)
}

pub(crate) fn screwdriver(v: &mut Variation) -> Solid {
    let [r, grip, shaft] = v.each_between([(0.0125, 0.0165), (0.085, 0.11), (0.075, 0.13)]);
    let [color, band] = v.colors([&GRIPS, &[BLACK, GRIPS[2], WHITE, GRIPS[0]]]);
    let (n, depth) = (v.pick(&[6.0, 8.0_f32]), v.between(0.04, 0.09));
    let profile = rounded(
        &[
            (0.0, 0.0),
            (r * 0.85, 0.0),
            (r, 0.12 * grip),
            (r, 0.55 * grip),
            (r * 0.6, 0.8 * grip),
            (r * 0.75, 0.95 * grip),
            (0.005, grip),
            (0.0, grip),
        ],
        0.006,
    );
    let handle = lathed(&profile)
        .warped(|p| {
            let k = 1.0
                + depth
                    * ((p.y.atan2(p.x) * n).cos() - 1.0)
                    * f32::from(p.z > 0.01 && p.z < 0.7 * grip);
            Point3::new(p.x * k, p.y * k, p.z)
        })
        .painted(|p, _| {
            if (0.62..0.76).contains(&(p.z / grip)) || p.z < 0.1 * grip {
                band
            } else {
                color
            }
        });
    let (blade, is_flat) = (v.between(0.0026, 0.0036), v.with_probability(0.5));
    let end = grip + shaft;
    let shaft = shaft_of(blade, (grip, end), is_flat, v.color(&METALS));
    resting_on_two_points(lying(handle.with_surface(PLASTIC).joined(shaft)))
}

/// Screwdriver shaft along z, with a flat or a pointed tip.
fn shaft_of(r: f32, (start, end): (f32, f32), is_flat: bool, metal: Rgb) -> Solid {
    let tip = if is_flat { 1.6 } else { 0.35 };
    let profile = polyline(&[
        (0.0, start - 0.004),
        (r, start - 0.004),
        (r, end - 0.014),
        (r * tip, end),
        (0.0, end),
    ]);
    let flatness = if is_flat { 0.8 } else { 0.0 };
    lathed(&profile)
        .warped(|p| {
            let near_tip = ((p.z - end + 0.016) / 0.016).clamp(0.0, 1.0);
            Point3::new(p.x, p.y * (1.0 - flatness * near_tip), p.z)
        })
        .painted(|p, _| shaded(metal, if p.z > end - 0.01 { 0.55 } else { 1.0 }))
        .with_surface(POLISHED)
}

pub(crate) fn wrench(v: &mut Variation) -> Solid {
    let (length, jaw) = (v.between(0.15, 0.22), v.between(0.0075, 0.0105));
    let (w, head) = (jaw * v.between(0.75, 0.9), jaw * 2.1);
    let (metal, thick) = (
        v.color(&[METALS[0], METALS[1], METALS[2], [110, 112, 118]]),
        v.between(0.006, 0.009),
    );
    let tilt = v.between(0.15, 0.3);
    // An open jaw at one end, turned a little; a ring or a smaller jaw at the other.
    let open = |size: f32| -> Vec<(f32, f32)> {
        let h = size / jaw * head;
        let arc = (0..=12).map(|i| 0.55 + (2.0 * PI - 1.1) * i as f32 / 12.0);
        let mut points: Vec<(f32, f32)> = arc.map(|a| (h * a.cos(), h * 0.95 * a.sin())).collect();
        points.extend([
            (h * 0.75, -size),
            (-h * 0.15, -size),
            (-h * 0.32, 0.0),
            (-h * 0.15, size),
            (h * 0.75, size),
        ]);
        points
    };
    let jaw_part =
        |size: f32| extrude(&polyline(&open(size)), thick, 0.0008).moved(0.0, 0.0, -thick / 2.0);
    let first = jaw_part(jaw)
        .rotated(Vector3::z(), tilt)
        .moved(length / 2.0, 0.0, 0.0);
    let second = if v.with_probability(0.6) {
        let r = head * 0.85;
        let profile = polyline(&[
            (r * 0.58, -thick * 0.6),
            (r, -thick * 0.6),
            (r, thick * 0.6),
            (r * 0.58, thick * 0.6),
        ]);
        lathed(&profile)
    } else {
        jaw_part(jaw * 0.85).rotated(Vector3::z(), PI + tilt)
    };
    let half = length / 2.0 - head * 0.55;
    let shank = rounded_outline(
        &[(-half, -w), (half, -w * 1.1), (half, w * 1.1), (-half, w)],
        0.001,
    );
    let shank = extrude(&shank, thick * 0.75, 0.001).moved(0.0, 0.0, -thick * 0.375);
    let stamp = rounded_box([half * 0.9, w * 0.9, thick * 0.8], 0.0008, 0.01).decorative();
    first
        .joined(second.moved(-length / 2.0, 0.0, 0.0))
        .joined(shank)
        .colored(metal)
        .joined(stamp.colored(shaded(metal, 0.7)))
        .with_surface(POLISHED)
}

pub(crate) fn pliers(v: &mut Variation) -> Solid {
    let [grip, nose, w] = v.each_between([(0.1, 0.125), (0.045, 0.075), (0.009, 0.011)]);
    let (color, metal, spread) = (
        v.color(&GRIPS),
        v.color(&[METALS[0], METALS[2], [84, 86, 92]]),
        v.between(0.022, 0.03),
    );
    let edge = v.between(-0.018, -0.026);
    let half = |side: f32| {
        let s = side;
        let points = [
            [0.012, s * 0.006, 0.0],
            [-0.012, s * 0.009, 0.0],
            [-0.3 * grip, s * spread * 0.85, 0.0],
            [-0.7 * grip, s * spread, 0.0],
            [-grip, s * spread * 0.75, 0.0],
        ];
        let handle = swept(&points, Vector3::z(), |t| {
            (
                interpolate(&[0.006, 0.0055, 0.0062, 0.0066, 0.006], t),
                0.0055,
            )
        })
        .painted(|p, _| if p.x < edge { color } else { metal });
        let mut jaw = vec![
            (-0.006, s * 0.0008),
            (-0.006, s * w),
            (0.012, s * w * 1.1),
            (nose, s * w * 0.35),
            (nose, s * 0.0008),
        ];
        if side < 0.0 {
            jaw.reverse();
        }
        let jaw = extrude(&rounded_outline(&jaw, 0.002), 0.01, 0.0004).moved(0.0, 0.0, -0.005);
        handle.joined(jaw.colored(metal))
    };
    let rivet = cylinder(0.0095, 0.013, 0.001)
        .moved(0.0, 0.0, -0.0065)
        .colored(shaded(metal, 0.8));
    half(1.0)
        .joined(half(-1.0))
        .joined(rivet)
        .with_surface(BRUSHED)
}

pub(crate) fn clamp(v: &mut Variation) -> Solid {
    let (length, reach) = (v.between(0.1, 0.14), v.between(0.06, 0.08));
    let [frame, metal, grip] = v.colors([&GRIPS, &METALS, &[WOODS[0], BLACK, METALS[0]]]);
    let w = v.between(0.012, 0.015);
    // A C of cast iron, a screw through its lower arm.
    let (x, y) = (length, reach);
    let c = [
        (0.0, 0.0),
        (x, 0.0),
        (x, y),
        (x - w, y),
        (x - w, w),
        (w, w),
        (w, y),
        (0.0, y),
    ];
    let c = extrude(&rounded_outline(&c, 0.014), 0.013, 0.0015)
        .moved(0.0, 0.0, -0.0065)
        .colored(frame);
    let (out, height) = (v.between(0.02, 0.05), y - 0.009);
    let opening = v.between(0.3, 0.7) * (x - 2.0 * w);
    let end = -out - 0.02;
    let screw = cylinder(0.0052, x - w - opening - end, 0.0005);
    let screw = lying(screw).moved(end, height, 0.0).painted(|p, _| {
        shaded(
            metal,
            if is_stripe(p.x / 0.006 + 40.0, 1) {
                0.72
            } else {
                1.0
            },
        )
    });
    let pad = |from: f32| {
        lying(cylinder(0.0105, 0.006, 0.001))
            .moved(from, height, 0.0)
            .colored(metal)
    };
    let bar = rod(
        &[
            [end + 0.004, height - 0.028, 0.0],
            [end + 0.004, height + 0.028, 0.0],
        ],
        0.0035,
    )
    .colored(grip);
    let boss = lying(cylinder(0.0095, w + 0.006, 0.002))
        .moved(-0.003, height, 0.0)
        .colored(frame);
    c.joined(screw)
        .joined(pad(x - w - opening - 0.004))
        .joined(pad(x - w - 0.005))
        .joined(bar)
        .joined(boss)
        .with_surface(BRUSHED)
}
