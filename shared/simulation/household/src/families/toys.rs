//! Families of toys.

use crate::finish::{PLASTIC, RUBBER};
use crate::palette::{BLACK, METALS, PLASTICS, Rgb, WHITE, WOODS, mix, shaded};
use crate::pattern::{mottled, noise, radius};
use crate::profile::{cylinder, lathed, polyline, rounded, rounded_outline};
use crate::variation::Variation;
use mesh::{Solid, ellipsoid, extrude, rounded_box, superellipsoid};
use nalgebra::{Point2, Point3, Vector3};
use std::f32::consts::{FRAC_PI_2, PI};

pub(crate) fn puzzle_cube(v: &mut Variation) -> Solid {
    let (side, n) = (v.between(0.05, 0.066), v.pick(&[3_usize, 3, 3, 2, 4]));
    let body = v.color(&[BLACK, BLACK, WHITE]);
    let faces: [Rgb; 6] = [
        [196, 28, 40],
        [240, 110, 20],
        [244, 244, 240],
        [250, 214, 30],
        [24, 84, 180],
        [20, 150, 70],
    ];
    let mixed = v.with_probability(0.7);
    let core = rounded_box([side, side, side], side * 0.04, 0.02).colored(body);
    let cell = side * 0.97 / n as f32;
    let mut stickers = Solid::default();
    for (axis, sign) in [
        (0, 1.0),
        (0, -1.0),
        (1, 1.0),
        (1, -1.0),
        (2, 1.0),
        (2, -1.0_f32),
    ] {
        for i in 0..n * n {
            let own = axis * 2 + usize::from(sign < 0.0);
            let color = if mixed { v.pick(&faces) } else { faces[own] };
            let mut sides = [cell * 0.84; 3];
            sides[axis] = 0.0016;
            let at = |k: usize| (k as f32 - (n as f32 - 1.0) / 2.0) * cell;
            let mut place = [0.0; 3];
            (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) =
                (sign * side / 2.0, at(i % n), at(i / n));
            let sticker = rounded_box(sides, 0.0, 0.02).colored(color);
            stickers = stickers.joined(sticker.moved(place[0], place[1], place[2]));
        }
    }
    core.joined(stickers.decorative()).with_surface(PLASTIC)
}

/// Dimensions of a toy car, metres.
struct CarDimensions {
    x: f32,
    y: f32,
    h: f32,
    bonnet: f32,
    wheel: f32,
    /// Additional length of the roof, as a share of the car's length.
    roof: f32,
}

impl CarDimensions {
    /// Side view outline, extruded across the car.
    fn across(outline: &[Point2<f32>], depth: f32, bevel: f32) -> Solid {
        extrude(outline, depth, bevel)
            .rotated(Vector3::x(), FRAC_PI_2)
            .moved(0.0, depth / 2.0, 0.0)
    }

    fn body(&self) -> Solid {
        let Self {
            x, h, bonnet, roof, ..
        } = *self;
        let low = self.wheel * 0.7;
        let outline = [
            (-x / 2.0, low),
            (x / 2.0, low),
            (x / 2.0, bonnet * 0.85),
            (x * 0.24, bonnet),
            (x * (0.08 + roof), h),
            (-x * (0.24 + roof), h),
            (-x * 0.38, bonnet * 1.05),
            (-x / 2.0, bonnet),
        ];
        Self::across(&rounded_outline(&outline, 0.006), self.y, 0.003)
    }

    /// Windows on all sides, slightly outside of the cabin.
    fn windows(&self) -> Solid {
        let Self { x, y, roof, .. } = *self;
        let (top, sill) = (self.h * 0.93, self.bonnet * 1.12);
        let side = [
            (x * 0.19, sill),
            (x * (0.08 + roof) * 0.9, top),
            (-x * (0.22 + roof) * 0.96, top),
            (-x * 0.34, sill),
        ];
        let front = [
            (x * 0.235, sill),
            (x * (0.088 + roof), top),
            (-x * (0.246 + roof), top),
            (-x * 0.372, sill),
        ];
        let side = Self::across(&polyline(&side), y + 0.0012, 0.0003);
        let front = Self::across(&polyline(&front), y * 0.78, 0.0003);
        side.joined(front.moved(0.0012, 0.0, 0.0))
    }

    fn tyre(&self, i: usize) -> Solid {
        let side = |bit: usize| if i & bit == 0 { 1.0 } else { -1.0 };
        let (r, hub) = (self.wheel, self.wheel * 0.55);
        let profile = [(0.0, -0.005), (r, -0.005), (r, 0.005), (0.0, 0.005)];
        lathed(&rounded(&profile, 0.0015))
            .painted(|p, _| if radius(p) < hub { METALS[1] } else { BLACK })
            .rotated(Vector3::x(), FRAC_PI_2)
            .moved(side(1) * self.x * 0.31, side(2) * (self.y / 2.0 - 0.002), r)
    }
}

pub(crate) fn toy_car(v: &mut Variation) -> Solid {
    let [x, y, h] = v.each_between([(0.085, 0.13), (0.042, 0.055), (0.034, 0.048)]);
    let car = CarDimensions {
        x,
        y,
        h,
        bonnet: h * v.between(0.5, 0.6),
        wheel: h * v.between(0.24, 0.3),
        roof: v.between(0.0, 0.12),
    };
    let body = car.body().colored(v.color(&PLASTICS));
    let windows = car
        .windows()
        .colored(v.color(&[[60, 80, 100], [40, 44, 52]]));
    let wheels: Solid = (0..4).map(|i| car.tyre(i)).collect();
    let lamp = |side: f32| {
        ellipsoid([0.003, 0.005, 0.004], 12)
            .moved(x / 2.0, side * y * 0.32, car.bonnet * 0.68)
            .colored([250, 240, 180])
    };
    let mut details = windows.joined(lamp(1.0)).joined(lamp(-1.0));
    if v.with_probability(0.5) {
        let stripe = rounded_box([x * 0.24, y * 0.3, 0.002], 0.0008, 0.02);
        details = details.joined(stripe.moved(-x * 0.08, 0.0, h).colored(v.color(&PLASTICS)));
    }
    body.joined(wheels)
        .joined(details.decorative())
        .with_surface(PLASTIC)
}

pub(crate) fn toy_duck(v: &mut Variation) -> Solid {
    let s = v.between(0.8, 1.15);
    let color = v.color(&[
        [250, 212, 40],
        [250, 212, 40],
        [244, 226, 90],
        PLASTICS[7],
        PLASTICS[6],
    ]);
    let (beak, look) = (
        v.color(&[[236, 110, 30], [214, 60, 40]]),
        v.between(-0.5, 0.5),
    );
    let body = superellipsoid([0.042 * s, 0.032 * s, 0.026 * s], 0.9, 1.0, 40)
        .warped(|p| Point3::new(p.x, p.y * (1.0 + 4.0 * p.x), p.z))
        .moved(0.0, 0.0, 0.026 * s);
    // The tail points up.
    let tail = ellipsoid([0.02 * s, 0.016 * s, 0.0085 * s], 24)
        .rotated(Vector3::y(), 0.6)
        .moved(-0.032 * s, 0.0, 0.038 * s);
    let body = body.joined(tail);
    let wing = |side: f32| {
        ellipsoid([0.02 * s, 0.006 * s, 0.011 * s], 20)
            .rotated(Vector3::y(), 0.3)
            .moved(-0.006 * s, side * 0.03 * s, 0.032 * s)
    };
    let r = 0.022 * s;
    let eye = |side: f32| {
        ellipsoid([0.0035 * s, 0.0035 * s, 0.0045 * s], 12)
            .moved(0.0165 * s, side * 0.011 * s, 0.008 * s)
            .colored(BLACK)
            .decorative()
    };
    let bill = superellipsoid([0.013 * s, 0.011 * s, 0.0045 * s], 0.9, 0.9, 20)
        .moved(0.026 * s, 0.0, -0.002 * s)
        .colored(beak);
    let head = ellipsoid([r, r, r], 32)
        .colored(color)
        .joined(eye(1.0))
        .joined(eye(-1.0))
        .joined(bill);
    let head = head
        .rotated(Vector3::z(), look)
        .moved(0.02 * s, 0.0, 0.064 * s);
    let shadow = shaded(color, 0.9);
    let wings = wing(1.0).joined(wing(-1.0)).colored(shadow);
    body.colored(color)
        .joined(wings)
        .joined(head)
        .with_surface(PLASTIC)
}

pub(crate) fn toy_brick(v: &mut Variation) -> Solid {
    let (n_x, n_y) = v.pick(&[(2_usize, 2_usize), (4, 2), (3, 2), (4, 2)]);
    let pitch = v.between(0.0155, 0.0165);
    let (h, color) = (pitch * v.pick(&[1.2, 1.2, 0.6]), v.color(&PLASTICS[..5]));
    let (x, y) = (n_x as f32 * pitch, n_y as f32 * pitch);
    let block = rounded_box([x, y, h], 0.0006, 0.01).moved(0.0, 0.0, h / 2.0);
    let stud = |i: usize| {
        let at = |k: usize, n: usize| (k as f32 - (n as f32 - 1.0) / 2.0) * pitch;
        cylinder(pitch * 0.31, pitch * 0.24, 0.0005).moved(
            at(i % n_x, n_x),
            at(i / n_x, n_y),
            h - 0.0005,
        )
    };
    let studs: Solid = (0..n_x * n_y).map(stud).collect();
    block.joined(studs).colored(color).with_surface(PLASTIC)
}

pub(crate) fn dice(v: &mut Variation) -> Solid {
    let s = v.between(0.028, 0.045);
    let (body, dot) = v.pick(&[
        (WHITE, BLACK),
        (PLASTICS[0], WHITE),
        (BLACK, WHITE),
        (PLASTICS[1], WHITE),
        ([236, 222, 190], [60, 40, 30]),
    ]);
    let body = v.color(&[body]);
    let cube = rounded_box([s, s, s], s * v.between(0.1, 0.18), 0.01).colored(body);
    let spots: [&[(f32, f32)]; 6] = [
        &[(0.0, 0.0)],
        &[(-1.0, -1.0), (1.0, 1.0)],
        &[(-1.0, 1.0), (0.0, 0.0), (1.0, -1.0)],
        &[(-1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (1.0, -1.0)],
        &[
            (-1.0, -1.0),
            (1.0, 1.0),
            (-1.0, 1.0),
            (1.0, -1.0),
            (0.0, 0.0),
        ],
        &[
            (-1.0, -1.0),
            (1.0, 1.0),
            (-1.0, 1.0),
            (1.0, -1.0),
            (-1.0, 0.0),
            (1.0, 0.0),
        ],
    ];
    let spot = |face: usize, (a, b): (f32, f32)| {
        let axis = face % 3;
        let sign = if face < 3 { 1.0 } else { -1.0 };
        let mut place = [0.0; 3];
        (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) =
            (sign * s * 0.495, a * s * 0.24, b * s * 0.24);
        let mut half = [s * 0.09; 3];
        half[axis] = s * 0.014;
        ellipsoid(half, 14)
            .moved(place[0], place[1], place[2])
            .colored(dot)
    };
    // Opposite faces sum to seven.
    let number = |face: usize| if face < 3 { face } else { 8 - face };
    let dots: Solid = (0..6)
        .flat_map(|face| spots[number(face)].iter().map(move |&at| (face, at)))
        .map(|(face, at)| spot(face, at))
        .collect();
    cube.joined(dots.decorative()).with_surface(PLASTIC)
}

pub(crate) fn teddy(v: &mut Variation) -> Solid {
    let s = v.between(0.85, 1.2);
    let fur = v.color(&[
        [168, 116, 66],
        [120, 78, 44],
        [206, 168, 120],
        [226, 220, 210],
        PLASTICS[7],
    ]);
    let (seed, pale, bow) = (v.seed(), mix(fur, WHITE, 0.45), v.color(&PLASTICS));
    let ball = |size: [f32; 3], at: [f32; 3], color: Rgb| {
        ellipsoid(
            size.map(|x| x * s),
            (600.0 * size[2].max(size[0])) as usize + 8,
        )
        .painted(move |p, _| shaded(color, 0.82 + 0.3 * noise(p, 0.003, seed)))
        .moved(at[0] * s, at[1] * s, at[2] * s)
    };
    // It sits, looking along x.
    let mut parts = vec![
        ball([0.034, 0.038, 0.044], [0.0, 0.0, 0.036], fur),
        ball([0.032, 0.035, 0.031], [0.006, 0.0, 0.108], fur),
        ball([0.014, 0.016, 0.012], [0.034, 0.0, 0.1], pale),
        ball([0.008, 0.026, 0.03], [0.029, 0.0, 0.042], pale).decorative(),
        ball([0.004, 0.006, 0.004], [0.047, 0.0, 0.104], BLACK).decorative(),
        ball([0.006, 0.013, 0.005], [0.027, 0.0, 0.079], bow).decorative(),
    ];
    for side in [-1.0, 1.0_f32] {
        parts.push(ball(
            [0.007, 0.013, 0.013],
            [0.002, side * 0.027, 0.133],
            fur,
        ));
        parts.push(ball(
            [0.031, 0.016, 0.016],
            [0.038, side * 0.028, 0.013],
            fur,
        ));
        parts.push(ball([0.006, 0.014, 0.014], [0.067, side * 0.028, 0.017], pale).decorative());
        parts.push(ball(
            [0.014, 0.014, 0.03],
            [0.014, side * 0.044, 0.054],
            fur,
        ));
        parts.push(ball([0.003, 0.003, 0.003], [0.036, side * 0.012, 0.117], BLACK).decorative());
    }
    // The teddy's weight has flattened the side it sits on.
    let flattened = |p: Point3<f32>| Point3::new(p.x, p.y, p.z.max(0.02 * p.z));
    let teddy: Solid = parts.into_iter().collect();
    teddy.warped(flattened).with_surface(RUBBER)
}

pub(crate) fn toy_bridge(v: &mut Variation) -> Solid {
    let (x, h) = (v.between(0.08, 0.105), v.between(0.036, 0.046));
    let (depth, span) = (v.between(0.03, 0.042), v.between(0.26, 0.31) * x);
    let (base, is_plain, seed) = (v.color(&PLASTICS[..7]), v.with_probability(0.3), v.seed());
    let base = if is_plain { v.color(&WOODS) } else { base };
    let arch = (0..=12).map(|i| (i as f32 / 12.0 * PI).sin_cos());
    let mut points = vec![(-x / 2.0, 0.0)];
    points.extend(arch.map(|(sin, cos)| (-span * cos, span.min(0.75 * h) * sin)));
    points.extend([(x / 2.0, 0.0), (x / 2.0, h), (-x / 2.0, h)]);
    extrude(&polyline(&points), depth, 0.0012)
        .rotated(Vector3::x(), FRAC_PI_2)
        .painted(|p, _| mottled(&Point3::new(p.x * 0.2, p.y, p.z), base, 0.004, 0.12, seed))
}
