//! What may be set.

use std::fmt;

/// Settings as written down, not yet checked. The default fits a Kinect v1
/// that looks at a table from 0.5 to 1.5 m.
#[derive(Debug, Clone, PartialEq)]
pub struct RawConfig {
    /// Nearest depth that is used, metres; 0.1 to 10.
    pub range_min_m: f64,
    /// Farthest depth that is used, metres; above the nearest, to 10.
    pub range_max_m: f64,
    /// Least half width of the band of points that belong to a plane, metres;
    /// 0.001 to 0.1. Where three sigma of the depth noise are more, they count.
    pub plane_band_min_m: f64,
    /// Greatest angle between the table's normal and up, radians; 0 to 0.8.
    /// Used only where up is known.
    pub table_tilt_max_rad: f64,
    /// Least height of an object's points over the table, metres; 0.001 to 0.1.
    pub height_min_m: f64,
    /// Greatest height of an object's points, metres; above the least, to 3.
    pub height_max_m: f64,
    /// Fewest points of an object at 1 m; at depth z it needs this over z²;
    /// 1 to 100 000.
    pub points_min_at_1m: f64,
    /// Least length of an object's longest side, metres; 0.001 to 1.
    pub side_min_m: f64,
    /// Greatest length of an object's longest side, metres; above the least, to 5.
    pub side_max_m: f64,
    /// How far over the table the lowest points of a standing object may
    /// begin, metres; 0.001 to 0.5.
    pub standing_gap_max_m: f64,
}

impl Default for RawConfig {
    fn default() -> Self {
        Self {
            range_min_m: 0.35,
            range_max_m: 2.0,
            plane_band_min_m: 0.008,
            table_tilt_max_rad: 12_f64.to_radians(),
            height_min_m: 0.008,
            height_max_m: 0.60,
            points_min_at_1m: 100.0,
            side_min_m: 0.02,
            side_max_m: 0.80,
            standing_gap_max_m: 0.03,
        }
    }
}

/// Checked settings.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Config {
    raw: RawConfig,
}

/// A setting outside its range.
#[derive(Debug, Clone, PartialEq)]
pub struct InvalidConfig {
    name: &'static str,
    value: f64,
    min: f64,
    max: f64,
}

impl fmt::Display for InvalidConfig {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            value,
            min,
            max,
        } = self;
        write!(
            f,
            "the detection setting {name} is {value} but must lie between {min} and {max}"
        )
    }
}

impl std::error::Error for InvalidConfig {}

impl Config {
    /// Checks settings.
    ///
    /// # Errors
    /// Names the first setting outside its range; NaN is outside every range.
    pub fn new(raw: RawConfig) -> Result<Self, InvalidConfig> {
        for (name, value, min, max) in [
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
        ] {
            if !(min..=max).contains(&value) {
                return Err(InvalidConfig {
                    name,
                    value,
                    min,
                    max,
                });
            }
        }
        Ok(Self { raw })
    }

    /// The settings.
    pub fn get(&self) -> &RawConfig {
        &self.raw
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_valid() {
        assert_eq!(Config::new(RawConfig::default()), Ok(Config::default()));
    }

    #[test]
    fn a_setting_out_of_range_is_named() {
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
        ] {
            let message = Config::new(bad).unwrap_err().to_string();
            assert!(message.contains(name), "{message}");
        }
    }
}
