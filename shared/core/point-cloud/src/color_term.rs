//! Basic colour terms: naming of colours by lightness, chroma and hue.

use crate::Rgba;
use std::sync::LazyLock;

/// Number of values of a channel in the lookup table.
const N_LEVELS: usize = 32;

/// Basic colour term of English.
///
/// *Source*: Berlin and Kay, "Basic Color Terms", 1969.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ColorTerm {
    /// Black.
    Black,
    /// White.
    White,
    /// Grey.
    Grey,
    /// Red.
    Red,
    /// Green.
    Green,
    /// Yellow.
    Yellow,
    /// Blue.
    Blue,
    /// Brown.
    Brown,
    /// Orange.
    Orange,
    /// Pink.
    Pink,
    /// Purple.
    Purple,
}

impl ColorTerm {
    /// All terms, in the order in which their shares are stored.
    pub const ALL: [Self; 11] = [
        Self::Black,
        Self::White,
        Self::Grey,
        Self::Red,
        Self::Green,
        Self::Yellow,
        Self::Blue,
        Self::Brown,
        Self::Orange,
        Self::Pink,
        Self::Purple,
    ];

    /// English word, in lower case and British spelling.
    pub fn word(self) -> &'static str {
        match self {
            Self::Black => "black",
            Self::White => "white",
            Self::Grey => "grey",
            Self::Red => "red",
            Self::Green => "green",
            Self::Yellow => "yellow",
            Self::Blue => "blue",
            Self::Brown => "brown",
            Self::Orange => "orange",
            Self::Pink => "pink",
            Self::Purple => "purple",
        }
    }

    /// Term of a colour, from a table of 32 values for each channel.
    pub fn of(color: Rgba) -> Self {
        static TERMS: LazyLock<Box<[ColorTerm]>> = LazyLock::new(terms);
        let step = 256 / N_LEVELS;
        let [red, green, blue] = color.rgb().map(|channel| usize::from(channel) / step);
        TERMS[(red * N_LEVELS + green) * N_LEVELS + blue]
    }
}

/// Terms of all cells of the table, blue fastest.
fn terms() -> Box<[ColorTerm]> {
    let value = |level: usize| (level as f64 + 0.5) / N_LEVELS as f64;
    let cells = 0..N_LEVELS * N_LEVELS * N_LEVELS;
    cells
        .map(|cell| {
            let [red, green] = [cell / N_LEVELS / N_LEVELS, cell / N_LEVELS % N_LEVELS];
            term_of_lab(lab([red, green, cell % N_LEVELS].map(value)))
        })
        .collect()
}

/// CIELAB values (CIE 1976, white point D65) of an sRGB colour with components from 0 to 1.
fn lab(srgb: [f64; 3]) -> [f64; 3] {
    let [red, green, blue] = srgb.map(|value| {
        if value <= 0.040_45 {
            value / 12.92
        } else {
            ((value + 0.055) / 1.055).powf(2.4)
        }
    });
    let x = (0.4124 * red + 0.3576 * green + 0.1805 * blue) / 0.9505;
    let y = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    let z = (0.0193 * red + 0.1192 * green + 0.9505 * blue) / 1.089;
    let [x, y, z] = [x, y, z].map(|t| {
        if t > 0.008_856 {
            t.cbrt()
        } else {
            7.787 * t + 16.0 / 116.0
        }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Term of a colour in CIELAB. The limits are chosen so that the colours that people call by a
/// term (Sturges and Whitfield, "Locating basic colours in the Munsell space", 1995) get it, for
/// surfaces that are seen by an indoor camera: white is rarely bright, black never dark.
fn term_of_lab([lightness, a, b]: [f64; 3]) -> ColorTerm {
    let chroma = a.hypot(b);
    let hue_deg = b.atan2(a).to_degrees().rem_euclid(360.0);
    // Dark colours look the more chromatic, the lighter they are.
    let grey_chroma_max = (5.0 + 0.1 * lightness).min(12.0);
    if lightness < 16.0 || (lightness < 26.0 && chroma < 10.0) {
        return ColorTerm::Black;
    }
    if chroma < grey_chroma_max {
        return if lightness > 76.0 {
            ColorTerm::White
        } else {
            ColorTerm::Grey
        };
    }
    match hue_deg {
        0.0..20.0 | 345.0..=360.0 if lightness > 58.0 => ColorTerm::Pink,
        0.0..20.0 | 345.0..=360.0 => ColorTerm::Red,
        20.0..46.0 if lightness > 66.0 && chroma < 50.0 => ColorTerm::Pink,
        20.0..46.0 if chroma > 38.0 + 0.25 * (lightness - 40.0).max(0.0) => ColorTerm::Red,
        20.0..46.0 => ColorTerm::Brown,
        46.0..74.0 if lightness > 52.0 && chroma > 48.0 => ColorTerm::Orange,
        46.0..74.0 if lightness > 80.0 && chroma < 20.0 => ColorTerm::White,
        46.0..74.0 => ColorTerm::Brown,
        74.0..108.0 if lightness > 84.0 && chroma < 18.0 => ColorTerm::White,
        74.0..108.0 if lightness > 56.0 && chroma > 34.0 => ColorTerm::Yellow,
        74.0..96.0 => ColorTerm::Brown,
        96.0..200.0 => ColorTerm::Green,
        200.0..304.0 => ColorTerm::Blue,
        _ if lightness > 64.0 => ColorTerm::Pink,
        _ => ColorTerm::Purple,
    }
}

/// Shares of the basic colour terms in an object's colours.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ColorShares([f32; ColorTerm::ALL.len()]);

impl ColorShares {
    /// Shares of the terms of the given colours; all 0 without any.
    pub fn of(colors: impl IntoIterator<Item = Rgba>) -> Self {
        let (mut counts, mut n) = ([0_u32; ColorTerm::ALL.len()], 0_u32);
        for color in colors {
            counts[ColorTerm::of(color) as usize] += 1;
            n += 1;
        }
        Self(counts.map(|count| count as f32 / n.max(1) as f32))
    }

    /// Shares in the order of [`ColorTerm::ALL`], 0 to 1.
    pub fn values(&self) -> [f32; ColorTerm::ALL.len()] {
        self.0
    }

    /// Share of one term, 0 to 1.
    pub fn share(&self, term: ColorTerm) -> f32 {
        self.0[term as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn color_terms_are_those_that_people_use() {
        let named = [
            ([20, 20, 22], ColorTerm::Black),
            ([240, 240, 236], ColorTerm::White),
            ([205, 204, 200], ColorTerm::White),
            ([128, 128, 128], ColorTerm::Grey),
            ([200, 30, 30], ColorTerm::Red),
            ([150, 20, 30], ColorTerm::Red),
            ([40, 140, 50], ColorTerm::Green),
            ([110, 190, 70], ColorTerm::Green),
            ([240, 220, 40], ColorTerm::Yellow),
            ([220, 190, 50], ColorTerm::Yellow),
            ([30, 60, 180], ColorTerm::Blue),
            ([90, 160, 220], ColorTerm::Blue),
            ([110, 70, 40], ColorTerm::Brown),
            ([160, 110, 60], ColorTerm::Brown),
            ([240, 140, 30], ColorTerm::Orange),
            ([240, 160, 180], ColorTerm::Pink),
            ([230, 90, 160], ColorTerm::Pink),
            ([110, 40, 130], ColorTerm::Purple),
        ];
        let wrong: Vec<_> = named
            .into_iter()
            .map(|([r, g, b], term)| ([r, g, b], term, ColorTerm::of(Rgba::opaque(r, g, b))))
            .filter(|(_, term, found)| term != found)
            .collect();
        assert!(wrong.is_empty(), "{wrong:?}");
    }

    #[test]
    fn color_terms_are_numbered_in_their_order() {
        for (number, term) in ColorTerm::ALL.into_iter().enumerate() {
            assert_eq!(term as usize, number);
        }
    }

    #[test]
    fn color_shares_count_terms() {
        let (red, white) = (Rgba::opaque(200, 30, 30), Rgba::opaque(240, 240, 240));
        let shares = ColorShares::of([red, white, red, red]);
        assert_eq!(shares.share(ColorTerm::Red), 0.75);
        assert_eq!(shares.share(ColorTerm::White), 0.25);
        assert_eq!(ColorShares::of([]), ColorShares::default());
    }
}
