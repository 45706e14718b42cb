//! Textures of a model: images in the folder of its file.

use crate::folder_path::path_below;
use crate::texture::Texture;
use file_access::excerpt;
use file_access::read_file;
use std::path::Path;

/// Maximum number of textures of one model.
pub(crate) const MAX_TEXTURES: usize = 64;

/// Maximum size of an image file, bytes.
const MAX_IMAGE_BYTES: u64 = 1 << 26;

/// Name of a texture as a file gives it.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct TextureName {
    /// Subfolder of the model's folder with the file that gives the name.
    pub(crate) base: String,
    /// Path from there.
    pub(crate) name: String,
}

/// Loads the textures of a model, all from the model's folder. A texture that cannot be used is
/// `None`, and a clause about it is added to `notes`.
pub(crate) fn load(
    folder: &Path,
    names: &[TextureName],
    notes: &mut Vec<String>,
) -> Vec<Option<Texture>> {
    let mut buffer = Vec::new();
    let mut open = |texture: &TextureName| {
        let below = path_below(&texture.base, &texture.name)
            .ok_or("its path leads out of the model's folder; put it there")?;
        let path = folder.join(below);
        if !path.exists() {
            return Err("the file is missing; put it into the model's folder".to_owned());
        }
        read_file(&path, MAX_IMAGE_BYTES, &mut buffer).map_err(|error| error.to_string())?;
        Texture::decode(&buffer).map_err(|error| error.to_string())
    };
    let textures = names.iter().take(MAX_TEXTURES).map(|texture| {
        let loaded = open(texture);
        loaded
            .map_err(|problem| {
                let name = excerpt(&texture.name);
                notes.push(format!("its texture \"{name}\" is left out: {problem}"));
            })
            .ok()
    });
    let textures = textures.collect();
    if names.len() > MAX_TEXTURES {
        notes.push(format!(
            "it has more than {MAX_TEXTURES} textures; the first ones are used"
        ));
    }
    textures
}
