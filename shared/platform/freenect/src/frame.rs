//! Borrowed images of a synchronised pair.

use std::time::Instant;

/// Image of 640x480 pixels, row-major.
#[derive(Debug, Clone, Copy)]
pub struct Image<'a, T> {
    /// Pixel values. Depth: one 11-bit raw value per pixel, 2047 for none. Colour: red, green,
    /// blue per pixel.
    pub pixels: &'a [T],
    /// Device time stamp, ticks of 1/60 000 000 s; wraps about every 71.6 s.
    pub stamp_ticks: u32,
    /// Time of arrival in this process, monotonic.
    pub arrived: Instant,
}

/// Synchronised pair of depth and colour image (see [`crate::PAIRING_WINDOW_TICKS`]).
#[derive(Debug, Clone, Copy)]
pub struct KinectFrame<'a> {
    /// Raw depth image of the Kinect.
    pub depth: Image<'a, u16>,
    /// Colour image of the Kinect.
    pub video: Image<'a, u8>,
}
