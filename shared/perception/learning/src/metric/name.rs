//! The names under which metrics are asked for.

use super::Metric;
use std::fmt;
use std::str::FromStr;

/// No metric has this name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownMetric {
    /// What was asked for.
    pub name: String,
}

impl Metric {
    const fn name(self) -> &'static str {
        match self {
            Self::HalfChiSquaredRoot => "half-chi-squared-root",
            Self::ChiSquared => "chi-squared",
            Self::Manhattan => "manhattan",
            Self::Euclidean => "euclidean",
            Self::Gower => "gower",
            Self::Canberra => "canberra",
            Self::Divergence => "divergence",
            Self::Pearson => "pearson",
            Self::Neyman => "neyman",
            Self::Hellinger => "hellinger",
            Self::KullbackLeibler => "kl",
            Self::SymmetricKullbackLeibler => "symmetric-kl",
            Self::Motyka => "motyka",
            Self::Sorensen => "sorensen",
            Self::Dice => "dice",
            Self::Cosine => "cosine",
            Self::Intersection => "intersection",
            Self::Bhattacharyya => "bhattacharyya",
        }
    }
}

impl fmt::Display for Metric {
    /// The name, in lower case with hyphens.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Metric {
    type Err = UnknownMetric;

    /// Reads a name; upper case, hyphens, underscores and spaces make no difference,
    /// so the authors' `chiSquared` and `symmetricKL` are understood, too.
    fn from_str(text: &str) -> Result<Self, UnknownMetric> {
        let asked = letters(text);
        let is_asked = |metric: &Self| letters(metric.name()) == asked;
        Self::ALL
            .into_iter()
            .find(is_asked)
            .ok_or_else(|| UnknownMetric {
                name: text.to_owned(),
            })
    }
}

fn letters(name: &str) -> String {
    name.chars()
        .filter(|c| !matches!(c, '-' | '_' | ' '))
        .map(|c| c.to_ascii_lowercase())
        .collect()
}

impl fmt::Display for UnknownMetric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> = Metric::ALL.map(Metric::name).into();
        write!(
            f,
            "there is no metric \"{}\": choose one of {}",
            self.name,
            names.join(", ")
        )
    }
}

impl std::error::Error for UnknownMetric {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_metric_is_found_by_the_name_it_shows() {
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
    fn another_name_is_refused_by_a_sentence_with_all_names() {
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
