//! Sizes: dimensions of a box, degrees of adjectives, and measures in metres.

use crate::box_geometry::BoxGeometry;

/// Dimension of a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dimension {
    /// Edge of the cube of equal volume.
    Volume,
    /// Longest edge, for "smaller than 10 cm".
    Extent,
    /// Vertical extent.
    Height,
    /// Longer edge of the footprint, or the height if that is longer.
    Length,
    /// Longer edge of the footprint.
    Width,
    /// Shortest edge.
    Thickness,
    /// Footprint relative to the height.
    Flatness,
}

/// Direction of an adjective on its scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Degree {
    /// "big"
    More,
    /// "small"
    Less,
}

/// Form of an adjective.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AdjectiveForm {
    /// "big"
    Positive,
    /// "bigger"
    Comparative,
    /// "biggest"
    Superlative,
}

/// Bound that a measure sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bound {
    /// "about 20 cm"
    About,
    /// "more than 20 cm"
    More,
    /// "less than 20 cm"
    Less,
}

/// Ratio of two sizes that a person sees as different.
/// Chosen; Weber fractions of length are 2 to 3 %, and the boxes are less exact than that.
const VISIBLE_RATIO: f64 = 1.1;

/// Relative error of a spoken measure. Chosen.
const MEASURE_ERROR: f64 = 0.2;

/// Error of a box's edge. Chosen.
const EDGE_ERROR_M: f64 = 0.01;

impl Dimension {
    /// Value of the dimension for a box: metres, or a ratio for `Flatness`.
    pub(crate) fn of(self, geometry: &BoxGeometry) -> f64 {
        let [shorter, longer] = geometry.footprint_edges_m();
        let height = geometry.height_m();
        match self {
            Self::Volume => (shorter * longer * height).cbrt(),
            Self::Extent | Self::Length => longer.max(height),
            Self::Height => height,
            Self::Width => longer,
            Self::Thickness => shorter.min(height),
            Self::Flatness => longer / height.max(1e-3),
        }
    }

    /// Value on a scale where the error is constant: metres for one edge, otherwise a logarithm.
    pub(crate) fn scale(self, geometry: &BoxGeometry) -> f64 {
        let value = self.of(geometry);
        match self {
            Self::Volume | Self::Flatness => value.max(1e-6).ln(),
            _ => value,
        }
    }

    /// Error of the difference of two values on that scale between objects of one category: the
    /// median over 221 tracks of `evaluate find --seed 21 --scenes 30` for a volume, and the
    /// 84th percentile for a height. The others are estimates.
    pub(crate) fn scale_error(self) -> f64 {
        match self {
            Self::Volume => 0.02,
            Self::Flatness => 0.04,
            Self::Height => 0.002,
            Self::Extent | Self::Length | Self::Width | Self::Thickness => 0.004,
        }
    }

    /// Comparative of the adjective for a dimension and a degree.
    pub(crate) fn comparative(self, degree: Degree) -> String {
        match self.adjective(degree) {
            "big" => "bigger".to_owned(),
            "thin" => "thinner".to_owned(),
            "flat" => "flatter".to_owned(),
            "wide" => "wider".to_owned(),
            "upright" => "less flat".to_owned(),
            adjective => format!("{adjective}er"),
        }
    }

    /// Adjective for a dimension and a degree.
    pub(crate) fn adjective(self, degree: Degree) -> &'static str {
        let [more, less] = match self {
            Self::Volume | Self::Extent => ["big", "small"],
            Self::Height => ["tall", "short"],
            Self::Length => ["long", "short"],
            Self::Width => ["wide", "narrow"],
            Self::Thickness => ["thick", "thin"],
            Self::Flatness => ["flat", "upright"],
        };
        match degree {
            Degree::More => more,
            Degree::Less => less,
        }
    }
}

/// Score of "big" for a value among those of the candidates, 0 for the smallest, 1 for the biggest.
///
/// None if the candidates hardly differ.
pub(crate) fn relative_score(value: f64, all: &[f64], degree: Degree) -> Option<f64> {
    let smallest = all.iter().copied().fold(f64::INFINITY, f64::min).max(1e-6);
    let biggest = all.iter().copied().fold(1e-6, f64::max);
    let range = (biggest / smallest).ln();
    if range.is_nan() || range <= VISIBLE_RATIO.ln() {
        return None;
    }
    let position = ((value.max(1e-6) / smallest).ln() / range).clamp(0.0, 1.0);
    Some(match degree {
        Degree::More => position,
        Degree::Less => 1.0 - position,
    })
}

/// Score of "bigger than": 1 from the visible ratio on, 0 for a smaller one.
pub(crate) fn comparative_score(value: f64, other: f64, degree: Degree) -> f64 {
    let ratio = (value.max(1e-6) / other.max(1e-6)).ln() / VISIBLE_RATIO.ln();
    let signed = match degree {
        Degree::More => ratio,
        Degree::Less => -ratio,
    };
    signed.clamp(0.0, 1.0)
}

/// Score of a measured size for a spoken measure.
pub(crate) fn measure_score(value_m: f64, bound: Bound, measure_m: f64) -> f64 {
    let error_m = match bound {
        Bound::About => MEASURE_ERROR * measure_m + EDGE_ERROR_M,
        Bound::More | Bound::Less => EDGE_ERROR_M,
    };
    let excess = (value_m - measure_m) / error_m;
    let distance = match bound {
        Bound::About => excess.abs(),
        Bound::More => (-excess).max(0.0),
        Bound::Less => excess.max(0.0),
    };
    (-0.5 * distance * distance).exp()
}
