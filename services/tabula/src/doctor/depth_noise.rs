//! Depth noise check of `tabula doctor`: the configured law and the noise on the table.

use super::{Finding, Severity};
use control_protocol::DepthNoiseReport;
use sensor_noise::DepthNoise;

const NAME: &str = "depth noise";

/// Least ratio to the configured law that is worth a warning, as in perception. Chosen.
const NOTABLE_RATIO: f64 = 1.3;

/// Finding without a daemon.
pub(super) fn without_daemon() -> Finding {
    let sentence = "no daemon runs, so none is measured";
    Finding::new(NAME, Severity::Ok, sentence)
}

/// Finding when the daemon does not tell the noise.
pub(super) fn unknown(reason: &str) -> Finding {
    Finding::new(NAME, Severity::Warning, format!("it is unknown: {reason}"))
}

/// Finding of a report: a warning if the noise is notably more than the configured law.
pub(super) fn finding(report: &DepthNoiseReport) -> Finding {
    let law = &report.law;
    let Some(ratio) = report.ratio else {
        let sentence = format!(
            "the law {law} is configured; no table was seen for a second, so the noise is not \
             measured yet"
        );
        return Finding::new(NAME, Severity::Ok, sentence);
    };
    if ratio < NOTABLE_RATIO {
        let sentence =
            format!("the noise measured on the table is {ratio:.1} times the configured law {law}");
        return Finding::new(NAME, Severity::Ok, sentence);
    }
    let advice = match report
        .table_depth_m
        .and_then(|depth_m| nearest_law(law, ratio, depth_m))
    {
        Some(nearest) => {
            format!("the law {nearest} is nearer; set [perception] depth_noise = \"{nearest}\"")
        }
        None => "no other law is nearer; detection and tracking allow for it, and a calibration \
                 of the camera may reduce its warp"
            .to_owned(),
    };
    let sentence = format!(
        "the noise and warp measured on the table is {ratio:.1} times the configured law {law}: \
         {advice}"
    );
    Finding::new(NAME, Severity::Warning, sentence)
}

/// Named law whose noise at the depth of the table is nearer to the measured one, as a factor,
/// than that of the configured law; `None` if there is none.
fn nearest_law(configured: &str, ratio: f64, depth_m: f64) -> Option<&'static str> {
    let sigma_m = |name: &str| Some(DepthNoise::named(name)?.bounded_sigma_m(depth_m));
    let measured_m = ratio * sigma_m(configured)?;
    let error = |name: &str| sigma_m(name).map_or(f64::INFINITY, |m| (m / measured_m).ln().abs());
    let nearest = DepthNoise::NAMES
        .into_iter()
        .min_by(|a, b| error(a).total_cmp(&error(b)))?;
    (nearest != configured).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(law: &str, ratio: Option<f64>, table_depth_m: Option<f64>) -> Finding {
        finding(&DepthNoiseReport {
            law: law.to_owned(),
            ratio,
            table_depth_m,
        })
    }

    #[test]
    fn noise_as_configured_or_not_measured_is_no_warning() {
        for ratio in [None, Some(1.0), Some(1.2)] {
            let finding = report("kinect-v1", ratio, Some(1.0));
            assert_eq!(finding.severity, Severity::Ok, "{finding:?}");
            assert!(finding.sentence.contains("kinect-v1"), "{finding:?}");
        }
    }

    #[test]
    fn more_noise_names_the_law_that_is_nearer() {
        // At 1.5 m: time of flight 1.8 mm, Kinect 3.5 mm, stereo 6.4 mm.
        for (law, ratio, nearer) in [
            ("time-of-flight", 1.9, Some("kinect-v1")),
            ("time-of-flight", 3.5, Some("stereo")),
            ("kinect-v1", 1.8, Some("stereo")),
            ("stereo", 2.0, None),
        ] {
            let finding = report(law, Some(ratio), Some(1.5));
            assert_eq!(finding.severity, Severity::Warning, "{finding:?}");
            let advice = nearer.map_or("no other law".to_owned(), |nearer| {
                format!("depth_noise = \"{nearer}\"")
            });
            assert!(finding.sentence.contains(&advice), "{finding:?}");
        }
    }
}
