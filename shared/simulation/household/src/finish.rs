//! Surface finishes: specular and infrared reflectance of materials.

use mesh::Surface;

const fn surface(specular: f32, infrared: f32) -> Surface {
    Surface { specular, infrared }
}

/// Glazed ceramics.
pub(crate) const GLAZED: Surface = surface(0.3, 1.0);
/// Glossy plastic.
pub(crate) const PLASTIC: Surface = surface(0.15, 1.0);
/// Rubber, which absorbs infrared light.
pub(crate) const RUBBER: Surface = surface(0.02, 0.5);
/// Polished metal.
pub(crate) const POLISHED: Surface = surface(0.8, 0.8);
/// Brushed metal.
pub(crate) const BRUSHED: Surface = surface(0.5, 0.9);
/// Printed cardboard.
pub(crate) const PRINTED: Surface = surface(0.1, 1.0);
/// Waxy skin of fruit.
pub(crate) const WAXY: Surface = surface(0.12, 1.1);
/// Displays and dark glass, which absorb the projector's light.
pub(crate) const DARK_GLASS: Surface = surface(0.6, 0.15);
