//! Reflectance and orientation of the surface seen in a pixel.

/// Surface reflectance and orientation in one pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Reflection {
    /// Outward unit normal, camera frame, times 127.
    pub normal: [i8; 3],
    /// Cosine between the normal and the direction to the camera, times 255.
    pub cos_incidence: u8,
    /// Infrared albedo, times 255.
    pub infrared: u8,
    /// Specular share, times 255.
    pub specular: u8,
}
