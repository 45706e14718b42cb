//! Lighting of the room: lamps, daylight and the colour of the walls.

use nalgebra::Vector3;
use rendering::{Illuminant, Light, LightPlacement, Lights};

/// sRGB colour of white plaster.
const PLASTER: [u8; 3] = [214, 208, 196];
/// Share of the ambient light that the walls have reflected. Estimate.
const WALL_SHARE: f32 = 0.6;

coded_enum::coded_enum! {
    /// Lamps and walls of a room. The camera keeps its white balance in all of them.
    #[derive(Default)]
    pub enum Lighting {
        /// Neutral ceiling lamp and white walls.
        #[default]
        White, "white";
        /// Low sun through a window and a blue sky.
        Dawn, "dawn";
        /// Incandescent bulbs of 2700 K.
        Tungsten, "tungsten";
        /// Incandescent ceiling lamp and daylight from a window.
        Mixed, "mixed";
        /// Neutral lamp between red walls.
        RedWalls, "red-walls";
        /// Neutral lamp between green walls.
        GreenWalls, "green-walls";
        /// Neutral lamp between blue walls.
        BlueWalls, "blue-walls";
    }
}

impl Lighting {
    /// Light sources of the room.
    pub fn lights(self) -> Lights {
        let room = Lights::ROOM;
        match self {
            Self::White => room,
            Self::Dawn => Lights {
                ambient: illuminant(10_000.0, 0.5),
                main: Light {
                    illuminant: illuminant(3200.0, 0.9),
                    placement: LightPlacement::Directional(Vector3::new(-1.0, -0.6, 0.7)),
                },
                fill: None,
                ..room
            },
            Self::Tungsten => Lights {
                ambient: illuminant(2700.0, 0.35),
                main: Light {
                    illuminant: illuminant(2700.0, 2.2),
                    ..room.main
                },
                fill: None,
                ..room
            },
            Self::Mixed => Lights {
                ambient: illuminant(4500.0, 0.35),
                main: Light {
                    illuminant: illuminant(2800.0, 1.6),
                    ..room.main
                },
                fill: Some(Light {
                    illuminant: illuminant(7500.0, 0.6),
                    placement: LightPlacement::Directional(Vector3::new(-1.0, -0.3, 0.5)),
                }),
                ..room
            },
            Self::RedWalls | Self::GreenWalls | Self::BlueWalls => Lights {
                ambient: illuminant(4800.0, 0.8),
                ambient_tint: wall_tint(self.wall_color()),
                main: Light {
                    illuminant: illuminant(4300.0, 1.3),
                    ..room.main
                },
                ..room
            },
        }
    }

    /// sRGB colour of the walls.
    pub(crate) fn wall_color(self) -> [u8; 3] {
        match self {
            Self::RedWalls => [178, 62, 48],
            Self::GreenWalls => [70, 150, 84],
            Self::BlueWalls => [62, 96, 180],
            _ => PLASTER,
        }
    }
}

impl std::str::FromStr for Lighting {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|one| one.word() == word);
        known.ok_or_else(|| {
            let words: Vec<_> = Self::ALL.iter().map(|one| one.word()).collect();
            format!("`{word}` is no lighting; there are {}", words.join(", "))
        })
    }
}

fn illuminant(temperature_k: f32, intensity: f32) -> Illuminant {
    Illuminant {
        temperature_k,
        intensity,
    }
}

/// Factors on ambient light of which the walls reflect a share.
fn wall_tint(wall: [u8; 3]) -> [f32; 3] {
    let linear = wall.map(|channel| (f32::from(channel) / 255.0).powf(2.2));
    let mean = linear.iter().sum::<f32>() / 3.0;
    linear.map(|channel| 1.0 - WALL_SHARE + WALL_SHARE * channel / mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lighting_names_are_read_back() {
        for lighting in Lighting::ALL {
            assert_eq!(lighting.word().parse(), Ok(lighting));
        }
        let refused = "candles".parse::<Lighting>().unwrap_err();
        assert!(refused.contains("tungsten"), "{refused}");
    }

    #[test]
    fn lighting_of_colored_walls_has_their_colour() {
        let tint = |lighting: Lighting| lighting.lights().ambient_tint;
        assert_eq!(tint(Lighting::White), [1.0; 3]);
        let [red, green, blue] = tint(Lighting::RedWalls);
        assert!(
            red > 1.3 && green < 0.8 && blue < 0.8,
            "{red} {green} {blue}"
        );
    }
}
