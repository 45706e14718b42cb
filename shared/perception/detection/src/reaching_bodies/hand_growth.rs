//! Region growing of a hand into the box of the object that it touches, by colour.

use super::scene::Scene;
use super::{Place, ReachingBodies};

/// Distance from the box of a touched track within which a body shows the hand, metres.
const HAND_REACH_M: f64 = 0.10;

impl ReachingBodies {
    /// Colours of the bodies near the tracks that they touch: those of the hand rather than of
    /// the sleeve. Samples in the tracks' boxes do not count.
    pub(super) fn learn_colors(&mut self, scene: &Scene<'_>) {
        self.component.clear();
        self.component
            .extend(self.map.samples().map(|sample| sample as u32));
        let bodies = || self.component.iter().map(|&sample| sample as usize);
        self.touched.clear();
        self.touched.resize(scene.tracks.len(), false);
        for sample in bodies() {
            for near in self.neighbours(sample).into_iter().flatten() {
                if self.places[near] == Place::AboveTable && scene.is_connected(sample, near) {
                    scene.mark_claiming(near, &mut self.touched);
                }
            }
        }
        let tracks = || scene.tracks.iter().zip(&self.touched);
        let hands = bodies().filter(|&sample| {
            let position = scene.samples.position(sample);
            tracks().any(|(track, &is_touched)| {
                is_touched && track.oriented_box.contains(&position, HAND_REACH_M)
            })
        });
        self.map
            .learn_colors(hands.map(|sample| scene.color(sample)), scene.previous);
    }

    /// Region growing of the bodies into the boxes of tracks, over connected samples with the
    /// colours of bodies rather than those of the track: a hand that holds an object.
    pub(super) fn grow_into_tracks(&mut self, scene: &Scene<'_>) {
        let mut next = 0;
        while let Some(&sample) = self.component.get(next) {
            next += 1;
            let sample = sample as usize;
            let age = self.map.age(sample);
            for near in self.neighbours(sample).into_iter().flatten() {
                if self.places[near] == Place::AboveTable
                    && self.map.age(near) == 0
                    && scene.is_connected(sample, near)
                    && scene.is_tracked(near)
                    && self.has_body_colors(near, scene)
                {
                    self.map.mark(&[near as u32], age);
                    self.component.push(near as u32);
                }
            }
        }
    }

    /// `true` when a sample and its connected neighbours have colours of bodies rather than
    /// those of the tracks in whose boxes they are.
    fn has_body_colors(&self, sample: usize, scene: &Scene<'_>) -> bool {
        let near = self.neighbours(sample).into_iter().flatten();
        let connected =
            near.filter(|&near| scene.is_connected(sample, near) && scene.is_tracked(near));
        let surface = std::iter::once(sample).chain(connected);
        self.map.colors().is_some_and(|colors| {
            let ratio = |sample| scene.body_log_likelihood_ratio(sample, colors);
            surface.map(ratio).sum::<f32>() > 0.0
        })
    }
}
