//! Colours and textures of the materials of a COLLADA document.

use super::document::{Document, child, children, numbers};
use crate::NEUTRAL_GREY;
use crate::texture_folder::{MAX_TEXTURES, TextureName};
use point_cloud::Rgba;
use roxmltree::Node;

/// Diffuse colour or texture of a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Appearance {
    /// Colour; grey if none is given.
    pub(super) color: Rgba,
    /// Number of the texture, if there is one.
    pub(super) texture: Option<u32>,
}

impl Appearance {
    /// Surface without a material.
    pub(super) const PLAIN: Self = Self {
        color: NEUTRAL_GREY,
        texture: None,
    };
}

/// Textures that the appearances refer to.
#[derive(Debug, Default)]
pub(super) struct Appearances {
    names: Vec<TextureName>,
}

impl Appearances {
    /// Names of the textures by their numbers.
    pub(super) fn texture_names(&self) -> &[TextureName] {
        &self.names
    }

    /// Appearance of a material; plain where the document does not tell it.
    pub(super) fn of_material<'a>(
        &mut self,
        document: &Document<'a>,
        material: Node<'a, 'a>,
    ) -> Appearance {
        let effect = child(material, "instance_effect")
            .and_then(|instance| document.target(instance, "url", "effect"));
        let Some(profile) = effect.and_then(|effect| child(effect, "profile_COMMON")) else {
            return Appearance::PLAIN;
        };
        let shader = child(profile, "technique").and_then(|technique| {
            let shaders = ["lambert", "phong", "blinn", "constant"];
            shaders.into_iter().find_map(|name| child(technique, name))
        });
        let Some(diffuse) = shader.and_then(|shader| child(shader, "diffuse")) else {
            return Appearance::PLAIN;
        };
        let rgb = child(diffuse, "color").and_then(|color| numbers::<f32>(color).ok());
        let color = match rgb.as_deref() {
            Some(&[red, green, blue, ..]) => color(red, green, blue),
            _ => NEUTRAL_GREY,
        };
        let texture = child(diffuse, "texture")
            .and_then(|texture| texture.attribute("texture"))
            .and_then(|sampler| image_path(document, profile, sampler))
            .map(|path| self.number_of(path));
        Appearance { color, texture }
    }

    fn number_of(&mut self, path: String) -> u32 {
        let name = TextureName {
            base: String::new(),
            name: path,
        };
        let known = self.names.iter().position(|known| *known == name);
        let number = known.unwrap_or_else(|| {
            // One more than are loaded tells that there are too many.
            if self.names.len() <= MAX_TEXTURES {
                self.names.push(name);
            }
            self.names.len() - 1
        });
        number as u32
    }
}

/// Colour of numbers from 0 to 1, clamped.
pub(super) fn color(red: f32, green: f32, blue: f32) -> Rgba {
    let [red, green, blue] = [red, green, blue].map(|value| (value * 255.0).round() as u8);
    Rgba::opaque(red, green, blue)
}

/// Path of the image of a sampler: sampler, surface and image, or the image itself.
fn image_path<'a>(
    document: &Document<'a>,
    profile: Node<'a, 'a>,
    sampler: &'a str,
) -> Option<String> {
    let parameter = |sid: &str| {
        children(profile, "newparam").find(|parameter| parameter.attribute("sid") == Some(sid))
    };
    let surface = parameter(sampler)
        .and_then(|parameter| child(parameter, "sampler2D"))
        .and_then(|sampler| child(sampler, "source")?.text());
    let image = surface
        .and_then(|surface| parameter(surface.trim()))
        .and_then(|parameter| child(parameter, "surface"))
        .and_then(|surface| child(surface, "init_from")?.text())
        .unwrap_or(sampler);
    let image = document.element("image", image.trim())?;
    let from = child(image, "init_from")?;
    let path = child(from, "ref").unwrap_or(from).text()?;
    Some(without_percent_codes(path.trim()))
}

/// Text of a URI whose percent codes are replaced, as in `a%20b.png`.
fn without_percent_codes(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, behind @ ..] = rest {
        let code = behind
            .split_at_checked(2)
            .filter(|_| *first == b'%')
            .and_then(|(code, behind)| {
                let code = std::str::from_utf8(code).ok()?;
                Some((u8::from_str_radix(code, 16).ok()?, behind))
            });
        let (byte, behind) = code.unwrap_or((*first, behind));
        bytes.push(byte);
        rest = behind;
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
