//! Groups of a crowded table: stacks, towers, bridges, containers, leaning objects.

use super::{ClutterPlanner, OrientedModel, PlannedSupport, Resting};
use crate::error::Error;
use crate::model_library::category_names;
use nalgebra::{UnitQuaternion, Vector2, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Flat objects that carry others.
const FLAT: [&str; 8] = [
    "book",
    "book",
    "magazine",
    "carton",
    "carton",
    "carton",
    "cereal-box",
    "cookie-tin",
];
/// Packets that stand on an edge or an end.
const PACKETS: [&str; 5] = ["carton", "carton", "cereal-box", "tissue-box", "juice-box"];
/// Objects that stand on others.
const TOPS: [&str; 14] = [
    "soda-can",
    "tin-can",
    "mug",
    "teacup",
    "jar",
    "carton",
    "carton",
    "juice-box",
    "bowl",
    "candle",
    "matchbox",
    "puzzle-cube",
    "milk-carton",
    "salt-shaker",
];
/// Objects that stand on the table by themselves.
const STANDING: [&str; 18] = [
    "carton",
    "carton",
    "cereal-box",
    "milk-carton",
    "juice-box",
    "tissue-box",
    "bottle",
    "shampoo",
    "spray-bottle",
    "thermos",
    "soda-can",
    "tin-can",
    "jar",
    "mug",
    "bowl",
    "teapot",
    "vase",
    "pencil-cup",
];
/// Containers without lid.
const CONTAINERS: [&str; 6] = ["bowl", "bowl", "open-box", "open-box", "pot", "tray"];
/// Objects in containers.
const CONTENTS: [&str; 14] = [
    "apple",
    "orange",
    "lemon",
    "egg",
    "tomato",
    "peach",
    "dice",
    "toy-brick",
    "matchbox",
    "marker",
    "toy-car",
    "sponge",
    "glue-stick",
    "tape-roll",
];
/// Greatest distance of an overhanging object's middle from the rim, as a share of its half side.
/// Chosen.
const OVERHANG_SHARE: f64 = 0.75;
/// Greatest distance of the crowd's centre from the rim at which objects overhang, metres. Chosen.
const OVERHANG_REACH_M: f64 = 0.5;
/// Steepness of leaning objects, radians: a ladder with a friction coefficient of 0.4 slips below
/// 0.81. Chosen.
const LEANING_RAD: [f64; 2] = [0.95, 1.35];

impl ClutterPlanner<'_> {
    /// Places groups until the scene is full.
    pub(super) fn place_groups(&mut self) -> Result<(), Error> {
        let rim_m = self.table.size_m[0] / 2.0 - self.centre_m.x.abs();
        let rim_m = rim_m.min(self.table.size_m[1] / 2.0 - self.centre_m.y.abs());
        if rim_m < OVERHANG_REACH_M && self.random.unit() < 0.7 {
            self.overhanging()?;
        }
        while !self.is_full() {
            match self.random.below(100) {
                0..30 => self.flat_stack()?,
                30..40 => self.equal_tower()?,
                40..47 => self.bridge()?,
                47..55 => self.vessel_tower()?,
                55..63 => self.filled_container()?,
                63..71 => self.leaning()?,
                71..79 => self.lying_across()?,
                79..83 => self.anything()?,
                _ => self.standing()?,
            }
        }
        Ok(())
    }

    /// Books and boxes on each other, turned or flush, with something standing on top.
    fn flat_stack(&mut self) -> Result<(), Error> {
        let base = self.generated(&FLAT, Resting::Flat)?;
        let radius_m = base.half_diagonal_m();
        let mut support = self.put_on_table(&base, radius_m);
        for _ in 0..self.random.below(3) {
            let least_m = support.object.short_half_side_m();
            let next = self.generated_within(&FLAT, Resting::Flat, 1.2 * least_m)?;
            let yaw_rad = self.yaw_on(&support, 0.4);
            support = self.put_on(&next, &support, yaw_rad, 0.3);
        }
        for _ in 0..self.random.below(3) {
            self.top(&support)?;
        }
        Ok(())
    }

    /// Small object on a support: standing, or lying on its side.
    fn top(&mut self, support: &PlannedSupport) -> Result<PlannedSupport, Error> {
        let least_m = support.object.short_half_side_m();
        let resting = match self.random.below(10) {
            0..6 => Resting::Upright,
            6..8 => Resting::OnEnd,
            8 => Resting::OnEdge,
            _ => Resting::Flat,
        };
        let top = self.generated_within(&TOPS, resting, least_m)?;
        let yaw_rad = self.yaw_on(support, 0.3);
        Ok(self.put_on(&top, support, yaw_rad, 0.5))
    }

    /// Two or three equal boxes on each other, flush or turned.
    fn equal_tower(&mut self) -> Result<(), Error> {
        let resting = self.flat_or_on_edge();
        let object = self.generated(&["carton", "carton", "book", "cookie-tin"], resting)?;
        let mut support = self.put_on_table(&object, object.half_diagonal_m());
        for _ in 0..=self.random.below(2) {
            let yaw_rad = self.yaw_on(&support, 0.6);
            support = self.put_on(&object, &support, yaw_rad, 0.12);
        }
        if self.random.unit() < 0.4 {
            self.top(&support)?;
        }
        Ok(())
    }

    fn flat_or_on_edge(&mut self) -> Resting {
        if self.random.unit() < 0.75 {
            Resting::Flat
        } else {
            Resting::OnEdge
        }
    }

    /// Box across two equal boxes.
    fn bridge(&mut self) -> Result<(), Error> {
        let pier = self.generated(&["carton", "milk-carton", "tin-can"], Resting::Upright)?;
        let deck = self.generated(&["cereal-box", "book", "carton"], Resting::Flat)?;
        let along_x = deck.half_sides_m.x >= deck.half_sides_m.y;
        let long_m = deck.half_sides_m.x.max(deck.half_sides_m.y);
        let apart_m = (0.6 * long_m).max(pier.half_diagonal_m() + 0.004);
        let middle_m = self.table_position(apart_m);
        self.taken.push((middle_m, apart_m));
        let yaw_rad = self.random.between(-PI, PI);
        let (sin, cos) = yaw_rad.sin_cos();
        let apart = Vector2::new(cos, sin) * apart_m;
        for end_m in [middle_m + apart, middle_m - apart] {
            let turn_rad = self.random.between(-0.3, 0.3);
            self.put(&pier, end_m, yaw_rad + turn_rad);
        }
        let turn_rad = if along_x { 0.0 } else { FRAC_PI_2 } + self.random.between(-0.2, 0.2);
        let support = self.put(&deck, middle_m, yaw_rad + turn_rad);
        if self.random.unit() < 0.4 {
            self.top(&support)?;
        }
        Ok(())
    }

    /// Can or tin with a bowl on it, upright or upside down, or another tin.
    fn vessel_tower(&mut self) -> Result<(), Error> {
        let base = self.generated(
            &[
                "tin-can",
                "cookie-tin",
                "cookie-tin",
                "tissue-box",
                "pot",
                "jar",
            ],
            Resting::Upright,
        )?;
        let support = self.put_on_table(&base, base.half_diagonal_m());
        let is_inverted = self.random.unit() < 0.5;
        let resting = if is_inverted {
            Resting::Inverted
        } else {
            Resting::Upright
        };
        let categories = ["bowl", "bowl", "tin-can", "cookie-tin", "soda-can", "mug"];
        let next = self.generated(&categories, resting)?;
        let yaw_rad = self.random.between(-PI, PI);
        self.put_on(&next, &support, yaw_rad, 0.08);
        Ok(())
    }

    /// Bowl, box or pot with small objects in it.
    fn filled_container(&mut self) -> Result<(), Error> {
        let container = self.generated(&CONTAINERS, Resting::Upright)?;
        let support = self.put_on_table(&container, container.half_diagonal_m());
        let least_m = container.short_half_side_m();
        for _ in 0..=self.random.below(4) {
            let content = self.generated_within(&CONTENTS, Resting::Flat, 0.7 * least_m)?;
            let yaw_rad = self.random.between(-PI, PI);
            self.put_on(&content, &support, yaw_rad, 0.4);
        }
        Ok(())
    }

    /// Flat object that leans against a standing one.
    fn leaning(&mut self) -> Result<(), Error> {
        let resting = if self.random.unit() < 0.5 {
            Resting::OnEdge
        } else {
            Resting::OnEnd
        };
        let standing = self.generated(&["carton", "cereal-box", "cereal-box"], resting)?;
        let flat = self.generated(&["book", "carton", "magazine", "cereal-box"], Resting::Flat)?;
        let tilt_rad = self.random.between(LEANING_RAD[0], LEANING_RAD[1]);
        let support = self.put_on_table(
            &standing,
            standing.half_diagonal_m() + 0.5 * flat.half_diagonal_m(),
        );
        // Against the broader face.
        let half = support.object.half_sides_m;
        let (depth_m, face_rad) = if half.x < half.y {
            (half.x, 0.0)
        } else {
            (half.y, FRAC_PI_2)
        };
        let (sin, cos) = tilt_rad.sin_cos();
        let (long_m, thick_m) = (flat.half_sides_m.x, flat.half_sides_m.z);
        let distance_m = depth_m + long_m * cos + thick_m * sin + 0.003;
        let yaw_rad = support.yaw_rad + face_rad;
        let towards = Vector2::new(yaw_rad.cos(), yaw_rad.sin());
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_rad);
        let tilt = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -tilt_rad);
        let position_m = self.on_table(support.position_m - towards * distance_m);
        self.put_rotated(&flat.choice, position_m, yaw * tilt * flat.rotation);
        Ok(())
    }

    /// Objects dropped over the edge of a box or book, so that they lie askew.
    fn lying_across(&mut self) -> Result<(), Error> {
        let base = self.generated(&FLAT, Resting::Flat)?;
        let support = self.put_on_table(&base, base.half_diagonal_m());
        for _ in 0..=self.random.below(2) {
            let categories = [
                "book", "carton", "soda-can", "bottle", "shampoo", "magazine",
            ];
            let object = self.generated(&categories, Resting::Flat)?;
            if self.random.unit() < 0.3 {
                self.put_dropped_beside(&object, &support);
            } else {
                let yaw_rad = self.random.between(-PI, PI);
                self.put_on(&object, &support, yaw_rad, 1.1);
            }
        }
        Ok(())
    }

    /// Flat object that extends over the rim of the table nearest to the crowd.
    fn overhanging(&mut self) -> Result<(), Error> {
        let object =
            self.generated(&["book", "carton", "cereal-box", "magazine"], Resting::Flat)?;
        let half = self.table.size_m.map(|side| side / 2.0);
        let share = self.random.between(0.2, OVERHANG_SHARE);
        let inset_m = share * object.short_half_side_m();
        let along_m = self.random.between(-self.reach_m, self.reach_m);
        let is_x_rim = half[0] - self.centre_m.x.abs() < half[1] - self.centre_m.y.abs();
        let centre_m = self.centre_m;
        let position_m = if is_x_rim {
            let x = (half[0] - inset_m).copysign(centre_m.x);
            Vector2::new(x, self.on_table(centre_m.add_scalar(along_m)).y)
        } else {
            let y = (half[1] - inset_m).copysign(centre_m.y);
            Vector2::new(self.on_table(centre_m.add_scalar(along_m)).x, y)
        };
        let yaw_rad = self.random.between(-0.5, 0.5);
        self.taken.push((position_m, object.short_half_side_m()));
        self.put(&object, position_m, yaw_rad);
        Ok(())
    }

    /// Object of any category.
    fn anything(&mut self) -> Result<(), Error> {
        let object = self.generated(&category_names(), Resting::Upright)?;
        self.put_on_table(&object, object.half_diagonal_m());
        Ok(())
    }

    /// Single object that stands on the table, in an orientation of its own.
    fn standing(&mut self) -> Result<(), Error> {
        let is_packet = self.random.unit() < 0.4;
        let object: OrientedModel = if is_packet {
            let resting = match self.random.below(3) {
                0 => Resting::Upright,
                1 => Resting::OnEdge,
                _ => Resting::OnEnd,
            };
            self.generated(&PACKETS, resting)?
        } else {
            self.generated(&STANDING, Resting::Upright)?
        };
        self.put_on_table(&object, object.half_diagonal_m());
        Ok(())
    }
}
