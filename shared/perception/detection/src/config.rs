//! Detection settings and their validation.

use constraint::{Expression, InvalidExpression};
use sensor_noise::DepthNoise;
use thiserror::Error;
use value_range::{OutOfRange, check_ranges};

/// Detection settings as written, not validated. The default fits a Kinect v1 that views a
/// table from 0.5 to 1.5 m. The numeric defaults are chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct RawConfig {
    /// Least used depth, metres; 0.1 to 10.
    pub range_min_m: f64,
    /// Greatest used depth, metres; above the least, to 10.
    pub range_max_m: f64,
    /// Least half width of the inlier band of a plane, metres; 0.001 to 0.1. Three sigma of
    /// the depth noise apply where they exceed it.
    pub plane_band_min_m: f64,
    /// Depth noise law of the camera. On an organised cloud it is scaled up to the noise that
    /// is measured on the table.
    pub depth_noise: DepthNoise,
    /// Greatest angle between the table's normal and up, radians; 0 to 0.8. Applies only
    /// when up is known.
    pub table_tilt_max_rad: f64,
    /// Least height of an object's points over the table, metres; 0.001 to 0.1.
    pub height_min_m: f64,
    /// Greatest height of an object's points over the table, metres; above the least, to 3.
    pub height_max_m: f64,
    /// `true` to make one object of its parts that are not connected in the depth image, such as
    /// the inside and the outside of a bowl; `false` to make each an object.
    pub joins_parts: bool,
    /// Least number of points of an object at 1 m, 1 to 100 000; divided by z² at depth z.
    pub points_min_at_1m: f64,
    /// Least length of an object's longest side, metres; 0.001 to 1.
    pub side_min_m: f64,
    /// Greatest length of an object's longest side, metres; above the least, to 5.
    pub side_max_m: f64,
    /// Greatest height of the lowest points of a standing object over the table, metres;
    /// 0.001 to 0.5.
    pub standing_gap_max_m: f64,
    /// Rule by which a candidate begins a track, see
    /// [`Expression`](constraint::Expression).
    pub rule: String,
    /// Least intersection over union with a track's box at which the track explains a
    /// candidate; 0.01 to 1.
    pub track_overlap_max: f64,
    /// Least share of the points inside grown track boxes at which the tracks explain a
    /// candidate; 0.01 to 1.
    pub track_points_share_max: f64,
    /// Greatest longest side of a graspable object, metres; 0.01 to 5.
    pub graspable_side_max_m: f64,
    /// Greatest second longest side of a graspable object, metres; 0.01 to 5.
    pub graspable_second_side_max_m: f64,
    /// Greatest box volume of a graspable object, cubic metres; 1e-6 to 10.
    pub graspable_volume_max_m3: f64,
    /// Self-filter margin around a person's capsules, metres; 0 to 0.5. Nearer points
    /// belong to the person.
    pub person_margin_m: f64,
    /// Self-filter margin around the robot's capsules, metres; 0 to 0.5. Nearer points
    /// belong to the robot.
    pub robot_margin_m: f64,
    /// Width of the rim zone of the table, metres; 0 to 1.
    pub rim_distance_m: f64,
    /// Share of a candidate's points in the rim zone above which it stands at the rim; 0 to
    /// 1.
    pub rim_share_max: f64,
}

impl Default for RawConfig {
    fn default() -> Self {
        Self {
            range_min_m: 0.35,
            range_max_m: 2.0,
            plane_band_min_m: 0.008,
            depth_noise: DepthNoise::default(),
            table_tilt_max_rad: 12_f64.to_radians(),
            height_min_m: 0.008,
            height_max_m: 0.60,
            joins_parts: true,
            points_min_at_1m: 100.0,
            side_min_m: 0.02,
            side_max_m: 0.80,
            standing_gap_max_m: 0.03,
            rule: Expression::default().to_string(),
            track_overlap_max: 0.3,
            track_points_share_max: 0.5,
            graspable_side_max_m: 0.35,
            graspable_second_side_max_m: 0.25,
            graspable_volume_max_m3: 0.012,
            person_margin_m: 0.05,
            robot_margin_m: 0.03,
            rim_distance_m: 0.03,
            rim_share_max: 0.05,
        }
    }
}

/// Validated detection settings.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Config {
    raw: RawConfig,
    rule: Expression,
}

/// Error of an invalid detection setting.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum InvalidConfig {
    /// Setting outside its valid range.
    #[error("the detection setting {0}")]
    OutOfRange(#[from] OutOfRange),
    /// Constraint rule that cannot be parsed.
    #[error("{0}")]
    Rule(#[source] InvalidExpression),
}

impl Config {
    /// Validates detection settings.
    ///
    /// # Errors
    ///
    /// Names the first setting outside its range; NaN is outside every range. Quotes a rule
    /// that cannot be parsed.
    pub fn new(raw: RawConfig) -> Result<Self, InvalidConfig> {
        check_ranges(&[
            ("range_min_m", raw.range_min_m, 0.1, 10.0),
            ("range_max_m", raw.range_max_m, raw.range_min_m, 10.0),
            ("plane_band_min_m", raw.plane_band_min_m, 0.001, 0.1),
            ("table_tilt_max_rad", raw.table_tilt_max_rad, 0.0, 0.8),
            ("height_min_m", raw.height_min_m, 0.001, 0.1),
            ("height_max_m", raw.height_max_m, raw.height_min_m, 3.0),
            ("points_min_at_1m", raw.points_min_at_1m, 1.0, 1e5),
            ("side_min_m", raw.side_min_m, 0.001, 1.0),
            ("side_max_m", raw.side_max_m, raw.side_min_m, 5.0),
            ("standing_gap_max_m", raw.standing_gap_max_m, 0.001, 0.5),
            ("track_overlap_max", raw.track_overlap_max, 0.01, 1.0),
            (
                "track_points_share_max",
                raw.track_points_share_max,
                0.01,
                1.0,
            ),
            ("graspable_side_max_m", raw.graspable_side_max_m, 0.01, 5.0),
            (
                "graspable_second_side_max_m",
                raw.graspable_second_side_max_m,
                0.01,
                5.0,
            ),
            (
                "graspable_volume_max_m3",
                raw.graspable_volume_max_m3,
                1e-6,
                10.0,
            ),
            ("person_margin_m", raw.person_margin_m, 0.0, 0.5),
            ("robot_margin_m", raw.robot_margin_m, 0.0, 0.5),
            ("rim_distance_m", raw.rim_distance_m, 0.0, 1.0),
            ("rim_share_max", raw.rim_share_max, 0.0, 1.0),
        ])?;
        let rule = raw.rule.parse().map_err(InvalidConfig::Rule)?;
        Ok(Self { raw, rule })
    }

    /// Parsed rule by which a candidate begins a track.
    pub fn rule(&self) -> &Expression {
        &self.rule
    }

    /// The same settings, with the parts of an object apart: for resampled images, in which gaps
    /// are narrower than the camera's, so that neighbours would be joined across them.
    pub(crate) fn without_joined_parts(&self) -> Self {
        let mut config = self.clone();
        config.raw.joins_parts = false;
        config
    }

    /// Detection settings as written.
    pub fn get(&self) -> &RawConfig {
        &self.raw
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_settings_are_valid() {
        assert_eq!(Config::new(RawConfig::default()), Ok(Config::default()));
    }

    #[test]
    fn invalid_setting_is_named() {
        let good = RawConfig::default();
        for (bad, name) in [
            (
                RawConfig {
                    range_min_m: f64::NAN,
                    ..good.clone()
                },
                "range_min_m",
            ),
            (
                RawConfig {
                    range_max_m: 0.2,
                    ..good.clone()
                },
                "range_max_m",
            ),
            (
                RawConfig {
                    height_max_m: f64::INFINITY,
                    ..good.clone()
                },
                "height_max_m",
            ),
            (
                RawConfig {
                    points_min_at_1m: 0.0,
                    ..good.clone()
                },
                "points_min_at_1m",
            ),
            (
                RawConfig {
                    side_max_m: -1.0,
                    ..good.clone()
                },
                "side_max_m",
            ),
            (
                RawConfig {
                    rim_share_max: 1.5,
                    ..good.clone()
                },
                "rim_share_max",
            ),
            (
                RawConfig {
                    rule: "C_table and C_unicorn".into(),
                    ..good.clone()
                },
                "C_unicorn",
            ),
        ] {
            let message = Config::new(bad).unwrap_err().to_string();
            assert!(message.contains(name), "{message}");
        }
    }
}
