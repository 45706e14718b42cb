//! Material libraries: diffuse colours by name.

use super::Error;
use super::lines::{Line, lines};
use point_cloud::Rgba;
use std::collections::HashMap;

/// Maximum number of materials of one model.
const MAX_MATERIALS: usize = 1 << 16;

/// Maximum number of libraries of one model.
const MAX_LIBRARIES: usize = 64;

/// Diffuse colours of materials by name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Materials {
    colors: HashMap<String, Rgba>,
}

impl Materials {
    /// Adds the materials of a library from its bytes: the lines `newmtl` and `Kd r g b`. The
    /// numbers are taken as display colours and clamped to 0 to 1. Other lines are skipped.
    ///
    /// # Errors
    /// When such a line is wrong, or there are more than 65536 materials.
    pub fn read(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let mut name = None;
        for line in lines(bytes) {
            match line.keyword {
                b"newmtl" => name = Some(line.text()?),
                b"Kd" => {
                    let color = diffuse_color(&line)?;
                    let name = name.ok_or_else(|| {
                        line.error("a colour comes before the first material".to_owned())
                    })?;
                    if let Some(color) = color {
                        self.colors.insert(name.to_owned(), color);
                    }
                }
                _ => {}
            }
            if self.colors.len() > MAX_MATERIALS {
                return Err(Error::TooManyMaterials);
            }
        }
        Ok(())
    }

    /// Colour of a material, if known.
    pub fn color(&self, name: &str) -> Option<Rgba> {
        self.colors.get(name).copied()
    }
}

/// Parses a diffuse colour; `None` for a spectrum, which is a file of its own.
fn diffuse_color(line: &Line<'_>) -> Result<Option<Rgba>, Error> {
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

/// Converts a number from 0 to 1 to a byte, clamped.
pub(super) fn byte(value: f32) -> u8 {
    (value * 255.0).round() as u8
}

/// Names of the material libraries of an OBJ file, without duplicates and without those in
/// other folders.
///
/// # Errors
/// When a line `mtllib` is not UTF-8 text, or there are more than 64 libraries.
pub fn material_libraries(bytes: &[u8]) -> Result<Vec<&str>, Error> {
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
            let name = name.strip_prefix("./").unwrap_or(name);
            if is_plain_name(name) && !names.contains(&name) {
                names.push(name);
            }
        }
        if names.len() > MAX_LIBRARIES {
            return Err(Error::TooManyMaterials);
        }
    }
    Ok(names)
}

/// True if a name can only refer to a file in the same folder.
fn is_plain_name(name: &str) -> bool {
    !matches!(name, "" | "." | "..") && !name.contains(['/', '\\', ':', '\0'])
}
