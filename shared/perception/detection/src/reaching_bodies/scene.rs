//! Subsampled image in which bodies are searched: connectivity, tracks, the previous bodies.

use crate::affine_form::AffineForm;
use crate::body_map::BodyMap;
use crate::constraint_evaluation::is_expected;
use crate::depth_history::{Motion, MotionView};
use crate::input::ExpectedTrack;
use crate::samples::Samples;
use point_cloud::{ColorHistogram, OrganizedCloud, Rgba};
use sensor_noise::DepthNoise;

/// Greatest depth step between neighbouring samples of one surface, metres at 1 m, growing
/// with depth as the distance of the samples does; the noise comes on top. Chosen.
const STEP_M: f32 = 0.02;

/// Tolerance of the depth step, sigmas of the depth noise.
const NOISE_SIGMAS: f32 = 3.0;

/// Subsampled image with what is known of it, against which components are judged.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) cloud: OrganizedCloud<'a>,
    pub(super) samples: &'a Samples,
    /// Height over the table.
    pub(super) height: AffineForm,
    pub(super) noise: DepthNoise,
    pub(super) tracks: &'a [ExpectedTrack],
    /// Bodies of the previous frame.
    pub(super) previous: Option<&'a BodyMap>,
    /// Motion since earlier frames; `None` without any.
    pub(super) motion: Option<MotionView<'a>>,
}

impl Scene<'_> {
    /// `true` when two neighbouring samples are of one surface.
    pub(super) fn is_connected(&self, one: usize, other: usize) -> bool {
        let z = self.samples.depth(one);
        (self.samples.depth(other) - z).abs() <= step_m(z, &self.noise)
    }

    /// Motion of the place of a sample.
    pub(super) fn motion(&self, sample: usize) -> Motion {
        let position = self.samples.position(sample);
        self.motion
            .map_or(Motion::Unknown, |view| view.motion(&position))
    }

    /// Colour of a sample.
    pub(super) fn color(&self, sample: usize) -> Rgba {
        let pixel = self.samples.pixel(sample, self.cloud.width());
        self.cloud.points()[pixel].color
    }

    /// Mark the tracks in whose boxes a sample is.
    pub(super) fn mark_claiming(&self, sample: usize, is_claiming: &mut [bool]) {
        let position = self.samples.position(sample);
        for (track, is_claiming) in self.tracks.iter().zip(is_claiming) {
            *is_claiming |= is_expected(std::slice::from_ref(track), &position);
        }
    }

    /// Logarithm of the ratio of a sample's likelihoods: of the colours of bodies to those of
    /// the tracks in whose boxes it is. Negative infinity where a track's colours are unknown.
    pub(super) fn body_log_likelihood_ratio(&self, sample: usize, body: &ColorHistogram) -> f32 {
        let (color, position) = (self.color(sample), self.samples.position(sample));
        let is_claiming =
            |track: &&ExpectedTrack| is_expected(std::slice::from_ref(*track), &position);
        let density = |track: &ExpectedTrack| match &track.colors {
            Some(colors) => colors.density(color),
            None => f32::INFINITY,
        };
        let claiming = self.tracks.iter().filter(is_claiming);
        (body.density(color) / claiming.map(density).fold(0.0, f32::max)).ln()
    }

    /// `true` when a sample is in the box of a live track.
    pub(super) fn is_tracked(&self, sample: usize) -> bool {
        is_expected(self.tracks, &self.samples.position(sample))
    }
}

/// Greatest depth step of one surface at a depth, metres.
pub(super) fn step_m(z: f32, noise: &DepthNoise) -> f32 {
    STEP_M * z + NOISE_SIGMAS * noise.sigma_m(z)
}
