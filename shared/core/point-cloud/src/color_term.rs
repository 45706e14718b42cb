//! Basic colour terms: naming of colours by lightness, chroma and hue.

use crate::Rgba;
use std::sync::LazyLock;

/// Number of values of a channel in the lookup table.
const N_LEVELS: usize = 32;

coded_enum::coded_enum! {
    /// Basic colour term of English.
    ///
    /// *Source*: Berlin and Kay, "Basic Color Terms", 1969.
    #[derive(Hash)]
    pub enum ColorTerm {
        /// Black.
        Black, "black";
        /// White.
        White, "white";
        /// Grey.
        Grey, "grey";
        /// Red.
        Red, "red";
        /// Green.
        Green, "green";
        /// Yellow.
        Yellow, "yellow";
        /// Blue.
        Blue, "blue";
        /// Brown.
        Brown, "brown";
        /// Orange.
        Orange, "orange";
        /// Pink.
        Pink, "pink";
        /// Purple.
        Purple, "purple";
    }
}

impl ColorTerm {
    /// Term of a colour, from a table of 32 values for each channel.
    pub fn of(color: Rgba) -> Self {
        cell_of(color.rgb()).term
    }
}

/// Cell of the lookup table.
#[derive(Debug, Clone, Copy)]
struct ColorCell {
    term: ColorTerm,
    /// Sector of the hue, or that of greys.
    hue: u8,
}

/// Number of sectors of hue, of 30 degrees each; greys have one of their own.
const N_HUES: usize = 12;

fn cell_of(rgb: [u8; 3]) -> ColorCell {
    static CELLS: LazyLock<Box<[ColorCell]>> = LazyLock::new(cells);
    let level = |channel: u8| usize::from(channel) * N_LEVELS / 256;
    let [red, green, blue] = rgb;
    CELLS[(level(red) * N_LEVELS + level(green)) * N_LEVELS + level(blue)]
}

/// All cells of the table, blue fastest.
fn cells() -> Box<[ColorCell]> {
    let value = |level: usize| (level as f64 + 0.5) / N_LEVELS as f64;
    let cells = 0..N_LEVELS * N_LEVELS * N_LEVELS;
    cells
        .map(|cell| {
            let [red, green] = [cell / N_LEVELS / N_LEVELS, cell / N_LEVELS % N_LEVELS];
            let lab = lab([red, green, cell % N_LEVELS].map(value));
            let term = term_of_lab(lab);
            let is_grey = matches!(term, ColorTerm::Black | ColorTerm::White | ColorTerm::Grey);
            let sector = (hue_deg(lab) / 360.0 * N_HUES as f64) as usize;
            ColorCell {
                term,
                hue: if is_grey {
                    N_HUES
                } else {
                    sector.min(N_HUES - 1)
                } as u8,
            }
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

/// Hue angle, 0 to 360 degrees.
fn hue_deg([_, a, b]: [f64; 3]) -> f64 {
    b.atan2(a).to_degrees().rem_euclid(360.0)
}

/// Term of a colour in CIELAB. The limits are chosen so that the colours that people call by a
/// term (Sturges and Whitfield, "Locating basic colours in the Munsell space", 1995) get it, for
/// surfaces that are seen by an indoor camera: white is rarely bright, black never dark.
fn term_of_lab([lightness, a, b]: [f64; 3]) -> ColorTerm {
    let chroma = a.hypot(b);
    let hue_deg = hue_deg([lightness, a, b]);
    // People discount the blue of shade.
    let is_bluish = (220.0..300.0).contains(&hue_deg);
    let grey_chroma_max = (5.0 + 0.1 * lightness).min(12.0) + if is_bluish { 5.0 } else { 0.0 };
    if lightness < 16.0 || (lightness < 32.0 && chroma < 10.0) {
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
        46.0..74.0 if lightness > 40.0 && chroma > 56.0 => ColorTerm::Orange,
        46.0..74.0 if lightness > 80.0 && chroma < 20.0 => ColorTerm::White,
        46.0..74.0 => ColorTerm::Brown,
        74.0..108.0 if lightness > 84.0 && chroma < 18.0 => ColorTerm::White,
        74.0..108.0 if lightness > 56.0 && chroma > 34.0 => ColorTerm::Yellow,
        108.0..115.0 if lightness > 70.0 && chroma > 45.0 => ColorTerm::Yellow,
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
    /// Shares of the terms of an object's colours; all 0 without any.
    ///
    /// The shaded side of a thing is called by the colour of its lit side: a pixel with the hue of
    /// brighter ones is named at their brightness, down to half of it.
    pub fn of(colors: impl Iterator<Item = Rgba> + Clone) -> Self {
        let lit = LitValues::of(colors.clone());
        let (mut counts, mut n) = ([0_u32; ColorTerm::ALL.len()], 0_u32);
        for color in colors {
            counts[cell_of(lit.unshaded(color.rgb())).term as usize] += 1;
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

/// Share of the pixels of a hue that are brighter than its lit value.
const LIT_SHARE: f32 = 0.08;

/// Greatest factor by which a shaded pixel is brightened. Chosen: the side of a box away from the
/// lamp has about half the light of its top.
const SHADE_MAX: f32 = 2.0;

/// Least lit value of a grey thing whose shade is named by it; a darker one is grey or black.
/// Chosen.
const LIT_GREY_MIN: u8 = 140;

/// Brightness of the lit side by sector of hue: a high quantile of the greatest channel.
struct LitValues([u8; N_HUES + 1]);

impl LitValues {
    fn of(colors: impl Iterator<Item = Rgba>) -> Self {
        let mut counts = [[0_u32; N_LEVELS]; N_HUES + 1];
        for color in colors {
            let rgb = color.rgb();
            let level = usize::from(greatest(rgb)) * N_LEVELS / 256;
            counts[usize::from(cell_of(rgb).hue)][level] += 1;
        }
        Self(counts.map(|of_hue| {
            let n: u32 = of_hue.iter().sum();
            let mut n_brighter = 0;
            let level = (0..N_LEVELS).rev().find(|&level| {
                n_brighter += of_hue[level];
                n_brighter as f32 >= LIT_SHARE * n as f32 && n > 0
            });
            (level.unwrap_or(0) * 256 / N_LEVELS + 4) as u8
        }))
    }

    /// Colour at the brightness of the lit side of its hue.
    fn unshaded(&self, rgb: [u8; 3]) -> [u8; 3] {
        let hue = usize::from(cell_of(rgb).hue);
        let lit = self.0[hue];
        if hue == N_HUES && lit < LIT_GREY_MIN {
            return rgb;
        }
        let factor = f32::from(lit) / f32::from(greatest(rgb)).max(1.0);
        if !(1.0..=SHADE_MAX).contains(&factor) {
            return rgb;
        }
        let brightened = |channel: u8| (f32::from(channel) * factor).min(255.0) as u8;
        let [red, green, blue] = rgb;
        [brightened(red), brightened(green), brightened(blue)]
    }
}

fn greatest([red, green, blue]: [u8; 3]) -> u8 {
    red.max(green).max(blue)
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
        let shares = ColorShares::of([red, white, red, red].into_iter());
        assert_eq!(shares.share(ColorTerm::Red), 0.75);
        assert_eq!(shares.share(ColorTerm::White), 0.25);
        assert_eq!(ColorShares::of(std::iter::empty()), ColorShares::default());
    }

    #[test]
    fn color_shares_call_the_shaded_side_by_the_lit_one() {
        let orange = |shade: f32| {
            let [red, green, blue] = [240.0, 140.0, 30.0].map(|c: f32| (c * shade) as u8);
            Rgba::opaque(red, green, blue)
        };
        assert_eq!(ColorTerm::of(orange(0.55)), ColorTerm::Brown);
        let ball = (0..40).map(|i| orange(0.55 + 0.45 * i as f32 / 39.0));
        assert!(ColorShares::of(ball).share(ColorTerm::Orange) > 0.95);
        let brown = (0..40).map(|_| orange(0.55));
        assert!(ColorShares::of(brown).share(ColorTerm::Brown) > 0.95);
        let (white, black) = (Rgba::opaque(230, 230, 230), Rgba::opaque(25, 25, 25));
        let dice = ColorShares::of([white, black].into_iter());
        assert_eq!(dice.share(ColorTerm::Black), 0.5);
    }
}
