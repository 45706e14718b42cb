//! Colours that things of a material come in, and mixing them.

/// sRGB: red, green, blue.
pub(crate) type Color = [u8; 3];

pub(crate) const WHITE: Color = [240, 240, 236];
pub(crate) const BLACK: Color = [28, 28, 30];
pub(crate) const STEEL: Color = [176, 180, 186];
pub(crate) const BRASS: Color = [190, 158, 84];
pub(crate) const LEAF: Color = [72, 124, 48];
pub(crate) const BARK: Color = [104, 76, 46];

pub(crate) const GLAZES: [Color; 9] = [
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
pub(crate) const PLASTICS: [Color; 10] = [
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
pub(crate) const GRIPS: [Color; 6] = [
    [200, 36, 34],
    [30, 84, 168],
    [240, 180, 24],
    [226, 104, 26],
    [36, 122, 62],
    [46, 46, 50],
];
pub(crate) const WOODS: [Color; 4] = [
    [196, 152, 98],
    [168, 116, 66],
    [130, 84, 48],
    [212, 176, 124],
];
pub(crate) const METALS: [Color; 4] = [STEEL, [196, 198, 202], [150, 154, 160], [188, 184, 176]];
pub(crate) const PASTELS: [Color; 6] = [
    [236, 208, 214],
    [202, 222, 236],
    [214, 232, 206],
    [244, 234, 198],
    [224, 212, 236],
    [240, 240, 236],
];

/// Between two colours: `share` 0 gives the first, 1 the second.
pub(crate) fn mix(a: Color, b: Color, share: f32) -> Color {
    let share = share.clamp(0.0, 1.0);
    std::array::from_fn(|i| {
        let (a, b) = (f32::from(a[i]), f32::from(b[i]));
        (a + (b - a) * share).round() as u8
    })
}

/// Lighter for a factor above 1, darker below.
pub(crate) fn shaded(color: Color, factor: f32) -> Color {
    color.map(|c| (f32::from(c) * factor).round() as u8)
}

/// With something added to each channel.
pub(crate) fn jittered(color: Color, by: [f32; 3]) -> Color {
    std::array::from_fn(|i| (f32::from(color[i]) + by[i]).round() as u8)
}

/// Of black and white the one that stands out more.
pub(crate) fn contrasting(color: Color) -> Color {
    let [r, g, b] = color.map(f32::from);
    if 0.3 * r + 0.6 * g + 0.1 * b > 120.0 {
        BLACK
    } else {
        WHITE
    }
}
