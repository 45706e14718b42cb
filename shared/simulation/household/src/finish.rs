//! Surface finishes: specular and infrared reflectance of materials.

use mesh::Surface;

const fn surface(specular: f32, infrared: f32) -> Surface {
    Surface { specular, infrared }
}

/// Finish of glazed ceramics.
pub(crate) const GLAZED: Surface = surface(0.3, 1.0);
/// Finish of glossy plastic.
pub(crate) const PLASTIC: Surface = surface(0.15, 1.0);
/// Finish of rubber, which absorbs infrared light.
pub(crate) const RUBBER: Surface = surface(0.02, 0.5);
/// Finish of polished metal objects.
pub(crate) const POLISHED: Surface = surface(0.8, 0.8);
/// Finish of brushed metal.
pub(crate) const BRUSHED: Surface = surface(0.5, 0.9);
/// Finish of printed cardboard.
pub(crate) const PRINTED: Surface = surface(0.1, 1.0);
/// Finish of waxy skin of fruit.
pub(crate) const WAXY: Surface = surface(0.12, 1.1);
/// Finish of displays and dark glass, which absorb the projector's light.
pub(crate) const DARK_GLASS: Surface = surface(0.6, 0.15);
