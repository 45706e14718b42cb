//! What illuminates a scene.

use crate::Illuminant;
use nalgebra::{Point3, Vector3};

/// Where a light is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightPlacement {
    /// Far away; the vector points to the light, of any length but zero.
    Directional(Vector3<f32>),
    /// A lamp, metres; its intensity holds at 1 m and falls with the distance squared.
    Point(Point3<f32>),
}

/// One light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Its colour and strength.
    pub illuminant: Illuminant,
    /// Where it is, world frame.
    pub placement: LightPlacement,
}

/// The ball in which shadows of the main light are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowRegion {
    /// Centre, world frame, metres.
    pub center_in_world: Point3<f32>,
    /// Radius, metres. A shadow's border is about 0.02 of it wide.
    pub radius_m: f32,
}

/// All light of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lights {
    /// Light of the surroundings: full from above, half from below.
    pub ambient: Illuminant,
    /// The light that casts shadows.
    pub main: Light,
    /// A second light, without shadow.
    pub fill: Option<Light>,
    /// Where the main light casts shadows; nowhere when `None`.
    pub shadow: Option<ShadowRegion>,
}

impl Lights {
    /// A room with a neutral ceiling lamp 2 m over the origin and a weak
    /// cooler light from the side; shadows within 1.2 m of the origin.
    pub const ROOM: Self = Self {
        ambient: Illuminant {
            temperature_k: 5500.0,
            intensity: 0.45,
        },
        main: Light {
            illuminant: Illuminant {
                temperature_k: 4300.0,
                intensity: 2.4,
            },
            placement: LightPlacement::Point(Point3::new(0.4, 0.5, 2.0)),
        },
        fill: Some(Light {
            illuminant: Illuminant {
                temperature_k: 6500.0,
                intensity: 0.15,
            },
            placement: LightPlacement::Directional(Vector3::new(-1.0, -0.4, 0.6)),
        }),
        shadow: Some(ShadowRegion {
            center_in_world: Point3::new(0.0, 0.0, 0.0),
            radius_m: 1.2,
        }),
    };
}
