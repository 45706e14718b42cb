//! Families of containers: bottles, cans, jars, dispensers.

use crate::finish::{BRUSHED, GLAZED, PLASTIC, POLISHED};
use crate::palette::{BLACK, BRASS, METALS, PASTELS, PLASTICS, STEEL, WHITE, mix, shaded};
use crate::pattern::{PrintedLabel, azimuth, is_stripe, radius};
use crate::profile::{cylinder, lathed, lathed_for_print, polyline, rounded, spline};
use crate::sweep::{rod, vessel_handle};
use crate::variation::Variation;
use mesh::{Solid, ellipsoid, rounded_box};
use nalgebra::{Point3, Vector3};

pub(crate) fn bottle(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.032, 0.041), v.between(0.24, 0.31));
    let (neck, shoulder) = (v.between(0.012, 0.015), h * v.between(0.52, 0.62));
    let throat = shoulder + h * v.between(0.12, 0.22);
    let glass = v.color(&[
        [38, 70, 42],
        [92, 56, 28],
        [40, 60, 92],
        [170, 180, 120],
        [150, 190, 205],
        [60, 26, 34],
    ]);
    let (print, cap) = (PrintedLabel::new(v, &PASTELS), v.color(&PLASTICS));
    let mut profile = rounded(&[(0.0, 0.0), (r, 0.0), (r, shoulder)], 0.006);
    profile.extend(spline(
        &[
            (r, shoulder + 0.002),
            (neck + 0.3 * (r - neck), shoulder.midpoint(throat) + 0.01),
            (neck, throat),
        ],
        6,
    ));
    profile.extend(polyline(&[
        (neck, h - 0.03),
        (neck + 0.002, h - 0.03),
        (neck + 0.002, h),
        (0.0, h),
    ]));
    let label = (h * v.between(0.1, 0.14), h * v.between(0.42, 0.48));
    let foil = h - v.between(0.028, 0.06);
    lathed_for_print(&profile)
        .painted(|p, _| match p.z {
            z if z > foil => cap,
            z if z > label.0 && z < label.1 => print.wrapped(p, label.0, label.1),
            _ => glass,
        })
        .with_surface(GLAZED)
}

pub(crate) fn soda_can(v: &mut Variation) -> Solid {
    let (r, h) = v.pick(&[
        (0.033, 0.116),
        (0.0265, 0.134),
        (0.033, 0.15),
        (0.0285, 0.146),
    ]);
    let (r, h) = (r * v.between(0.98, 1.02), h * v.between(0.98, 1.02));
    let (print, stripe) = (PrintedLabel::new(v, &PLASTICS), v.color(&PLASTICS));
    let (is_wave, phase) = (v.with_probability(0.5), v.between(0.0, 1.0));
    let profile = polyline(&[
        (0.0, 0.006),
        (r * 0.7, 0.004),
        (r * 0.76, 0.0),
        (r, 0.01),
        (r, h - 0.014),
        (r * 0.82, h - 0.002),
        (r * 0.82, h),
        (r * 0.76, h),
        (r * 0.74, h - 0.005),
        (0.0, h - 0.005),
    ]);
    let can = lathed_for_print(&profile).painted(|p, _| {
        let wave = 0.5 * h + 0.22 * h * ((azimuth(p) * 2.0 + phase) * std::f32::consts::TAU).sin();
        match p.z {
            z if !(0.009..=h - 0.013).contains(&z) || radius(p) < 0.9 * r => STEEL,
            z if is_wave && (z - wave).abs() < 0.1 * h => stripe,
            _ => print.wrapped(p, 0.01, h - 0.014),
        }
    });
    let tab = rounded_box([0.022, 0.013, 0.0016], 0.0006, 0.01).moved(-0.005, 0.0, h - 0.0042);
    can.joined(tab.colored(shaded(STEEL, 0.85)).decorative())
        .with_surface(BRUSHED)
}

pub(crate) fn tin_can(v: &mut Variation) -> Solid {
    let (r, h) = v.pick(&[
        (0.0365, 0.11),
        (0.0425, 0.058),
        (0.0365, 0.06),
        (0.042, 0.12),
        (0.037, 0.085),
    ]);
    let r = r * v.between(0.95, 1.05);
    let print = PrintedLabel::new(v, &PLASTICS);
    let (is_bare, metal) = (v.with_probability(0.2), v.color(&METALS));
    let mut points = vec![
        (0.0, 0.003),
        (r * 0.93, 0.003),
        (r * 0.94, 0.0),
        (r * 1.02, 0.0),
        (r * 1.02, 0.003),
    ];
    // Circumferential beads that stiffen the wall.
    let n = (h / 0.006) as usize;
    points.extend((0..=n).map(|i| {
        (
            r * (1.0 - 0.022 * (i % 2) as f32),
            0.005 + (h - 0.01) * i as f32 / n as f32,
        )
    }));
    points.extend([
        (r * 1.02, h - 0.003),
        (r * 1.02, h),
        (r * 0.94, h),
        (r * 0.93, h - 0.003),
        (0.0, h - 0.003),
    ]);
    lathed_for_print(&polyline(&points))
        .painted(|p, _| {
            let on_label = !is_bare && (0.006..h - 0.006).contains(&p.z) && radius(p) > 0.95 * r;
            if on_label {
                print.wrapped(p, 0.005, h - 0.005)
            } else {
                metal
            }
        })
        .with_surface(BRUSHED)
}

pub(crate) fn jar(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.032, 0.043), v.between(0.085, 0.13));
    let neck = r * v.between(0.78, 0.9);
    let content = v.color(&[
        [150, 30, 38],
        [214, 120, 24],
        [236, 196, 70],
        [110, 60, 30],
        [90, 120, 50],
        [80, 30, 80],
    ]);
    let (print, lid) = (
        PrintedLabel::new(v, &PASTELS),
        v.color(&[PLASTICS[0], WHITE, BRASS, PLASTICS[3], BLACK]),
    );
    let top = h - 0.018;
    let profile = rounded(
        &[
            (0.0, 0.0),
            (r, 0.0),
            (r, top - 0.014),
            (neck, top - 0.002),
            (neck, top + 0.002),
            (0.0, top + 0.002),
        ],
        0.008,
    );
    let (low, high) = (h * 0.2, h * 0.62);
    let glass = lathed_for_print(&profile).painted(|p, _| {
        // The label covers three quarters of the circumference.
        let on_label = p.z > low && p.z < high && azimuth(p) < 0.75;
        if on_label {
            print.wrapped(p, low, high)
        } else {
            content
        }
    });
    let is_checked = v.with_probability(0.3);
    let cap = cylinder(neck * 1.08, 0.016, 0.003).painted(|p, _| {
        let is_white =
            is_checked && is_stripe(p.x / 0.02 + 50.0, 1) != is_stripe(p.y / 0.02 + 50.0, 1);
        if is_white { WHITE } else { lid }
    });
    glass
        .joined(cap.moved(0.0, 0.0, h - 0.016))
        .with_surface(GLAZED)
}

pub(crate) fn shampoo(v: &mut Variation) -> Solid {
    let [w, d, h] = v.each_between([(0.03, 0.037), (0.55, 0.72), (0.15, 0.2)]);
    let (print, cap) = (PrintedLabel::new(v, &PLASTICS), v.color(&PLASTICS));
    let waist = w * v.between(0.85, 1.0);
    let mut profile = polyline(&[(0.0, 0.0), (w * 0.9, 0.0)]);
    profile.extend(spline(
        &[
            (w * 0.96, 0.004),
            (w, h * 0.15),
            (waist, h * 0.5),
            (w, h * 0.78),
            (w * 0.4, h * 0.96),
        ],
        5,
    ));
    profile.extend(polyline(&[(0.0, h * 0.97)]));
    let (low, high) = (h * 0.15, h * 0.82);
    let body = lathed_for_print(&profile)
        .stretched(1.0, d, 1.0)
        .painted(|p, n| {
            let u = p.x / (1.7 * w) + 0.5;
            let on_label = n.y.abs() > 0.3 && (low..high).contains(&p.z) && (0.0..1.0).contains(&u);
            if on_label {
                print.at(
                    if n.y < 0.0 { u } else { 1.0 - u },
                    (p.z - low) / (high - low),
                )
            } else {
                print.ground
            }
        });
    let top = if v.with_probability(0.5) {
        cylinder(w * 0.55, h * 0.14, 0.004).moved(0.0, 0.0, h * 0.93)
    } else {
        // A pump: a stalk and a spout to one side.
        let stalk = cylinder(0.006, h * 0.2, 0.001).joined(cylinder(w * 0.45, 0.022, 0.004));
        let spout = rod(
            &[
                [0.004, 0.0, h * 0.2],
                [-0.02, 0.0, h * 0.2],
                [-0.042, 0.0, h * 0.18],
            ],
            0.0055,
        );
        stalk.joined(spout).moved(0.0, 0.0, h * 0.94)
    };
    body.joined(top.colored(cap)).with_surface(PLASTIC)
}

pub(crate) fn spray_bottle(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.036, 0.043), v.between(0.15, 0.18));
    let (print, head) = (
        PrintedLabel::new(v, &PLASTICS),
        v.color(&[WHITE, PLASTICS[0], PLASTICS[1], BLACK]),
    );
    let trigger = v.color(&PLASTICS);
    let waist = r * v.between(0.75, 0.9);
    let mut profile = polyline(&[(0.0, 0.0), (r * 0.95, 0.0)]);
    profile.extend(spline(
        &[
            (r, 0.004),
            (r, h * 0.42),
            (waist, h * 0.62),
            (0.014, h * 0.97),
        ],
        6,
    ));
    profile.extend(polyline(&[(0.013, h + 0.004), (0.0, h + 0.004)]));
    let (low, high) = (h * 0.08, h * 0.5);
    let body = lathed_for_print(&profile)
        .stretched(1.0, 0.72, 1.0)
        .painted(|p, _| {
            if p.z > low && p.z < high {
                print.wrapped(p, low, high)
            } else {
                print.ground
            }
        });
    let collar = cylinder(0.016, 0.018, 0.002).moved(0.0, 0.0, h - 0.002);
    let gun = rounded_box([0.075, 0.022, 0.026], 0.006, 0.01).moved(-0.012, 0.0, h + 0.032);
    let neck = rounded_box([0.03, 0.02, 0.03], 0.005, 0.01).moved(0.006, 0.0, h + 0.02);
    let nozzle = cylinder(0.008, 0.012, 0.001).rotated(Vector3::y(), -std::f32::consts::FRAC_PI_2);
    let lever = rod(
        &[
            [-0.02, 0.0, h + 0.022],
            [-0.03, 0.0, h + 0.002],
            [-0.026, 0.0, h - 0.02],
        ],
        0.005,
    );
    let fittings = collar.joined(gun).joined(neck).colored(head);
    let red = nozzle
        .moved(-0.048, 0.0, h + 0.034)
        .joined(lever)
        .colored(trigger);
    body.joined(fittings).joined(red).with_surface(PLASTIC)
}

pub(crate) fn salt_shaker(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.019, 0.025), v.between(0.07, 0.095));
    let waist = r * v.between(0.7, 0.95);
    let body = v.color(&[
        WHITE,
        [222, 226, 226],
        PLASTICS[0],
        PLASTICS[1],
        [70, 70, 74],
        [190, 150, 100],
    ]);
    let metal = v.color(&METALS);
    let cap = h * v.between(0.7, 0.76);
    let mut profile = polyline(&[(0.0, 0.0), (r * 0.96, 0.0)]);
    profile.extend(spline(
        &[(r, 0.002), (waist, cap * 0.75), (waist * 0.9, cap)],
        6,
    ));
    let lid = rounded(
        &[
            (waist, cap),
            (waist * 0.98, cap + 0.55 * (h - cap)),
            (waist * 0.75, h),
            (0.0, h),
        ],
        0.004,
    );
    profile.extend(lid);
    let (n_facets, depth) = (v.count(6, 9) as f32, v.pick(&[0.0, 0.035]));
    let shaker = lathed(&profile)
        .warped(|p| {
            let k = if p.z < cap - 0.003 { depth } else { 0.0 };
            let k = 1.0 - k * (azimuth(&p) * n_facets * std::f32::consts::TAU).cos();
            Point3::new(p.x * k, p.y * k, p.z)
        })
        .painted(|p, _| if p.z > cap - 0.001 { metal } else { body });
    let n = v.count(4, 7);
    // Holes are dark dots that stand out slightly.
    let hole = |i: usize| {
        let (sin, cos) = (i as f32 / n as f32 * std::f32::consts::TAU).sin_cos();
        let ring = if i == 0 { 0.0 } else { waist * 0.42 };
        ellipsoid([0.0018, 0.0018, 0.0008], 10).moved(cos * ring, sin * ring, h)
    };
    let holes: Solid = (0..n).map(hole).collect();
    shaker
        .joined(holes.colored(BLACK).decorative())
        .with_surface(GLAZED)
}

pub(crate) fn thermos(v: &mut Variation) -> Solid {
    let (r, h) = (v.between(0.034, 0.042), v.between(0.22, 0.28));
    let (body, metal) = (v.color(&PLASTICS), v.color(&METALS));
    let cup = h * v.between(0.72, 0.78);
    let (is_bright, n_bands) = (v.with_probability(0.5), v.count(1, 3));
    let profile = rounded(
        &[
            (0.0, 0.0),
            (r, 0.0),
            (r, cup - 0.004),
            (r * 0.9, cup),
            (r * 0.86, cup + 0.002),
            (r * 0.78, h),
            (0.0, h),
        ],
        0.005,
    );
    let color = |p: &Point3<f32>| {
        let share = p.z / cup;
        let in_band = (0..n_bands).any(|i| (share - 0.8 + 0.08 * i as f32).abs() < 0.02);
        match share {
            s if s > 1.0 => {
                if is_bright {
                    mix(body, BLACK, 0.5)
                } else {
                    metal
                }
            }
            s if s < 0.06 || in_band => metal,
            _ => body,
        }
    };
    let flask = lathed(&profile).painted(|p, _| color(p));
    // The cap is a cup with a handle.
    let ring = vessel_handle(&profile, (h - 0.012, cup + 0.01), 0.016, 0.006, 0.012).colored(metal);
    flask.joined(ring).with_surface(POLISHED)
}
