//! Error terms of the simulated structured-light or active stereo camera.

use super::{
    AxialNoise, BorderSpeckle, ColorResponse, DepthRange, DisparityQuantisation, EdgeFattening,
    LateralNoise, MatchingWindow, ProjectorShadow, WeakSignal,
};
use crate::Error;
use value_range::check_range;

/// Error model of a structured-light or active stereo depth camera; `None` switches a term off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorModel {
    /// Distance between projector and camera, metres; 0.01 to 1. The Kinect's
    /// projector is on the right, seen along the optical axis.
    pub baseline_m: f32,
    /// Quantisation of disparity and depth.
    pub quantisation: Option<DisparityQuantisation>,
    /// Axial noise: depth varies between frames.
    pub axial_noise: Option<AxialNoise>,
    /// Lateral noise: ragged borders of objects.
    pub lateral_noise: Option<LateralNoise>,
    /// Edge fattening: objects look larger than they are.
    pub edge_fattening: Option<EdgeFattening>,
    /// Matching over a window: rounded steps, and noise that neighbouring pixels share.
    pub matching_window: Option<MatchingWindow>,
    /// Projector shadow: no depth where the projector, or the second camera, is occluded.
    pub projector_shadow: Option<ProjectorShadow>,
    /// Signal loss: no depth where too little light returns.
    pub weak_signal: Option<WeakSignal>,
    /// Border speckle: holes at depth discontinuities.
    pub border_speckle: Option<BorderSpeckle>,
    /// Range limits of depth.
    pub range: Option<DepthRange>,
    /// Number of columns without depth at the right border, where the matching window does not
    /// fit.
    pub n_blind_columns: usize,
    /// Response of the colour camera.
    pub color: ColorResponse,
}

impl SensorModel {
    /// Kinect v1 with all error terms.
    pub const KINECT_V1: Self = Self {
        baseline_m: 0.075,
        quantisation: Some(DisparityQuantisation::KINECT_V1),
        axial_noise: Some(AxialNoise::KINECT_V1),
        lateral_noise: Some(LateralNoise::KINECT_V1),
        edge_fattening: Some(EdgeFattening::KINECT_V1),
        matching_window: None,
        projector_shadow: Some(ProjectorShadow::KINECT_V1),
        weak_signal: Some(WeakSignal::KINECT_V1),
        border_speckle: Some(BorderSpeckle::KINECT_V1),
        range: Some(DepthRange::KINECT_V1),
        n_blind_columns: 8,
        color: ColorResponse::KINECT_V1,
    };

    /// Active stereo camera of 5 cm baseline, as the Intel `RealSense` D400 series: disparity in
    /// steps of 1/32 pixel (Keselman et al. 2017), matched over a window, on any surface that is
    /// lit. Fattening and range are estimates from pictures.
    pub const STEREO: Self = Self {
        baseline_m: 0.05,
        quantisation: Some(DisparityQuantisation { step_px: 0.031_25 }),
        axial_noise: None,
        lateral_noise: Some(LateralNoise::KINECT_V1),
        edge_fattening: Some(EdgeFattening {
            mean_px: 2.0,
            sigma_px: 0.8,
        }),
        matching_window: Some(MatchingWindow::STEREO),
        projector_shadow: Some(ProjectorShadow::KINECT_V1),
        weak_signal: None,
        border_speckle: None,
        range: Some(DepthRange {
            min_m: 0.25,
            max_m: 6.0,
        }),
        n_blind_columns: 0,
        color: ColorResponse::KINECT_V1,
    };

    /// Ideal sensor: exact depth in every pixel, colour without noise.
    pub const PERFECT: Self = Self {
        baseline_m: 0.075,
        quantisation: None,
        axial_noise: None,
        lateral_noise: None,
        edge_fattening: None,
        matching_window: None,
        projector_shadow: None,
        weak_signal: None,
        border_speckle: None,
        range: None,
        n_blind_columns: 0,
        color: ColorResponse::PERFECT,
    };

    /// Validates all parameters of the sensor model.
    ///
    /// # Errors
    /// [`Error::SensorModel`] for the first parameter out of its range; NaN is out of every
    /// range.
    pub fn validated(self) -> Result<Self, Error> {
        check_range("baseline_m", self.baseline_m, 0.01, 1.0)?;
        self.quantisation.map_or(Ok(()), |term| term.check())?;
        self.axial_noise.map_or(Ok(()), |term| term.check())?;
        self.lateral_noise.map_or(Ok(()), |term| term.check())?;
        self.edge_fattening.map_or(Ok(()), |term| term.check())?;
        self.matching_window.map_or(Ok(()), |term| term.check())?;
        self.projector_shadow.map_or(Ok(()), |term| term.check())?;
        self.weak_signal.map_or(Ok(()), |term| term.check())?;
        self.border_speckle.map_or(Ok(()), |term| term.check())?;
        self.range.map_or(Ok(()), |term| term.check())?;
        self.color.check()?;
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_presets_are_valid() {
        assert!(SensorModel::KINECT_V1.validated().is_ok());
        assert!(SensorModel::STEREO.validated().is_ok());
        assert!(SensorModel::PERFECT.validated().is_ok());
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        let model = SensorModel {
            baseline_m: f32::NAN,
            ..SensorModel::KINECT_V1
        };
        let message = model.validated().unwrap_err().to_string();
        assert!(message.contains("baseline_m"), "{message}");
    }
}
