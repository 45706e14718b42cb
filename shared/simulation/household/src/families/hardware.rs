//! Families of household hardware: flashlights, brushes, bulbs, magnifiers; lying along x.

use crate::finish::{BRUSHED, DARK_GLASS, PLASTIC, RUBBER};
use crate::palette::{BLACK, BRASS, GRIPS, METALS, STEEL, WOODS, mix, shaded};
use crate::pattern::{is_stripe, mottled, wood};
use crate::profile::{cylinder, ellipse, lathed, polyline, rounded, spline};
use crate::sweep::{interpolate, lying, swept};
use crate::variation::Variation;
use mesh::{Solid, lathe, rounded_box};
use nalgebra::{Point3, Vector3};

pub(crate) fn flashlight(v: &mut Variation) -> Solid {
    let [r, head, length] = v.each_between([(0.0125, 0.0165), (0.021, 0.027), (0.14, 0.19)]);
    let (body, band) = (
        v.color(&[BLACK, GRIPS[0], GRIPS[1], GRIPS[2], METALS[0], GRIPS[4]]),
        v.color(&[METALS[0], BLACK, GRIPS[2]]),
    );
    let neck = length * v.between(0.66, 0.74);
    let profile = rounded(
        &[
            (0.0, 0.0),
            (r, 0.0),
            (r, neck),
            (head, neck + 0.018),
            (head, length),
            (head * 0.86, length),
            (head * 0.84, length - 0.003),
            (0.0, length - 0.003),
        ],
        0.003,
    );
    let (lens, low) = ([226, 230, 214], v.between(0.2, 0.4));
    let n_rings = v.count(3, 7);
    let tube = lathed(&profile).painted(|p, n| {
        let share = p.z / neck;
        match share {
            _ if n.z > 0.7 && p.z > length - 0.005 && p.x.hypot(p.y) < 0.85 * head => lens,
            s if s > 1.25 || (s - 0.95).abs() < 0.03 => band,
            s if (low..0.85).contains(&s) && is_stripe((s - low) / 0.5, n_rings) => {
                shaded(body, 0.7)
            }
            _ => body,
        }
    });
    let switch = rounded_box([0.008, 0.01, 0.018], 0.003, 0.01)
        .moved(-r, 0.0, neck * 0.86)
        .colored(mix(body, BLACK, 0.7));
    // It rests on its head and its end.
    lying(tube.joined(switch.decorative()))
        .rotated(Vector3::y(), (r - head) / length * 1.1)
        .with_surface(PLASTIC)
}

pub(crate) fn paintbrush(v: &mut Variation) -> Solid {
    let (w, d) = (v.between(0.019, 0.032), v.between(0.0065, 0.009));
    let (bristle, handle) = (v.between(0.045, 0.06), v.between(0.1, 0.13));
    let (hair, metal) = (
        v.color(&[[64, 46, 34], [206, 182, 136], [34, 32, 34], [236, 228, 210]]),
        v.color(&[METALS[0], BRASS]),
    );
    let (grip, seed, is_dipped) = (
        v.color(&[WOODS[0], WOODS[3], GRIPS[0], GRIPS[1], GRIPS[2]]),
        v.seed(),
        v.with_probability(0.4),
    );
    let paint = v.color(&GRIPS);
    let widths = [0.006, 0.0095, 0.0075, 0.008, w * 0.92];
    let stick = swept(
        &[
            [-handle, 0.0, 0.0],
            [-handle * 0.5, 0.0, 0.0],
            [0.0, 0.0, 0.0],
        ],
        Vector3::z(),
        |t| (interpolate(&widths, t), 0.0068),
    )
    .painted(|p, _| wood(p, grip, seed));
    let ferrule = rounded_box([0.03, 2.0 * w, 2.0 * d], 0.004, 0.01)
        .moved(0.013, 0.0, 0.0)
        .colored(metal);
    let sections = [
        [0.024, 0.0, 0.0],
        [0.024 + bristle * 0.6, 0.0, 0.0],
        [0.024 + bristle, 0.0, 0.0],
    ];
    let tuft = swept(&sections, Vector3::z(), |t| {
        (
            w * interpolate(&[0.95, 1.05, 0.95], t),
            d * interpolate(&[0.92, 0.85, 0.3], t),
        )
    })
    .painted(|p, _| {
        let wet = is_dipped && p.x > 0.024 + bristle * 0.62;
        mottled(
            &Point3::new(p.x * 0.05, p.y, p.z),
            if wet { paint } else { hair },
            0.0018,
            0.4,
            seed,
        )
    });
    stick
        .joined(ferrule.with_surface(BRUSHED))
        .joined(tuft.with_surface(RUBBER))
}

pub(crate) fn light_bulb(v: &mut Variation) -> Solid {
    let (r, length) = (v.between(0.028, 0.034), v.between(0.1, 0.12));
    let (glass, metal) = (
        v.color(&[[246, 244, 232], [250, 240, 206], [232, 236, 240]]),
        v.color(&[METALS[0], BRASS]),
    );
    let thread = 0.013;
    let mut points = vec![
        (0.0, 0.0),
        (0.005, 0.0),
        (0.006, 0.003),
        (thread * 0.9, 0.006),
    ];
    points.extend((0..9).map(|i| {
        (
            thread * (1.0 - 0.09 * (i % 2) as f32),
            0.007 + 0.0023 * i as f32,
        )
    }));
    let mut profile = polyline(&points);
    let neck = 0.028;
    profile.extend(spline(
        &[
            (thread * 1.05, neck),
            (thread * 1.15, neck + 0.008),
            (r * 0.92, length - 1.35 * r),
            (r, length - 0.85 * r),
            (r * 0.7, length - 0.25 * r),
            (0.0, length),
        ],
        6,
    ));
    let bulb = lathed(&profile).painted(|p, _| match p.z {
        z if z < 0.005 => BLACK,
        z if z < neck - 0.001 => metal,
        _ => glass,
    });
    // It rests on its glass and its thread.
    lying(bulb)
        .rotated(Vector3::y(), (r - thread) / (length - r))
        .with_surface(PLASTIC)
}

pub(crate) fn magnifier(v: &mut Variation) -> Solid {
    let (r, length) = (v.between(0.033, 0.045), v.between(0.085, 0.11));
    let (rim, grip) = (
        v.color(&[BLACK, METALS[0], BRASS]),
        v.color(&[BLACK, WOODS[2], GRIPS[0], GRIPS[1]]),
    );
    let section: Vec<_> = ellipse(0.0042, 0.0062, 12)
        .iter()
        .map(|p| nalgebra::Point2::new(r + p.x, p.y))
        .collect();
    let ring = lathe(&section, 48).colored(rim);
    let lens = lathed(&polyline(&[
        (0.0, -0.003),
        (r * 0.99, -0.001),
        (r * 0.99, 0.001),
        (0.0, 0.003),
    ]));
    let lens = lens.colored([150, 172, 180]).with_surface(DARK_GLASS);
    let collar = lying(cylinder(0.0055, 0.022, 0.001))
        .moved(r, 0.0, 0.0)
        .colored(STEEL);
    let widths = [0.007, 0.0095, 0.0085, 0.0105, 0.009];
    let start = r + 0.02;
    let handle = swept(
        &[
            [start, 0.0, 0.0],
            [start + length / 2.0, 0.0, 0.0],
            [start + length, 0.0, 0.0],
        ],
        Vector3::z(),
        |t| (interpolate(&widths, t), interpolate(&widths, t) * 0.9),
    );
    ring.joined(collar)
        .joined(handle.colored(grip))
        .with_surface(PLASTIC)
        .joined(lens)
}
