//! Material colour palettes and colour mixing.

/// sRGB colour: red, green, blue.
pub(crate) type Rgb = [u8; 3];

/// Off-white, instead of pure white.
pub(crate) const WHITE: Rgb = [240, 240, 236];
/// Off-black, instead of pure black.
pub(crate) const BLACK: Rgb = [28, 28, 30];
/// Colour of steel.
pub(crate) const STEEL: Rgb = [176, 180, 186];
/// Colour of brass.
pub(crate) const BRASS: Rgb = [190, 158, 84];
/// Green of leaves.
pub(crate) const LEAF: Rgb = [72, 124, 48];
/// Brown of bark and stems.
pub(crate) const BARK: Rgb = [104, 76, 46];

/// Colours of ceramic glazes.
pub(crate) const GLAZES: [Rgb; 9] = [
    WHITE,
    [228, 216, 190],
    [52, 92, 150],
    [60, 128, 124],
    [172, 62, 48],
    [222, 172, 62],
    [96, 128, 84],
    [128, 88, 132],
    [78, 78, 84],
];
/// Colours of plastics.
pub(crate) const PLASTICS: [Rgb; 10] = [
    [214, 44, 40],
    [32, 98, 190],
    [246, 198, 30],
    [40, 150, 76],
    [238, 122, 30],
    [126, 66, 160],
    [30, 160, 178],
    [226, 84, 140],
    WHITE,
    [60, 62, 68],
];
/// Colours of tool handles.
pub(crate) const GRIPS: [Rgb; 6] = [
    [200, 36, 34],
    [30, 84, 168],
    [240, 180, 24],
    [226, 104, 26],
    [36, 122, 62],
    [46, 46, 50],
];
/// Colours of woods.
pub(crate) const WOODS: [Rgb; 4] = [
    [196, 152, 98],
    [168, 116, 66],
    [130, 84, 48],
    [212, 176, 124],
];
/// Colours of metals.
pub(crate) const METALS: [Rgb; 4] = [STEEL, [196, 198, 202], [150, 154, 160], [188, 184, 176]];
/// Pastel colours of paper and cloth.
pub(crate) const PASTELS: [Rgb; 6] = [
    [236, 208, 214],
    [202, 222, 236],
    [214, 232, 206],
    [244, 234, 198],
    [224, 212, 236],
    [240, 240, 236],
];

/// Linear blend of two colours: `share` 0 gives the first, 1 the second.
pub(crate) fn mix(a: Rgb, b: Rgb, share: f32) -> Rgb {
    let share = share.clamp(0.0, 1.0);
    std::array::from_fn(|i| {
        let (a, b) = (f32::from(a[i]), f32::from(b[i]));
        (a + (b - a) * share).round() as u8
    })
}

/// Scales the brightness: factors above 1 are lighter, below 1 darker.
pub(crate) fn shaded(color: Rgb, factor: f32) -> Rgb {
    color.map(|c| (f32::from(c) * factor).round() as u8)
}

/// Adds an offset to each channel.
pub(crate) fn jittered(color: Rgb, by: [f32; 3]) -> Rgb {
    std::array::from_fn(|i| (f32::from(color[i]) + by[i]).round() as u8)
}

/// Contrasting colour: black or white, whichever stands out more.
pub(crate) fn contrasting(color: Rgb) -> Rgb {
    let [r, g, b] = color.map(f32::from);
    if 0.3 * r + 0.6 * g + 0.1 * b > 120.0 {
        BLACK
    } else {
        WHITE
    }
}
