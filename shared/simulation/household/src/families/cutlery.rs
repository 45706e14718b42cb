//! Families of cutlery and kitchen utensils, lying along x.

use crate::finish::{PLASTIC, POLISHED};
use crate::palette::{BLACK, METALS, PLASTICS, Rgb, WOODS};
use crate::pattern::wood;
use crate::profile::{cylinder, lathed, polyline, rounded, rounded_outline, shell, subdivided};
use crate::sweep::{interpolate, lying, resting_on_two_points, rod, swept};
use crate::variation::Variation;
use mesh::{Solid, extrude, rounded_box};
use nalgebra::{Point3, Vector3};

/// Thickness of a knife blade, metres.
const BLADE_M: f32 = 0.0024;

/// Materials of a piece of cutlery.
struct CutleryMaterial {
    metal: Rgb,
    grip: Rgb,
}

impl CutleryMaterial {
    fn new(v: &mut Variation) -> Self {
        let metal = v.color(&METALS);
        let is_plain = v.with_probability(0.55);
        let grip = v.color(&[PLASTICS[0], PLASTICS[1], BLACK, WOODS[1], PLASTICS[3]]);
        Self {
            metal,
            grip: if is_plain { metal } else { grip },
        }
    }

    /// Handle from x = −length to 0, wider at its end.
    fn handle(&self, v: &mut Variation, length: f32) -> Solid {
        let (neck, end) = (v.between(0.0028, 0.0036), v.between(0.0075, 0.0105));
        let bulge = v.between(0.45, 0.8);
        let width = [end * 0.9, end, end * bulge, neck * 1.3, neck];
        let (metal, grip, edge) = (self.metal, self.grip, -0.3 * length);
        let lift = v.between(0.006, 0.012);
        let points = [
            [-length, 0.0, 0.004],
            [-0.6 * length, 0.0, 0.003 + lift],
            [-0.25 * length, 0.0, 0.004 + lift],
            [0.004, 0.0, 0.006],
        ];
        let has_grip = metal != grip;
        let height = if has_grip { 0.0038 } else { 0.0022 };
        swept(&points, Vector3::z(), |t| {
            (
                interpolate(&width, t),
                if t < 0.7 { height } else { 0.0021 },
            )
        })
        .painted(|p, _| if p.x < edge { grip } else { metal })
    }
}

pub(crate) fn spoon(v: &mut Variation) -> Solid {
    let ware = CutleryMaterial::new(v);
    let (length, half) = (v.between(0.1, 0.135), v.between(0.0165, 0.021));
    let (stretch, depth) = (v.between(1.4, 1.65), v.between(0.009, 0.012));
    let outer = polyline(&[
        (0.0, 0.0),
        (0.35, 0.08),
        (0.7, 0.36),
        (0.92, 0.75),
        (1.0, 1.0),
    ]);
    let outer: Vec<_> = outer
        .iter()
        .map(|p| nalgebra::Point2::new(p.x * half, p.y * depth))
        .collect();
    let bowl = lathed(&shell(&outer, 0.0022, 0.0022))
        .colored(ware.metal)
        .warped(|p| {
            // Pointed towards the tip.
            let taper = 1.0 - 0.18 * p.x / half;
            Point3::new(p.x * stretch, p.y * taper, p.z)
        });
    let bowl = bowl.moved(half * stretch - 0.003, 0.0, 0.0);
    let handle = ware.handle(v, length).moved(0.0, 0.0, depth - 0.007);
    bowl.joined(handle).with_surface(POLISHED)
}

pub(crate) fn fork(v: &mut Variation) -> Solid {
    let ware = CutleryMaterial::new(v);
    let length = v.between(0.105, 0.135);
    let (n_tines, w) = (v.pick(&[3_usize, 4, 4]), v.between(0.0105, 0.0135));
    let (root, tip) = (v.between(0.024, 0.03), v.between(0.07, 0.08));
    let gap = 2.0 * w / (n_tines as f32 * 1.7 - 0.7) * 0.7;
    let tine = gap / 0.7;
    let mut points = vec![(0.0, 0.003), (0.0, -0.003), (0.012, -w * 0.8), (root, -w)];
    for i in 0..n_tines {
        let low = -w + i as f32 * (tine + gap);
        points.extend([(tip, low + 0.25 * tine), (tip, low + 0.75 * tine)]);
        points.extend([(root + 0.004, low + tine), (root + 0.004, low + tine + gap)]);
    }
    points.truncate(points.len() - 2);
    points.extend([(root, w), (0.012, w * 0.8)]);
    points.push((0.0, 0.003));
    let outline = subdivided(&polyline(&points), 0.008);
    let dip = v.between(0.005, 0.008);
    let head = extrude(&outline[..outline.len() - 1], 0.0022, 0.0004)
        .colored(ware.metal)
        .warped(|p| {
            let t = p.x / tip;
            Point3::new(p.x, p.y, p.z + dip * (4.0 * (t - 0.5) * (t - 0.5)))
        });
    let handle = ware.handle(v, length).moved(0.0, 0.0, dip - 0.005);
    head.joined(handle).with_surface(POLISHED)
}

pub(crate) fn knife(v: &mut Variation) -> Solid {
    let (length, w) = (v.between(0.095, 0.15), v.between(0.009, 0.0145));
    let (metal, grip_length) = (v.color(&METALS), v.between(0.085, 0.11));
    let colors = [
        BLACK,
        WOODS[1],
        WOODS[2],
        PLASTICS[0],
        PLASTICS[1],
        METALS[2],
    ];
    let (grip, seed) = (v.color(&colors), v.seed());
    let (is_round, is_wood) = (v.with_probability(0.4), v.with_probability(0.5));
    let blade = blade(length, w, is_round)
        .colored(metal)
        .with_surface(POLISHED);
    let height = v.between(0.008, 0.0105);
    let widths = [1.15, 1.1, 0.9, 1.0, 1.05].map(|share| share * height);
    let at = |x: f32| [x, 0.0, BLADE_M / 2.0];
    let points = [at(-grip_length), at(-grip_length / 2.0), at(0.0)];
    let handle = swept(&points, Vector3::z(), |t| (interpolate(&widths, t), 0.0075))
        .painted(|p, _| if is_wood { wood(p, grip, seed) } else { grip })
        .with_surface(PLASTIC);
    let rivet = |x: f32| cylinder(0.0024, 0.0165, 0.0004).moved(-x * grip_length, 0.0, -0.007);
    let rivets: Solid = [0.25, 0.7].into_iter().map(rivet).collect();
    blade
        .joined(handle)
        .joined(rivets.colored(metal).decorative())
}

/// Knife blade along x, with a round end or a point.
fn blade(length: f32, w: f32, is_round: bool) -> Solid {
    let mut points = vec![
        (-0.004, w),
        (-0.004, -w * 0.9),
        (length * 0.5, -w),
        (length * 0.8, -w * 0.7),
        (length * 0.94, -w * 0.1),
        (length, w * if is_round { 0.2 } else { 0.8 }),
    ];
    if is_round {
        points.push((length * 0.9, w));
    }
    let outline = subdivided(&rounded_outline(&points, 0.006), 0.01);
    extrude(&outline, BLADE_M, 0.0004).warped(|p| {
        // The cutting edge is the thin side.
        let share = (p.y / w * 0.5 + 0.5).clamp(0.0, 1.0);
        let middle = BLADE_M / 2.0;
        Point3::new(p.x, p.y, middle + (p.z - middle) * (0.35 + 0.65 * share))
    })
}

pub(crate) fn spatula(v: &mut Variation) -> Solid {
    let (length, w) = (v.between(0.15, 0.19), v.between(0.032, 0.042));
    let head = v.color(&[BLACK, METALS[0], PLASTICS[0], PLASTICS[3], WOODS[0]]);
    let (grip, seed) = (
        v.color(&[BLACK, WOODS[1], PLASTICS[0], PLASTICS[1]]),
        v.seed(),
    );
    let flat = slotted(v.between(0.085, 0.105), w, v.count(2, 4)).colored(head);
    let rise = v.between(0.1, 0.22) * length;
    let points = [
        [-0.01, 0.0, 0.0],
        [-0.04, 0.0, rise * 0.4],
        [-length * 0.6, 0.0, rise * 0.85],
        [-length, 0.0, rise],
    ];
    let (widths, heights) = ([0.006, 0.005, 0.009, 0.011], [0.003, 0.004, 0.006, 0.007]);
    let edge = if v.with_probability(0.5) {
        -0.03
    } else {
        -0.45 * length
    };
    let handle = swept(&points, Vector3::z(), |t| {
        (interpolate(&widths, t), interpolate(&heights, t))
    });
    let handle = handle.painted(|p, _| {
        if p.x < edge {
            wood(p, grip, seed)
        } else {
            head
        }
    });
    flat.joined(handle).with_surface(PLASTIC)
}

/// Flat blade of half width `w`: bars between slots, closed by a root and an edge.
fn slotted(length: f32, w: f32, n_slots: usize) -> Solid {
    let gap = w * 0.9 / n_slots as f32;
    let width = (2.0 * w - n_slots as f32 * gap) / (n_slots + 1) as f32;
    let bar = |i: usize| {
        let y = -w + width / 2.0 + i as f32 * (width + gap);
        rounded_box([length, width, 0.003], 0.0012, 0.02).moved(length / 2.0, y, 0.0)
    };
    let bars: Solid = (0..=n_slots).map(bar).collect();
    let root = [
        (-0.02, -0.006),
        (0.02, -w),
        (0.026, -w),
        (0.026, w),
        (0.02, w),
        (-0.02, 0.006),
    ];
    let root = extrude(&rounded_outline(&root, 0.006), 0.003, 0.0005).moved(0.0, 0.0, -0.0015);
    let edge = rounded_box([0.02, 2.0 * w, 0.0032], 0.0012, 0.02).moved(length - 0.006, 0.0, 0.0);
    bars.joined(root).joined(edge)
}

pub(crate) fn ladle(v: &mut Variation) -> Solid {
    let (r, length) = (v.between(0.03, 0.039), v.between(0.17, 0.22));
    let (metal, is_plain) = (
        v.color(&[METALS[0], METALS[2], BLACK, PLASTICS[0], WOODS[1]]),
        v.with_probability(0.4),
    );
    let grip = if is_plain {
        metal
    } else {
        v.color(&[BLACK, PLASTICS[0], PLASTICS[1], WOODS[2]])
    };
    let depth = r * v.between(0.72, 0.9);
    let outer = crate::profile::spline(
        &[
            (0.0, 0.0),
            (r * 0.55, depth * 0.13),
            (r * 0.92, depth * 0.55),
            (r, depth),
        ],
        5,
    );
    let bowl = lathed(&shell(&outer, 0.0025, 0.0025)).colored(metal);
    // The handle rises from the rim and leans back.
    let rise = v.between(0.05, 0.08);
    let handle = swept(
        &[
            [-r + 0.002, 0.0, depth - 0.005],
            [-r - 0.012, 0.0, depth + 0.02],
            [-r - 0.3 * length, 0.0, depth + 0.6 * rise],
            [-r - 0.75 * length, 0.0, depth + rise],
            [-r - length, 0.0, depth + rise * 0.95],
        ],
        Vector3::z(),
        |t| {
            (
                interpolate(&[0.006, 0.005, 0.006, 0.009, 0.009], t),
                interpolate(&[0.003, 0.003, 0.003, 0.005], t),
            )
        },
    );
    let edge = -r - v.between(0.4, 0.6) * length;
    let handle = handle.painted(|p, _| if p.x < edge { grip } else { metal });
    // Bowl and end of the handle touch the table.
    let tilt = (depth + rise - 0.006).atan2(r + length) * 0.96;
    bowl.joined(handle)
        .rotated(Vector3::y(), -tilt)
        .with_surface(POLISHED)
}

pub(crate) fn whisk(v: &mut Variation) -> Solid {
    let [length, balloon, r] = v.each_between([(0.1, 0.13), (0.12, 0.15), (0.026, 0.034)]);
    let (metal, grip) = (
        v.color(&METALS),
        v.color(&[METALS[2], BLACK, PLASTICS[0], PLASTICS[1], WOODS[1]]),
    );
    let n = v.count(4, 5);
    let thickness = v.between(0.0011, 0.0015);
    let wire = |i: usize| {
        let loop_ = [
            [-0.005, 0.0, 0.004],
            [balloon * 0.35, 0.0, r * 0.62],
            [balloon * 0.72, 0.0, r],
            [balloon * 0.95, 0.0, r * 0.6],
            [balloon, 0.0, 0.0],
            [balloon * 0.95, 0.0, -r * 0.6],
            [balloon * 0.72, 0.0, -r],
            [balloon * 0.35, 0.0, -r * 0.62],
            [-0.005, 0.0, -0.004],
        ];
        // Two wires are below, side by side.
        let angle = (i as f32 + 0.5) / n as f32 * std::f32::consts::PI;
        rod(&loop_, thickness).rotated(Vector3::x(), angle)
    };
    let wires: Solid = (0..n).map(wire).collect();
    let wires = wires
        .with_convex_hull()
        .colored(metal)
        .with_surface(POLISHED);
    let w = v.between(0.01, 0.013);
    let profile = rounded(
        &[
            (0.0, -length),
            (w * 0.8, -length),
            (w, -length * 0.7),
            (w * 0.75, -length * 0.2),
            (w * 0.9, 0.006),
            (0.0, 0.006),
        ],
        0.005,
    );
    let handle = lying(lathed(&profile)).colored(grip).with_surface(PLASTIC);
    resting_on_two_points(wires.joined(handle))
}
