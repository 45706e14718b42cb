//! Depth noise of the camera, as perception has it: the configured law and the measured ratio.

use control_client::ask_once;
use control_protocol::{DepthNoiseReport, request};
use sensor_noise::DepthNoise;
use service::{CommonArguments, Failure};

/// Depth noise of the daemon's camera.
///
/// # Errors
/// If perception does not answer, or its law is not known here.
pub fn camera_depth_noise(common: &CommonArguments) -> Result<DepthNoise, Failure> {
    let report = ask_once(common, &request::depth_noise())?;
    reported_noise(&report).ok_or_else(|| {
        let law = &report.law;
        Failure::general(format!("perception has the unknown depth noise {law:?}"))
    })
}

/// Law of a report, as many times as the noise was measured to be; `None` for an unknown law.
fn reported_noise(report: &DepthNoiseReport) -> Option<DepthNoise> {
    let ratio = report.ratio.filter(|ratio| ratio.is_finite());
    DepthNoise::named(&report.law).map(|law| law.scaled(ratio.unwrap_or(1.0) as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_the_law_times_the_measured_ratio() {
        let noise = |law: &str, ratio| {
            reported_noise(&DepthNoiseReport {
                law: law.to_owned(),
                ratio,
                table_depth_m: None,
            })
        };
        assert_eq!(noise("stereo", None), Some(DepthNoise::STEREO));
        let doubled = DepthNoise::TIME_OF_FLIGHT.scaled(2.0);
        assert_eq!(noise("time-of-flight", Some(2.0)), Some(doubled));
        assert_eq!(noise("sonar", Some(2.0)), None);
    }
}
