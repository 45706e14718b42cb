//! Raw images of a camera frame: header and pixels.

use crate::frame::intrinsics_of;
use crate::pose::WireTransform;
use crate::{FrameHeader, SCHEMA_VERSION, frame_flag};
use bytemuck::{AnyBitPattern, Zeroable};
use geometry::{InvalidIntrinsics, PinholeCamera, RigidTransform};
use iceoryx2::prelude::ZeroCopySend;

/// Bytes of a depth pixel: millimetres, 16 bits, little-endian.
const DEPTH_PIXEL_BYTES: usize = 2;
/// Bytes of a colour pixel: red, green, blue.
const COLOR_PIXEL_BYTES: usize = 3;

/// Bytes of a frame whose images have this many pixels each.
pub const fn image_bytes(n_pixels: usize) -> usize {
    n_pixels * (DEPTH_PIXEL_BYTES + COLOR_PIXEL_BYTES)
}

/// Codes of [`ImageHeader::depth_encoding`].
pub mod depth_encoding {
    /// Millimetres as 16-bit integers, little-endian; 0 without depth.
    pub const MILLIMETRES_16: u32 = 1;
}

/// Codes of [`ImageHeader::color_encoding`].
pub mod color_encoding {
    /// Red, green and blue, 8 bits each.
    pub const RGB_8: u32 = 1;
}

/// Bits of [`ImageHeader::flags`].
pub mod image_flag {
    /// Registered images: a pixel of both shows the same point, with the same intrinsics.
    pub const REGISTERED: u32 = 1;
    /// Flag: the field `world_from_camera` is valid.
    pub const HAS_WORLD_POSE: u32 = 1 << 1;
    /// Intrinsics are calibrated for this camera; otherwise nominal.
    pub const CALIBRATED: u32 = 1 << 2;
}

/// Header of the raw images of a frame. Session and sequence are those of the frame's cloud.
/// The payload is the depth image, then the colour image, row by row.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ImageHeader.v6")]
#[repr(C)]
pub struct ImageHeader {
    /// [`SCHEMA_VERSION`] of the sending program.
    pub schema_version: u32,
    /// Flags of the images: bits of [`image_flag`].
    pub flags: u32,
    /// Message number of the port, from 1.
    pub sent: u64,
    /// Session of the frame, as in its cloud.
    pub session: u64,
    /// Sequence number of the frame, as in its cloud.
    pub sequence: u64,
    /// Capture time of the frame, as in its cloud, nanoseconds.
    pub capture_stamp_ns: u64,
    /// Intrinsics of the colour image: fx, fy, cx, cy.
    pub color_intrinsics_px: [f64; 4],
    /// Intrinsics of the depth image: fx, fy, cx, cy.
    pub depth_intrinsics_px: [f64; 4],
    /// Width and height of the colour image.
    pub color_size_px: [u32; 2],
    /// Width and height of the depth image.
    pub depth_size_px: [u32; 2],
    /// Encoding of the colour pixels: code of [`color_encoding`].
    pub color_encoding: u32,
    /// Encoding of the depth pixels: code of [`depth_encoding`].
    pub depth_encoding: u32,
    /// Transform from the depth camera's frame, which is the cloud's, to the colour camera's.
    pub color_from_depth: WireTransform,
    /// Pose of the depth camera; valid with `HAS_WORLD_POSE`.
    pub world_from_camera: WireTransform,
}

const _: () = assert!(size_of::<ImageHeader>() == 320 && align_of::<ImageHeader>() == 8);

impl Default for ImageHeader {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            color_encoding: color_encoding::RGB_8,
            depth_encoding: depth_encoding::MILLIMETRES_16,
            color_from_depth: WireTransform::IDENTITY,
            world_from_camera: WireTransform::IDENTITY,
            ..Self::zeroed()
        }
    }
}

/// Validated content of an image header.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedImages {
    /// Intrinsics of the colour image, with its size.
    pub color_camera: PinholeCamera,
    /// Intrinsics of the depth image, with its size.
    pub depth_camera: PinholeCamera,
    /// Transform from the depth camera's frame to the colour camera's.
    pub color_from_depth: RigidTransform,
    /// True if a pixel of both images shows the same point.
    pub is_registered: bool,
    /// Pose of the depth camera; `None` when unknown.
    pub world_from_camera: Option<RigidTransform>,
}

/// Error of checking received images.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidImages {
    /// Schema version of another build of tabula.
    #[error(
        "the images have schema version {0}, this process reads {own}; \
         stop all tabula processes of this domain and start them from one build",
        own = SCHEMA_VERSION
    )]
    SchemaVersion(u32),
    /// Pixel encoding that this build does not know.
    #[error("the images' pixels are encoded in a way that this process does not know ({0})")]
    Encoding(u32),
    /// Impossible camera intrinsics in the image header.
    #[error("{0}")]
    Intrinsics(InvalidIntrinsics),
    /// Registered images of two sizes or with two sets of intrinsics.
    #[error("the images are marked as registered, but their cameras differ")]
    NotRegistered,
    /// Number of bytes that does not fill the images.
    #[error("the images hold {n_bytes} bytes, their header says {needed}")]
    Size {
        /// Number of bytes in the message.
        n_bytes: usize,
        /// Number of bytes by the sizes in the header.
        needed: usize,
    },
    /// Pose or transform between the cameras that is no rigid transform.
    #[error("the images' camera pose, or the transform between their cameras, is not rigid")]
    Transform,
}

impl ImageHeader {
    /// Header with the fields that tie the images to their frame.
    pub fn of_frame(frame: &FrameHeader) -> Self {
        let mut flags = 0;
        for (of_frame, own) in [
            (frame_flag::HAS_WORLD_POSE, image_flag::HAS_WORLD_POSE),
            (frame_flag::CALIBRATED, image_flag::CALIBRATED),
        ] {
            flags |= if frame.has(of_frame) { own } else { 0 };
        }
        Self {
            flags,
            session: frame.session,
            sequence: frame.sequence,
            capture_stamp_ns: frame.capture_stamp_ns,
            world_from_camera: frame.world_from_camera,
            ..Self::default()
        }
    }

    /// True if a flag of [`image_flag`] is set.
    pub fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    /// Sets intrinsics and sizes of both images.
    pub fn set_cameras(&mut self, depth: &PinholeCamera, color: &PinholeCamera) {
        (self.depth_intrinsics_px, self.depth_size_px) = intrinsics_of(depth);
        (self.color_intrinsics_px, self.color_size_px) = intrinsics_of(color);
    }

    /// Validates the header against its own fields and the number of bytes of the payload.
    ///
    /// # Errors
    /// Says which number is impossible.
    pub fn checked(&self, n_bytes: usize) -> Result<CheckedImages, InvalidImages> {
        if self.schema_version != SCHEMA_VERSION {
            return Err(InvalidImages::SchemaVersion(self.schema_version));
        }
        for (code, known) in [
            (self.depth_encoding, depth_encoding::MILLIMETRES_16),
            (self.color_encoding, color_encoding::RGB_8),
        ] {
            if code != known {
                return Err(InvalidImages::Encoding(code));
            }
        }
        let camera = |intrinsics_px, size_px| {
            PinholeCamera::with_intrinsics(intrinsics_px, size_px)
                .map_err(InvalidImages::Intrinsics)
        };
        let depth_camera = camera(self.depth_intrinsics_px, self.depth_size_px)?;
        let color_camera = camera(self.color_intrinsics_px, self.color_size_px)?;
        let is_registered = self.has(image_flag::REGISTERED);
        if is_registered && depth_camera != color_camera {
            return Err(InvalidImages::NotRegistered);
        }
        let images = CheckedImages {
            color_camera,
            depth_camera,
            color_from_depth: self
                .color_from_depth
                .checked()
                .ok_or(InvalidImages::Transform)?,
            is_registered,
            world_from_camera: self
                .has(image_flag::HAS_WORLD_POSE)
                .then(|| {
                    self.world_from_camera
                        .checked()
                        .ok_or(InvalidImages::Transform)
                })
                .transpose()?,
        };
        let needed = images.n_bytes();
        if n_bytes != needed {
            return Err(InvalidImages::Size { n_bytes, needed });
        }
        Ok(images)
    }
}

impl CheckedImages {
    /// Bytes of the payload: both images.
    pub fn n_bytes(&self) -> usize {
        self.depth_camera.n_pixels() * DEPTH_PIXEL_BYTES
            + self.color_camera.n_pixels() * COLOR_PIXEL_BYTES
    }

    /// Depth pixels of a payload of [`n_bytes`](Self::n_bytes), row by row, millimetres; 0 without
    /// depth.
    pub fn depth_mm<'a>(&self, payload: &'a [u8]) -> impl ExactSizeIterator<Item = u16> + use<'a> {
        let end = payload
            .len()
            .min(self.depth_camera.n_pixels() * DEPTH_PIXEL_BYTES);
        let pixels = payload[..end].as_chunks::<DEPTH_PIXEL_BYTES>().0;
        pixels.iter().map(|&bytes| u16::from_le_bytes(bytes))
    }

    /// Colour pixels of a payload of [`n_bytes`](Self::n_bytes), row by row: red, green, blue.
    pub fn color_rgb<'a>(&self, payload: &'a [u8]) -> &'a [[u8; COLOR_PIXEL_BYTES]] {
        let begin = payload
            .len()
            .min(self.depth_camera.n_pixels() * DEPTH_PIXEL_BYTES);
        payload[begin..].as_chunks::<COLOR_PIXEL_BYTES>().0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> ImageHeader {
        let frame = FrameHeader {
            session: 7,
            sequence: 8,
            flags: frame_flag::HAS_WORLD_POSE,
            ..FrameHeader::default()
        };
        let mut header = ImageHeader::of_frame(&frame);
        let color = PinholeCamera {
            width: 320,
            height: 240,
            ..PinholeCamera::KINECT_V1
        };
        header.set_cameras(&PinholeCamera::KINECT_V1, &color);
        header
    }

    const N_BYTES: usize = 640 * 480 * 2 + 320 * 240 * 3;

    #[test]
    fn images_are_tied_to_their_frame_and_split_by_their_sizes() {
        let header = good();
        assert_eq!((header.session, header.sequence), (7, 8));
        let images = header.checked(N_BYTES).unwrap();
        assert_eq!(images.world_from_camera, Some(RigidTransform::identity()));
        let mut payload = vec![0; N_BYTES];
        payload[2..4].copy_from_slice(&1234_u16.to_le_bytes());
        payload[N_BYTES - 3..].copy_from_slice(&[1, 2, 3]);
        assert_eq!(images.depth_mm(&payload).len(), 640 * 480);
        assert_eq!(images.depth_mm(&payload).nth(1), Some(1234));
        let color = images.color_rgb(&payload);
        assert_eq!((color.len(), color.last()), (320 * 240, Some(&[1, 2, 3])));
    }

    #[test]
    fn each_impossible_number_of_an_image_header_is_named() {
        let check = |change: &dyn Fn(&mut ImageHeader), n_bytes: usize, word: &str| {
            let mut header = good();
            change(&mut header);
            let sentence = header.checked(n_bytes).unwrap_err().to_string();
            assert!(sentence.contains(word), "{sentence}");
        };
        check(&|h| h.schema_version = 99, N_BYTES, "version 99");
        check(&|h| h.depth_encoding = 9, N_BYTES, "encoded");
        check(&|h| h.color_encoding = 0, N_BYTES, "encoded");
        check(
            &|h| h.color_intrinsics_px[0] = f64::NAN,
            N_BYTES,
            "intrinsics",
        );
        check(&|h| h.depth_size_px = [u32::MAX; 2], N_BYTES, "intrinsics");
        check(
            &|h| h.flags |= image_flag::REGISTERED,
            N_BYTES,
            "registered",
        );
        check(&|h| h.color_from_depth.rows[0][0] = 9.0, N_BYTES, "rigid");
        check(&|h| h.world_from_camera.rows[1][1] = 9.0, N_BYTES, "rigid");
        check(&|_| (), N_BYTES - 1, "bytes");
    }
}
