//! How materials reflect.

use mesh::Surface;

const fn surface(specular: f32, infrared: f32) -> Surface {
    Surface { specular, infrared }
}

pub(crate) const GLAZED: Surface = surface(0.3, 1.0);
pub(crate) const PLASTIC: Surface = surface(0.15, 1.0);
pub(crate) const RUBBER: Surface = surface(0.02, 0.5);
pub(crate) const POLISHED: Surface = surface(0.8, 0.8);
pub(crate) const BRUSHED: Surface = surface(0.5, 0.9);
pub(crate) const PRINTED: Surface = surface(0.1, 1.0);
pub(crate) const WAXY: Surface = surface(0.12, 1.1);
/// Displays and dark glass swallow the projector's light.
pub(crate) const DARK_GLASS: Surface = surface(0.6, 0.15);
