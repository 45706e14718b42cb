//! Families of crockery: glazed tableware and vases.

use crate::finish::{GLAZED, POLISHED};
use crate::palette::{GLAZES, METALS, Rgb, WHITE, contrasting, mix, shaded};
use crate::pattern::{azimuth, is_inside, is_stripe, radius, speckled};
use crate::profile::{lathed, polyline, rounded, shell, spline};
use crate::sweep::{swept, vessel_handle};
use crate::variation::Variation;
use mesh::Solid;
use nalgebra::{Point3, Vector3};

/// Decoration of a glazed vessel.
struct GlazeDecoration {
    outside: Rgb,
    inside: Rgb,
    accent: Rgb,
    kind: usize,
    n: usize,
    seed: u64,
}

impl GlazeDecoration {
    fn new(v: &mut Variation) -> Self {
        let outside = v.color(&GLAZES);
        Self {
            outside,
            inside: if v.with_probability(0.5) {
                WHITE
            } else {
                outside
            },
            accent: v.color(&GLAZES),
            kind: v.count(0, 5),
            n: v.count(4, 9),
            seed: v.seed(),
        }
    }

    /// Colour at a point of the surface of a vessel of this height.
    fn at(&self, p: &Point3<f32>, n: &Vector3<f32>, height: f32) -> Rgb {
        let share = p.z / height;
        let accented = match self.kind {
            _ if is_inside(p, n) => {
                return if share > 0.99 {
                    self.outside
                } else {
                    self.inside
                };
            }
            0 => (0.62..0.78).contains(&share) || (0.84..0.9).contains(&share),
            1 => is_stripe(azimuth(p), self.n),
            2 => share < 0.35,
            3 => {
                return speckled(
                    p,
                    (self.outside, shaded(self.accent, 0.7)),
                    0.006,
                    0.3,
                    self.seed,
                );
            }
            4 => is_stripe(azimuth(p), self.n) != is_stripe(share, 3),
            _ => false,
        };
        if accented { self.accent } else { self.outside }
    }
}

pub(crate) fn bowl(v: &mut Variation) -> Solid {
    let decor = GlazeDecoration::new(v);
    let (r, h) = (v.between(0.06, 0.095), v.between(0.05, 0.08));
    let (foot, belly) = (r * v.between(0.4, 0.55), v.between(0.72, 0.95));
    let mut outer = polyline(&[(0.0, 0.0), (foot, 0.0), (foot, 0.006)]);
    let flare = r * belly;
    outer.extend(spline(
        &[(foot + 0.002, 0.007), (flare, 0.45 * h), (r, h)],
        7,
    ));
    lathed(&shell(&outer, v.between(0.004, 0.006), 0.01))
        .painted(|p, n| decor.at(p, n, h))
        .with_surface(GLAZED)
}

pub(crate) fn mug(v: &mut Variation) -> Solid {
    let decor = GlazeDecoration::new(v);
    let (r, h) = (v.between(0.037, 0.046), v.between(0.08, 0.105));
    let (foot, waist) = (r * v.between(0.8, 1.0), r * v.between(0.92, 1.06));
    let outer = rounded(&[(0.0, 0.0), (foot, 0.0), (waist, 0.5 * h), (r, h)], 0.008);
    let body = lathed(&shell(&outer, 0.004, 0.006)).painted(|p, n| decor.at(p, n, h));
    let reach = v.between(0.024, 0.032);
    let (thickness, breadth) = (v.between(0.008, 0.011), v.between(0.01, 0.016));
    let (top, bottom) = (h * v.between(0.78, 0.86), h * v.between(0.2, 0.28));
    let color = if v.with_probability(0.3) {
        decor.inside
    } else {
        decor.outside
    };
    let handle = vessel_handle(&outer, (top, bottom), reach, thickness, breadth);
    body.joined(handle.colored(color)).with_surface(GLAZED)
}

pub(crate) fn teacup(v: &mut Variation) -> Solid {
    let decor = GlazeDecoration::new(v);
    let (r, h) = (v.between(0.042, 0.05), v.between(0.05, 0.062));
    let foot = r * v.between(0.42, 0.52);
    let mut outer = polyline(&[(0.0, 0.0), (foot, 0.0), (foot, 0.005)]);
    outer.extend(spline(
        &[
            (foot + 0.003, 0.006),
            (r * 0.82, 0.4 * h),
            (r * 0.9, 0.75 * h),
            (r, h),
        ],
        5,
    ));
    let cup = lathed(&shell(&outer, 0.003, 0.008)).painted(|p, n| decor.at(p, n, h));
    let handle = vessel_handle(&outer, (h * 0.85, h * 0.32), 0.018, 0.006, 0.007);
    let cup = cup
        .joined(handle.colored(decor.outside))
        .moved(0.0, 0.0, 0.006);
    // A teacup comes on its saucer.
    let s = v.between(0.066, 0.075);
    let outer = spline(
        &[(0.0, 0.0), (s * 0.5, 0.0), (s * 0.7, 0.004), (s, 0.015)],
        4,
    );
    let rim = decor.accent;
    let saucer = lathed(&shell(&outer, 0.003, 0.004))
        .painted(|p, _| {
            if radius(p) > 0.88 * s {
                rim
            } else {
                decor.outside
            }
        })
        .with_convex_hull();
    saucer.joined(cup).with_surface(GLAZED)
}

pub(crate) fn plate(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.095, 0.135), v.between(0.018, 0.026));
    let well = r * v.between(0.6, 0.72);
    let outer = spline(
        &[
            (0.0, 0.0),
            (well * 0.6, 0.0),
            (well, 0.002),
            (well * 1.12, 0.4 * h),
            (r, h),
        ],
        4,
    );
    let (ground, ring) = (v.color(&GLAZES), v.color(&GLAZES));
    let (kind, n) = (v.count(0, 3), v.count(8, 16));
    lathed(&shell(&outer, 0.004, 0.004))
        .painted(|p, _| {
            let share = radius(p) / r;
            let accented = match kind {
                0 => share > 0.93,
                1 => share > 0.75,
                2 => share > 0.75 && is_stripe(azimuth(p), n),
                _ => (0.78..0.84).contains(&share) || share < 0.25,
            };
            if accented { ring } else { ground }
        })
        .with_surface(GLAZED)
}

pub(crate) fn goblet(v: &mut Variation) -> Solid {
    let [foot, r, h] = v.each_between([(0.03, 0.036), (0.032, 0.04), (0.14, 0.18)]);
    let (stem, cup) = (v.between(0.005, 0.008), h * v.between(0.45, 0.55));
    let knob = if v.with_probability(0.5) {
        stem * 2.0
    } else {
        stem
    };
    let mut outer = polyline(&[(0.0, 0.0), (foot, 0.0), (foot, 0.003)]);
    outer.extend(spline(
        &[
            (foot * 0.8, 0.006),
            (stem * 1.2, 0.018),
            (knob, cup * 0.55),
            (stem * 1.1, cup * 0.85),
        ],
        5,
    ));
    outer.extend(spline(
        &[
            (stem * 1.4, cup),
            (r * 0.9, cup + 0.2 * (h - cup)),
            (r, cup + 0.6 * (h - cup)),
            (r * 0.92, h),
        ],
        5,
    ));
    let (metal, rim) = (
        v.color(&[METALS[0], METALS[3], [196, 160, 80], [176, 112, 72]]),
        v.with_probability(0.5),
    );
    let accent = shaded(metal, 0.6);
    lathed(&shell(&outer, 0.0025, cup + 0.006))
        .painted(|p, n| match p.z / h {
            _ if is_inside(p, n) && p.z > cup => mix(metal, WHITE, 0.3),
            share if rim && (0.78..0.9).contains(&share) => accent,
            _ => metal,
        })
        .with_surface(POLISHED)
}

pub(crate) fn teapot(v: &mut Variation) -> Solid {
    let mut decor = GlazeDecoration::new(v);
    decor.inside = decor.outside;
    let (r, h) = (v.between(0.058, 0.075), v.between(0.085, 0.12));
    let (foot, mouth) = (r * 0.6, r * v.between(0.48, 0.6));
    let belly = h * v.between(0.4, 0.55);
    let mut outline = polyline(&[(0.0, 0.0), (foot, 0.0)]);
    outline.extend(spline(&[(foot * 1.05, 0.004), (r, belly), (mouth, h)], 8));
    let d = v.between(0.008, 0.012);
    outline.extend(polyline(&[(mouth * 1.08, h), (mouth * 1.08, h + 0.004)]));
    outline.extend(spline(
        &[
            (mouth * 0.9, h + 0.008),
            (d * 0.6, h + 0.018),
            (d, h + 0.028),
            (0.0, h + 0.035),
        ],
        5,
    ));
    let body = lathed(&outline).painted(|p, n| {
        if p.z > h {
            decor.accent
        } else {
            decor.at(p, n, h)
        }
    });
    let spout_h = h * v.between(0.85, 1.0);
    let spout = swept(
        &[
            [-r * 0.75, 0.0, h * 0.3],
            [-r * 1.25, 0.0, h * 0.42],
            [-r * 1.5, 0.0, h * 0.7],
            [-r * 1.5 - 0.016, 0.0, spout_h],
        ],
        Vector3::y(),
        |t| (0.016 - 0.009 * t, 0.016 - 0.009 * t),
    );
    let handle = vessel_handle(&outline, (h * 0.82, h * 0.2), 0.036, 0.009, 0.013);
    let fittings = spout.joined(handle).colored(decor.outside);
    body.joined(fittings).with_surface(GLAZED)
}

pub(crate) fn pitcher(v: &mut Variation) -> Solid {
    let decor = GlazeDecoration::new(v);
    let (r, h) = (v.between(0.05, 0.062), v.between(0.17, 0.22));
    let (foot, neck) = (r * v.between(0.7, 0.85), r * v.between(0.6, 0.72));
    let mouth = neck * v.between(1.15, 1.3);
    let outer = spline(
        &[(foot, 0.003), (r, 0.35 * h), (neck, 0.8 * h), (mouth, h)],
        7,
    );
    let mut profile = polyline(&[(0.0, 0.0), (foot * 0.95, 0.0)]);
    profile.extend(outer);
    let lip = v.between(0.015, 0.022);
    let body = lathed(&shell(&profile, 0.005, 0.008))
        .painted(|p, n| decor.at(p, n, h))
        .warped(|p| {
            // Pulled out to a lip on one side of the mouth.
            let up = ((p.z / h - 0.8) / 0.2).clamp(0.0, 1.0);
            let ahead = (-p.x / radius(&p).max(1e-4)).max(0.0).powi(6);
            Point3::new(
                p.x - lip * up * up * ahead,
                p.y * (1.0 - 0.1 * up * ahead),
                p.z,
            )
        });
    let handle = vessel_handle(&profile, (h * 0.86, h * 0.3), 0.034, 0.01, 0.016);
    body.joined(handle.colored(decor.outside))
        .with_surface(GLAZED)
}

pub(crate) fn vase(v: &mut Variation) -> Solid {
    let decor = GlazeDecoration::new(v);
    let (r, h) = (v.between(0.045, 0.065), v.between(0.19, 0.27));
    let (foot, neck) = (r * v.between(0.5, 0.7), r * v.between(0.3, 0.42));
    let mouth = neck * v.between(1.5, 2.1);
    let (belly, throat) = (v.between(0.3, 0.5), v.between(0.74, 0.84));
    let mut outer = polyline(&[(0.0, 0.0), (foot * 0.95, 0.0)]);
    outer.extend(spline(
        &[
            (foot, 0.003),
            (r, belly * h),
            (neck, throat * h),
            (mouth, h),
        ],
        8,
    ));
    let (n_flutes, depth) = (v.count(6, 12) as f32, v.pick(&[0.0, 0.0, 0.04]));
    lathed(&shell(&outer, 0.005, 0.01))
        .painted(|p, n| decor.at(p, n, h))
        .warped(|p| {
            let k = 1.0 + depth * (azimuth(&p) * n_flutes * std::f32::consts::TAU).cos();
            Point3::new(p.x * k, p.y * k, p.z)
        })
        .with_surface(GLAZED)
}

pub(crate) fn flowerpot(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.05, 0.07), v.between(0.09, 0.13));
    let (foot, band) = (r * v.between(0.62, 0.72), h * v.between(0.2, 0.28));
    let below = foot + (r - foot) * 0.85;
    let outer = polyline(&[
        (0.0, 0.0),
        (foot, 0.0),
        (below, h - band),
        (r, h - band),
        (r * 1.04, h),
    ]);
    let clay = v.color(&[
        [190, 100, 62],
        [176, 88, 54],
        [204, 122, 84],
        [120, 110, 104],
    ]);
    let (soil, accent, seed) = ([64, 46, 34], contrasting(clay), v.seed());
    let is_banded = v.with_probability(0.4);
    let pot = lathed(&outer_wall(&outer, r)).painted(|p, _| {
        let color = if is_banded && p.z > h - band {
            mix(clay, accent, 0.35)
        } else {
            clay
        };
        speckled(p, (color, shaded(color, 0.85)), 0.012, 0.35, seed)
    });
    let earth = lathed(&polyline(&[
        (0.0, h - 0.03),
        (below * 0.9, h - 0.03),
        (r * 0.92, h - 0.014),
        (0.0, h - 0.012),
    ]));
    pot.joined(earth.painted(|p, _| speckled(p, (soil, [96, 74, 56]), 0.004, 0.3, seed)))
}

/// Wall profile of a flowerpot with a straight inner side, since the band outside has a step.
fn outer_wall(outer: &[nalgebra::Point2<f32>], r: f32) -> Vec<nalgebra::Point2<f32>> {
    let (foot, rim) = (outer[1].x, outer[outer.len() - 1]);
    let mut profile = outer.to_vec();
    profile.extend(polyline(&[
        (rim.x - 0.1 * r, rim.y),
        (foot * 0.86, 0.012),
        (0.0, 0.012),
    ]));
    profile
}
