//! Which errors the sensor makes.

use super::{
    AxialNoise, BorderSpeckle, ColorResponse, DepthRange, DisparityQuantisation, EdgeFattening,
    LateralNoise, ProjectorShadow, WeakSignal,
};
use crate::Error;

/// The errors of a structured-light camera; `None` switches one off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorModel {
    /// Distance between projector and camera, metres; 0.01 to 1. The Kinect's
    /// projector is on the right, seen along the optical axis.
    pub baseline_m: f32,
    /// Depth comes in steps.
    pub quantisation: Option<DisparityQuantisation>,
    /// Depth varies from frame to frame.
    pub axial_noise: Option<AxialNoise>,
    /// Borders of objects are ragged.
    pub lateral_noise: Option<LateralNoise>,
    /// Objects look larger than they are.
    pub edge_fattening: Option<EdgeFattening>,
    /// No depth where the projector's light does not arrive.
    pub projector_shadow: Option<ProjectorShadow>,
    /// No depth where too little light comes back.
    pub weak_signal: Option<WeakSignal>,
    /// Speckled holes at borders.
    pub border_speckle: Option<BorderSpeckle>,
    /// No depth too near and too far.
    pub range: Option<DepthRange>,
    /// Columns without depth at the right border; the matching window does not fit there.
    pub n_blind_columns: usize,
    /// How the colour camera sees.
    pub color: ColorResponse,
}

impl SensorModel {
    /// A Kinect v1 with all its errors.
    pub const KINECT_V1: Self = Self {
        baseline_m: 0.075,
        quantisation: Some(DisparityQuantisation::KINECT_V1),
        axial_noise: Some(AxialNoise::KINECT_V1),
        lateral_noise: Some(LateralNoise::KINECT_V1),
        edge_fattening: Some(EdgeFattening::KINECT_V1),
        projector_shadow: Some(ProjectorShadow::KINECT_V1),
        weak_signal: Some(WeakSignal::KINECT_V1),
        border_speckle: Some(BorderSpeckle::KINECT_V1),
        range: Some(DepthRange::KINECT_V1),
        n_blind_columns: 8,
        color: ColorResponse::KINECT_V1,
    };

    /// Exact depth in every pixel, colour without noise.
    pub const PERFECT: Self = Self {
        baseline_m: 0.075,
        quantisation: None,
        axial_noise: None,
        lateral_noise: None,
        edge_fattening: None,
        projector_shadow: None,
        weak_signal: None,
        border_speckle: None,
        range: None,
        n_blind_columns: 0,
        color: ColorResponse::PERFECT,
    };

    /// Checks all parameters.
    ///
    /// # Errors
    /// Names the first that is out of its range; NaN is out of every range.
    pub fn validated(self) -> Result<Self, Error> {
        check("baseline_m", self.baseline_m, 0.01, 1.0)?;
        self.quantisation.map_or(Ok(()), |term| term.check())?;
        self.axial_noise.map_or(Ok(()), |term| term.check())?;
        self.lateral_noise.map_or(Ok(()), |term| term.check())?;
        self.edge_fattening.map_or(Ok(()), |term| term.check())?;
        self.projector_shadow.map_or(Ok(()), |term| term.check())?;
        self.weak_signal.map_or(Ok(()), |term| term.check())?;
        self.border_speckle.map_or(Ok(()), |term| term.check())?;
        self.range.map_or(Ok(()), |term| term.check())?;
        self.color.check()?;
        Ok(self)
    }
}

/// Whether a parameter is in its range.
pub(super) fn check(name: &'static str, value: f32, min: f32, max: f32) -> Result<(), Error> {
    if (min..=max).contains(&value) {
        Ok(())
    } else {
        Err(Error::SensorModel {
            name,
            value,
            min,
            max,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_presets_are_valid() {
        assert!(SensorModel::KINECT_V1.validated().is_ok());
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
