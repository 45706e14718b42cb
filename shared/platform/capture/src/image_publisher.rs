//! Publisher of the raw images of each frame, for as long as somebody subscribes.

use crate::source::{FrameInfo, Source};
use crate::source_images::{SourceImages, write_color_of_points, write_depth_of_points};
use channel::topic::CameraImages;
use channel::{Domain, Error, Loan, Publisher};
use geometry::PinholeCamera;
use message::{FrameHeader, ImageHeader, WireTransform, image_bytes, image_flag};
use point_cloud::Point;

/// Publisher of images. A failure costs the images and never the frame.
pub(crate) struct ImagePublisher {
    publisher: Publisher<CameraImages>,
    is_failure_logged: bool,
}

/// Images of a filled frame in shared memory, with the header fields that they determine.
pub(crate) struct LoanedImages {
    loan: Loan<CameraImages>,
    cameras: ImageCameras,
}

/// Cameras of both images, and the transform between them.
struct ImageCameras {
    depth: PinholeCamera,
    color: PinholeCamera,
    color_from_depth: Option<WireTransform>,
}

impl ImagePublisher {
    /// Creates the publisher for frames of at most `max_points` points.
    pub(crate) fn new(domain: &Domain, max_points: usize) -> Result<Self, Error> {
        Ok(Self {
            publisher: Publisher::for_items(domain, image_bytes(max_points))?,
            is_failure_logged: false,
        })
    }

    /// Shared memory reserved by the publisher, bytes.
    pub(crate) fn reserved_bytes(&self) -> u64 {
        self.publisher.reservation().bytes()
    }

    /// Images of the frame that the source has just filled; `None` without a subscriber.
    pub(crate) fn loan_filled(
        &mut self,
        source: &dyn Source,
        info: &FrameInfo,
        points: &[Point],
    ) -> Option<LoanedImages> {
        if !self.publisher.has_subscribers() {
            return None;
        }
        let filled = self.filled(source, info, points);
        filled.map_err(|error| self.report(&error)).ok()
    }

    fn filled(
        &self,
        source: &dyn Source,
        info: &FrameInfo,
        points: &[Point],
    ) -> Result<LoanedImages, Error> {
        match source.images() {
            Some(images) => self.filled_by_source(&images),
            None => self.filled_by_cloud(&info.camera, points),
        }
    }

    fn filled_by_source(&self, images: &SourceImages<'_>) -> Result<LoanedImages, Error> {
        let n_depth_bytes = 2 * images.depth.len();
        let mut loan = self
            .publisher
            .loan(n_depth_bytes + images.color_rgb.len())?;
        let (depth, color) = loan.items_mut().split_at_mut(n_depth_bytes);
        images.depth.write_mm(depth);
        color.copy_from_slice(images.color_rgb);
        Ok(LoanedImages {
            loan,
            cameras: ImageCameras {
                depth: images.depth_camera,
                color: images.color_camera,
                color_from_depth: images.color_from_depth.as_ref().map(WireTransform::from),
            },
        })
    }

    fn filled_by_cloud(
        &self,
        camera: &PinholeCamera,
        points: &[Point],
    ) -> Result<LoanedImages, Error> {
        let mut loan = self.publisher.loan(image_bytes(points.len()))?;
        let (depth, color) = loan.items_mut().split_at_mut(2 * points.len());
        write_depth_of_points(points, depth);
        write_color_of_points(points, color);
        Ok(LoanedImages {
            loan,
            cameras: ImageCameras {
                depth: *camera,
                color: *camera,
                color_from_depth: None,
            },
        })
    }

    /// Sends the images of a frame that was sent with this header.
    pub(crate) fn send(&mut self, images: LoanedImages, frame: &FrameHeader) {
        let LoanedImages { mut loan, cameras } = images;
        let mut header = ImageHeader::of_frame(frame);
        header.set_cameras(&cameras.depth, &cameras.color);
        match cameras.color_from_depth {
            Some(transform) => header.color_from_depth = transform,
            None => header.flags |= image_flag::REGISTERED,
        }
        *loan.header_mut() = header;
        if let Err(error) = self.publisher.send(loan) {
            self.report(&error);
        }
    }

    fn report(&mut self, error: &Error) {
        if !std::mem::replace(&mut self.is_failure_logged, true) {
            tracing::warn!(
                "the images of a frame are not sent: {error}; further ones are not logged"
            );
        }
    }
}
