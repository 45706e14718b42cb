//! Light sources of a scene.

use crate::Illuminant;
use nalgebra::{Point3, Vector3};

/// Position or direction of a light source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightPlacement {
    /// Directional light; the vector points to the light, of any length but zero.
    Directional(Vector3<f32>),
    /// Point light at a position, metres; its intensity holds at 1 m and falls with the square of
    /// the distance.
    Point(Point3<f32>),
}

/// Light source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Colour temperature and intensity of the light.
    pub illuminant: Illuminant,
    /// Position or direction of the light, world frame.
    pub placement: LightPlacement,
}

/// Sphere in which the main light casts shadows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowRegion {
    /// Centre of the shadow region, world frame, metres.
    pub center_in_world: Point3<f32>,
    /// Radius, metres. The soft border of a shadow is about 0.02 of it wide.
    pub radius_m: f32,
}

/// Light sources and shadow region of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lights {
    /// Ambient hemisphere light: full from above, half from below.
    pub ambient: Illuminant,
    /// Colour that the walls give to the ambient light: factors on its linear sRGB; 1 for white
    /// walls. Negative and non-finite factors count as 0.
    pub ambient_tint: [f32; 3],
    /// Main light, which casts shadows.
    pub main: Light,
    /// Fill light, which casts no shadows.
    pub fill: Option<Light>,
    /// Shadow region of the main light; `None` for no shadows.
    pub shadow: Option<ShadowRegion>,
}

impl Lights {
    /// Ambient light with the colour of the walls, linear sRGB.
    pub(crate) fn ambient_rgb(&self) -> [f32; 3] {
        let tint = |factor: f32| {
            if factor.is_finite() {
                factor.max(0.0)
            } else {
                0.0
            }
        };
        let rgb = self.ambient.linear_rgb();
        [0, 1, 2].map(|channel| rgb[channel] * tint(self.ambient_tint[channel]))
    }

    /// Indoor room: a neutral ceiling lamp 2 m above the origin and a weak cooler light from the
    /// side; shadows within 1.2 m of the origin.
    pub const ROOM: Self = Self {
        ambient: Illuminant {
            temperature_k: 5500.0,
            intensity: 0.45,
        },
        ambient_tint: [1.0; 3],
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
