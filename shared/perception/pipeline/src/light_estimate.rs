//! Estimate of the colour of the light: moving average over the frames.

use description::{LightColor, WhiteBalance};
use point_cloud::Point;

/// Time constant of the moving average, seconds: a hand in the image hardly matters, a lamp that
/// is switched on is known after a few seconds. Chosen.
const TIME_CONSTANT_S: f32 = 2.0;

/// Colour of the light, exponential moving average over capture time.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LightEstimate {
    /// Average and capture time of its newest frame, nanoseconds; `None` before the first.
    average: Option<(LightColor, u64)>,
}

impl LightEstimate {
    /// Adds a frame; one that shows no light is left out.
    pub(crate) fn add(&mut self, cloud: &[Point], capture_ns: u64) {
        let Some(seen) = LightColor::of_frame(cloud) else {
            return;
        };
        let light = self.average.map_or(seen, |(average, then_ns)| {
            let dt_s = capture_ns.saturating_sub(then_ns) as f32 * 1e-9;
            average.blended(seen, 1.0 - (-dt_s / TIME_CONSTANT_S).exp())
        });
        self.average = Some((light, capture_ns));
    }

    /// White balance of the average light; neutral before the first frame.
    pub(crate) fn white_balance(&self) -> WhiteBalance {
        self.average
            .map_or(WhiteBalance::NEUTRAL, |(light, _)| light.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Rgba;

    const SECOND_NS: u64 = 1_000_000_000;

    fn frame(color: Rgba) -> Vec<Point> {
        vec![Point::without_depth(color); 3000]
    }

    #[test]
    fn light_estimate_follows_a_lamp_within_seconds() {
        let (neutral, lamp) = (Rgba::opaque(120, 120, 120), Rgba::opaque(200, 120, 60));
        let mut estimate = LightEstimate::default();
        assert_eq!(estimate.white_balance(), WhiteBalance::NEUTRAL);
        estimate.add(&frame(neutral), SECOND_NS);
        assert_eq!(estimate.white_balance().color(lamp), lamp);
        estimate.add(&frame(lamp), SECOND_NS + SECOND_NS / 30);
        let [red, ..] = estimate.white_balance().rgb(lamp);
        assert!(red > 195.0, "{red}");
        for i in 0..300 {
            estimate.add(&frame(lamp), 2 * SECOND_NS + i * SECOND_NS / 30);
        }
        let of_lamp = LightColor::of_frame(&frame(lamp)).map(WhiteBalance::from);
        let [expected, ..] = of_lamp.unwrap().rgb(lamp);
        let [red, ..] = estimate.white_balance().rgb(lamp);
        assert!((red - expected).abs() < 1.0, "{red} {expected}");
        estimate.add(&frame(Rgba::opaque(0, 0, 0)), 12 * SECOND_NS);
        assert_eq!(estimate.white_balance().rgb(lamp)[0], red);
    }
}
