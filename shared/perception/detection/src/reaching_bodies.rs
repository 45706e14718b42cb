//! Body segmentation in depth: parts of people that reach over the table from outside of it.
//!
//! A connected component above the table is a part of a body when it enters over the table's
//! border or over the image's border high above the table, and
//! - free space is seen beneath it: an object stands, an arm does not; or
//! - it meets a tracked object and nothing else beneath: a hand holds that object; or
//! - its lower contour is hidden and most of it is beside the table: a person leans over; or
//! - a body hides its lower contour: the torso behind an arm; or
//! - it was a body in the previous frame: the hand has put something down, and holds it yet.
//!
//! The pixels of bodies are kept apart from the objects, like those of known capsules. In the box
//! of a live track the colours decide: a body grows into it over connected pixels that look like
//! the hand near the track rather than like the object. The others stay with the track, so that
//! what a hand holds keeps its id.

mod evidence;
mod hand_growth;
mod scene;

use crate::RawConfig;
use crate::affine_form::AffineForm;
use crate::body_map::BodyMap;
use crate::depth_history::Motion;
use crate::input::DetectionInput;
use crate::prism::lowest_m;
use crate::samples::Samples;
use crate::table::Table;
use crate::table_surface::TableSurface;
use evidence::Evidence;
use point_cloud::OrganizedCloud;
use scene::{Scene, step_m};
use sensor_noise::DepthNoise;

/// Least height over the table at which a body enters over the image's border, metres. Lower
/// components are objects cut by the border. Chosen.
const ENTRY_HEIGHT_M: f32 = 0.10;

/// Least ratio of the samples beside the table to those above it in a component whose lower
/// contour is hidden, for a body that leans over the table: an object with its larger half
/// beyond the rim falls.
const BESIDE_RATIO_MIN: usize = 1;

/// Greatest number of samples without depth beneath a lower contour: the shadow of the sensor's
/// projector. Chosen.
const SHADOW_SAMPLES: usize = 6;

/// Greatest number of samples between a body and a point that it touches.
const TOUCH_SAMPLES: usize = 3;

/// Place of a sample relative to the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    /// Level with the table, lower, or without depth.
    Low,
    /// Above the table, within the heights of objects.
    AboveTable,
    /// Higher than the table and beside it, or higher than objects.
    Beside,
}

/// Background seen directly beneath a sample in the image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Beneath {
    /// The next surface is farther: the sample floats.
    FreeSpace,
    /// The table or a lower surface at the same depth: the sample may stand on it.
    Surface,
    /// A tracked object at the same depth: the sample may hold it.
    Tracked,
    /// A nearer body.
    Body,
}

/// Bodies that reach over the table. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct ReachingBodies {
    places: Vec<Place>,
    /// Number of the component by which a sample was visited last, from 1; 0 for none.
    visitor: Vec<u32>,
    n_components: u32,
    component: Vec<u32>,
    /// Tracks that bodies touch.
    touched: Vec<bool>,
    width: usize,
    stride: usize,
    noise: DepthNoise,
    map: BodyMap,
}

impl ReachingBodies {
    /// Bodies found in the last image.
    pub(crate) fn map(&self) -> &BodyMap {
        &self.map
    }

    /// Forget the bodies of the last image.
    pub(crate) fn clear(&mut self) {
        self.map.clear();
    }

    /// Find the bodies in a subsampled image.
    pub(crate) fn find(
        &mut self,
        frame: &DetectionInput<'_>,
        samples: &Samples,
        table: &Table,
        surface: &TableSurface,
        config: &RawConfig,
    ) {
        (self.width, self.stride) = (samples.width(), samples.stride());
        self.noise = table.depth_noise;
        self.classify(samples, table, surface, config);
        self.visitor.clear();
        self.visitor.resize(samples.len(), 0);
        self.n_components = 0;
        self.map.reset(samples.len());
        let priors = &frame.priors;
        let scene = Scene {
            cloud: frame.cloud,
            samples,
            height: AffineForm::coordinates_of(&table.table_from_camera)[2],
            noise: table.depth_noise,
            tracks: priors.tracks,
            previous: priors.bodies.filter(|map| map.len() == samples.len()),
            motion: priors.bodies.and_then(|map| {
                let history = map.history();
                history.view(&priors.world_from_camera, table.depth_noise)
            }),
        };
        for start in 0..samples.len() {
            if self.places[start] == Place::AboveTable
                && self.visitor[start] == 0
                && self.is_entry(start, &scene)
                && !scene.is_tracked(start)
            {
                let evidence = self.flood(start, &scene);
                if let Some(age) = self.age_of_body(&evidence, start, &scene) {
                    self.map.mark(&self.component, age);
                }
            }
        }
        if self.map.is_any() {
            self.mark_behind_bodies(&scene);
            self.learn_colors(&scene);
            self.grow_into_tracks(&scene);
        }
        let pose = &priors.world_from_camera;
        self.map.advance_history(priors.bodies, samples, pose);
    }

    /// Move the pixels of bodies out of `pixels` and append them to `masked`, both in image
    /// order.
    pub(crate) fn extract(
        &self,
        cloud: &OrganizedCloud<'_>,
        samples: &Samples,
        pixels: &mut Vec<u32>,
        masked: &mut Vec<u32>,
    ) {
        if !self.map.is_any() {
            return;
        }
        let n_known = masked.len();
        pixels.retain(|&pixel| {
            let point = &cloud.points()[pixel as usize];
            let at = [
                pixel as usize % cloud.width(),
                pixel as usize / cloud.width(),
            ];
            let is_masked = self.is_near_body(at, point.z, samples);
            if is_masked {
                masked.push(pixel);
            }
            !is_masked
        });
        if n_known > 0 {
            masked.sort_unstable();
        }
    }

    /// Share of points within `distance_m` of a body, 0 to 1.
    pub(crate) fn share_near<'a>(
        &self,
        pixels: impl Iterator<Item = &'a u32>,
        cloud: &OrganizedCloud<'_>,
        samples: &Samples,
        distance_m: f64,
    ) -> f32 {
        let (mut n, mut n_near) = (0_u32, 0_u32);
        for &pixel in pixels {
            let point = cloud.points()[pixel as usize].position();
            let is_near = |sample: usize| {
                self.map.age(sample) > 0 && (samples.position(sample) - point).norm() <= distance_m
            };
            let at = [
                pixel as usize % cloud.width(),
                pixel as usize / cloud.width(),
            ];
            n += 1;
            n_near += u32::from(self.around(at, TOUCH_SAMPLES).any(is_near));
        }
        n_near as f32 / n.max(1) as f32
    }

    /// Samples around a pixel, up to a number of samples away.
    fn around(
        &self,
        [column, row]: [usize; 2],
        reach: usize,
    ) -> impl Iterator<Item = usize> + use<> {
        let (width, height) = (self.width, self.places.len() / self.width.max(1));
        let (column, row) = (column / self.stride, row / self.stride);
        let rows = row.saturating_sub(reach)..(row + reach + 1).min(height);
        rows.flat_map(move |row| {
            let columns = column.saturating_sub(reach)..(column + reach + 1).min(width);
            columns.map(move |column| row * width + column)
        })
    }

    fn classify(
        &mut self,
        samples: &Samples,
        table: &Table,
        surface: &TableSurface,
        config: &RawConfig,
    ) {
        let [u, v, height] = AffineForm::coordinates_of(&table.table_from_camera);
        let highest_m = config.height_max_m as f32;
        let place = |sample: usize| {
            let z = samples.depth(sample);
            let height_m = samples.coordinate(&height, sample);
            if z <= 0.0 || height_m < lowest_m(z, config.height_min_m as f32, &table.depth_noise) {
                return Place::Low;
            }
            let [u, v] = [u, v].map(|axis| samples.coordinate(&axis, sample));
            if height_m > highest_m || !surface.is_near(u, v) {
                Place::Beside
            } else {
                Place::AboveTable
            }
        };
        self.places.clear();
        self.places.extend((0..samples.len()).map(place));
    }

    /// Samples left, right, above and below of a sample; `None` beyond the image's border.
    fn neighbours(&self, sample: usize) -> [Option<usize>; 4] {
        let column = sample % self.width;
        [
            (column > 0).then(|| sample - 1),
            (column + 1 < self.width).then(|| sample + 1),
            sample.checked_sub(self.width),
            Some(sample + self.width).filter(|&below| below < self.places.len()),
        ]
    }

    /// `true` when a body may enter at a sample above the table: it is connected with a sample
    /// beside the table, or high above the table at the image's border.
    fn is_entry(&self, sample: usize, scene: &Scene<'_>) -> bool {
        let enters_from = |neighbour: Option<usize>| match neighbour {
            Some(near) => self.places[near] == Place::Beside && scene.is_connected(sample, near),
            None => scene.samples.coordinate(&scene.height, sample) >= ENTRY_HEIGHT_M,
        };
        self.neighbours(sample).into_iter().any(enters_from)
    }

    /// Surface or free space beneath a sample; `None` within a component, over something nearer,
    /// and where nothing is measured. A gap without depth up to [`SHADOW_SAMPLES`] is skipped.
    fn beneath(&self, sample: usize, scene: &Scene<'_>) -> Option<Beneath> {
        let samples = scene.samples;
        let below = (1..=SHADOW_SAMPLES)
            .map(|step| sample + step * self.width)
            .take_while(|&below| below < samples.len())
            .find(|&below| samples.depth(below) > 0.0)?;
        if scene.is_connected(sample, below) {
            match self.places[below] {
                Place::Low => Some(Beneath::Surface),
                Place::AboveTable if scene.is_tracked(below) => Some(Beneath::Tracked),
                _ => None,
            }
        } else {
            let is_farther = samples.depth(below) > samples.depth(sample);
            match (is_farther, self.map.age(below)) {
                (true, _) => Some(Beneath::FreeSpace),
                (false, 0) => None,
                (false, _) => Some(Beneath::Body),
            }
        }
    }

    /// Collect the samples above the table that are connected with a sample and in no track's
    /// box, breadth-first, and their evidence for a body.
    fn flood(&mut self, start: usize, scene: &Scene<'_>) -> Evidence {
        let mut evidence = Evidence::default();
        self.n_components += 1;
        self.component.clear();
        self.component.push(start as u32);
        self.visitor[start] = self.n_components;
        let mut next = 0;
        while let Some(&sample) = self.component.get(next) {
            next += 1;
            let sample = sample as usize;
            for near in self.neighbours(sample).into_iter().flatten() {
                if self.places[near] == Place::AboveTable
                    && self.visitor[near] != self.n_components
                    && scene.is_connected(sample, near)
                    && !scene.is_tracked(near)
                {
                    self.visitor[near] = self.n_components;
                    self.component.push(near as u32);
                }
            }
            evidence.n_entry += u32::from(self.is_entry(sample, scene));
            match self.beneath(sample, scene) {
                Some(Beneath::FreeSpace) => evidence.n_free += 1,
                Some(Beneath::Surface) => evidence.n_standing += 1,
                Some(Beneath::Tracked) => evidence.n_holding += 1,
                Some(Beneath::Body) => evidence.n_behind_body += 1,
                None => {}
            }
            match scene.motion(sample) {
                Motion::Arrived => evidence.n_arrived += 1,
                Motion::Still => evidence.n_still += 1,
                Motion::Unknown => {}
            }
            evidence.continue_from(scene.previous.map_or(0, |map| map.age(sample)));
        }
        evidence
    }

    /// Number of frames since the component collected last had evidence of its own for a body,
    /// from 1; `None` when it is no body.
    fn age_of_body(&mut self, evidence: &Evidence, start: usize, scene: &Scene<'_>) -> Option<u8> {
        let depth_m = scene.samples.depth(start);
        let n_above = self.component.len() as u32;
        if !evidence.enters(depth_m) || !evidence.moves() {
            None
        } else if evidence.floats(depth_m)
            || evidence.holds(depth_m)
            || self.leans(evidence, depth_m, scene)
        {
            Some(1)
        } else {
            evidence.continued_age(n_above)
        }
    }

    /// `true` when the lower contour of the component collected last is hidden and most of the
    /// connected samples are beside the table.
    fn leans(&mut self, evidence: &Evidence, depth_m: f32, scene: &Scene<'_>) -> bool {
        if evidence.shows_contour(depth_m) {
            return false;
        }
        let n_above = self.component.len();
        let n_all_min = n_above * (1 + BESIDE_RATIO_MIN);
        let mut next = 0;
        while next < self.component.len() && self.component.len() < n_all_min {
            let sample = self.component[next] as usize;
            next += 1;
            for near in self.neighbours(sample).into_iter().flatten() {
                if self.places[near] == Place::Beside
                    && self.visitor[near] != self.n_components
                    && scene.is_connected(sample, near)
                {
                    self.visitor[near] = self.n_components;
                    self.component.push(near as u32);
                }
            }
        }
        let is_mostly_beside = self.component.len() >= n_all_min;
        self.component.truncate(n_above);
        is_mostly_beside
    }

    /// Mark the components that enter over a border and whose lower contour bodies hide: the
    /// torso behind an arm.
    fn mark_behind_bodies(&mut self, scene: &Scene<'_>) {
        let n_first = self.n_components;
        for start in 0..scene.samples.len() {
            if self.places[start] == Place::AboveTable
                && self.map.age(start) == 0
                && self.visitor[start] <= n_first
                && self.is_entry(start, scene)
                && !scene.is_tracked(start)
            {
                let evidence = self.flood(start, scene);
                let depth_m = scene.samples.depth(start);
                if evidence.enters(depth_m) && evidence.is_behind_body() {
                    self.map.mark(&self.component, 1);
                }
            }
        }
    }

    /// `true` when one of the samples around a pixel is of a body and of nearly the depth `z`.
    fn is_near_body(&self, at: [usize; 2], z: f32, samples: &Samples) -> bool {
        let step_m = step_m(z, &self.noise);
        self.around(at, 1)
            .any(|sample| self.map.age(sample) > 0 && (samples.depth(sample) - z).abs() <= step_m)
    }
}
