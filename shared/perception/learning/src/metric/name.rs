//! Names of metrics, for display and parsing.

use super::Metric;
use std::fmt;
use std::str::FromStr;

/// Parse error: no metric has this name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no metric \"{name}\": choose one of {}", Metric::ALL.map(Metric::word).join(", "))]
pub struct UnknownMetric {
    /// Requested metric name.
    pub name: String,
}

impl fmt::Display for Metric {
    /// Writes the name in lower case with hyphens.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

impl FromStr for Metric {
    type Err = UnknownMetric;

    /// Parses a name. Case, hyphens, underscores and spaces are ignored, so that the
    /// authors' `chiSquared` and `symmetricKL` are accepted.
    fn from_str(text: &str) -> Result<Self, UnknownMetric> {
        let asked = normalised(text);
        let is_asked = |metric: &Self| normalised(metric.word()) == asked;
        Self::ALL
            .into_iter()
            .find(is_asked)
            .ok_or_else(|| UnknownMetric {
                name: text.to_owned(),
            })
    }
}

fn normalised(name: &str) -> String {
    name.chars()
        .filter(|c| !matches!(c, '-' | '_' | ' '))
        .map(|c| c.to_ascii_lowercase())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_metric_parses_its_displayed_name() {
        for metric in Metric::ALL {
            assert_eq!(metric.to_string().parse(), Ok(metric));
        }
        for (name, metric) in [
            ("chiSquared", Metric::ChiSquared),
            ("symmetricKL", Metric::SymmetricKullbackLeibler),
            ("Half Chi_squared root", Metric::HalfChiSquaredRoot),
        ] {
            assert_eq!(name.parse(), Ok(metric));
        }
        assert_eq!(format!("{:>6}", Metric::Dice), "  dice");
    }

    #[test]
    fn an_unknown_name_is_rejected_with_all_valid_names() {
        for name in ["", "kll", "chi"] {
            let sentence = name.parse::<Metric>().unwrap_err().to_string();
            assert!(sentence.starts_with(&format!("there is no metric \"{name}\": choose")));
            assert!(
                Metric::ALL
                    .iter()
                    .all(|m| sentence.contains(&m.to_string()))
            );
        }
    }
}
