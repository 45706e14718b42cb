//! Material libraries: diffuse colours and textures by name.

use super::lines::{Line, lines};
use crate::ModelError;
use crate::texture_folder::{MAX_TEXTURES, TextureName};
use point_cloud::Rgba;
use std::collections::HashMap;

/// Maximum number of materials of one model.
const MAX_MATERIALS: usize = 1 << 16;

/// Maximum number of libraries of one model.
const MAX_LIBRARIES: usize = 64;

/// Diffuse colours and textures of materials by name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Materials {
    colors: HashMap<String, Rgba>,
    /// Number of the texture of each material.
    textures: HashMap<String, u32>,
    texture_names: Vec<TextureName>,
}

impl Materials {
    /// Adds the materials of a library from its bytes: the lines `newmtl`, `Kd r g b` and
    /// `map_Kd FILE`. The numbers are taken as display colours and clamped to 0 to 1. Other lines
    /// are skipped.
    ///
    /// # Errors
    /// When such a line is wrong, or there are more than 65536 materials.
    pub fn read(&mut self, bytes: &[u8]) -> Result<(), ModelError> {
        self.read_in("", bytes)
    }

    /// Adds the materials of a library in this subfolder of the model's folder, as
    /// [`read`](Self::read).
    pub(super) fn read_in(&mut self, base: &str, bytes: &[u8]) -> Result<(), ModelError> {
        let mut name = None;
        for line in lines(bytes) {
            let too_early =
                || line.error("a colour or texture comes before the first material".to_owned());
            match line.keyword {
                b"newmtl" => name = Some(line.text()?),
                b"Kd" => {
                    let color = diffuse_color(&line)?;
                    let name = name.ok_or_else(too_early)?;
                    if let Some(color) = color {
                        self.colors.insert(name.to_owned(), color);
                    }
                }
                b"map_Kd" => {
                    let texture = texture_file(line.text()?);
                    let name = name.ok_or_else(too_early)?;
                    self.insert_texture(name, base, texture);
                }
                _ => {}
            }
            if self.colors.len().max(self.textures.len()) > MAX_MATERIALS {
                return Err(ModelError::TooManyMaterials);
            }
        }
        Ok(())
    }

    fn insert_texture(&mut self, material: &str, base: &str, file: &str) {
        let texture = TextureName {
            base: base.to_owned(),
            name: file.to_owned(),
        };
        let mut known = self.texture_names.iter();
        let number = known.position(|known| *known == texture);
        let number = number.unwrap_or_else(|| {
            // One more than are loaded tells that there are too many.
            if self.texture_names.len() <= MAX_TEXTURES {
                self.texture_names.push(texture);
            }
            self.texture_names.len() - 1
        });
        self.textures.insert(material.to_owned(), number as u32);
    }

    /// Number of a material's texture, if it has one.
    pub(super) fn texture(&self, name: &str) -> Option<u32> {
        self.textures.get(name).copied()
    }

    /// Names of the textures by their numbers.
    pub(super) fn texture_names(&self) -> &[TextureName] {
        &self.texture_names
    }

    /// Colour of a material, if known.
    pub fn color(&self, name: &str) -> Option<Rgba> {
        self.colors.get(name).copied()
    }
}

/// Parses a diffuse colour; `None` for a spectrum, which is a file of its own.
fn diffuse_color(line: &Line<'_>) -> Result<Option<Rgba>, ModelError> {
    if matches!(line.words()?.next(), Some("spectral" | "xyz")) {
        return Ok(None);
    }
    let mut rgb = [0.0; 3];
    match line.numbers(&mut rgb)? {
        3 => {}
        // Omitted green and blue equal red.
        1 => rgb = [rgb[0]; 3],
        _ => return Err(line.error("a colour has three numbers".to_owned())),
    }
    let [red, green, blue] = rgb.map(byte);
    Ok(Some(Rgba::opaque(red, green, blue)))
}

/// File name of a texture, behind its options. Names may contain spaces.
fn texture_file(text: &str) -> &str {
    let mut rest = text;
    while rest.starts_with('-') {
        let (option, behind) = split_word(rest);
        // Numbers at most, or words, that follow the option.
        let (n_numbers, n_words) = match option {
            "-o" | "-s" | "-t" => (3, 0),
            "-mm" => (2, 0),
            "-bm" | "-boost" | "-texres" => (1, 0),
            "-blendu" | "-blendv" | "-cc" | "-clamp" | "-imfchan" | "-type" => (0, 1),
            _ => break,
        };
        rest = behind;
        for _ in 0..n_words {
            rest = split_word(rest).1;
        }
        for _ in 0..n_numbers {
            let (word, behind) = split_word(rest);
            if word.parse::<f32>().is_err() || behind.is_empty() {
                break;
            }
            rest = behind;
        }
    }
    rest
}

/// Splits off the first word.
fn split_word(text: &str) -> (&str, &str) {
    let (word, rest) = text
        .split_once(|character: char| character.is_ascii_whitespace())
        .unwrap_or((text, ""));
    (word, rest.trim_ascii_start())
}

/// Converts a number from 0 to 1 to a byte, clamped.
pub(super) fn byte(value: f32) -> u8 {
    (value * 255.0).round() as u8
}

/// Names of the material libraries of an OBJ file, without duplicates. They may lead out of its
/// folder.
///
/// # Errors
/// When a line `mtllib` is not UTF-8 text, or there are more than 64 libraries.
pub fn material_libraries(bytes: &[u8]) -> Result<Vec<&str>, ModelError> {
    let mut names = Vec::new();
    for line in lines(bytes).filter(|line| line.keyword == b"mtllib") {
        let text = line.text()?;
        // Either one name with spaces, as most programs write, or several names.
        let is_one = text.matches(".mtl").count() < 2;
        let found = if is_one {
            vec![text]
        } else {
            line.words()?.take(MAX_LIBRARIES + 1).collect()
        };
        for name in found {
            if !name.is_empty() && !names.contains(&name) {
                names.push(name);
            }
        }
        if names.len() > MAX_LIBRARIES {
            return Err(ModelError::TooManyMaterials);
        }
    }
    Ok(names)
}
