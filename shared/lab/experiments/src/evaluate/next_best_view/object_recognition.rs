//! Recognition of the objects in the bin, taught in other heaps of the same objects.

use super::bin_scene::BinScene;
use super::captured_view::{CapturedView, capture_all};
use super::simulated_bin::{SimulatedBin, ViewLattice};
use description::{AppearanceDescriptor, AppearanceWeights, ObjectPoints};
use learning::{CategoryIndex, CategoryName, Neighbour, NoveltyPrior, UnknownRule, ViewId};
use nalgebra::UnitVector3;
use point_cloud::Point;
use random::mix64;
use service::Failure;
use simulated_world::ModelLibrary;

/// Number of views of a heap in which the objects are taught. Chosen.
const N_HEAP_VIEWS: u32 = 24;
/// Random streams of the heaps.
const STREAM_HEAPS: u64 = 100;

/// Descriptors of the axis hypotheses of one view.
pub(super) type ViewDescriptors = Vec<Vec<f32>>;

/// Appearance descriptor of segments; without one nothing is described.
#[derive(Debug)]
pub(super) struct SegmentDescriber(Option<AppearanceDescriptor>);

impl Default for SegmentDescriber {
    fn default() -> Self {
        Self(AppearanceDescriptor::new(AppearanceWeights::default()).ok())
    }
}

impl SegmentDescriber {
    /// Descriptors of the points of a frame at the indices of a segment; `None` when they are too
    /// few.
    pub(super) fn describe(
        &mut self,
        points: &[Point],
        indices: &[u32],
        up_in_camera: Option<&UnitVector3<f64>>,
    ) -> Option<ViewDescriptors> {
        let segment = ObjectPoints::selected(points, indices).ok()?;
        let described = self.0.as_mut()?.describe(segment, up_in_camera);
        described.ok().map(|descriptors| descriptors.to_vec())
    }
}

/// Recogniser of the objects of a scene.
#[derive(Debug)]
pub(super) struct ObjectRecogniser {
    index: CategoryIndex,
    /// Number of taught views.
    n_views: u32,
}

impl ObjectRecogniser {
    /// Recogniser that is taught the objects of a bin in other heaps of them: every segment that
    /// covers an object, by the name of its model.
    pub(super) fn taught(
        bin: &SimulatedBin,
        (n_heaps, seed): (u32, u64),
        library: &ModelLibrary,
    ) -> Result<Self, Failure> {
        let mut recogniser = Self {
            index: pipeline::category_index(),
            n_views: 0,
        };
        let lattice = ViewLattice {
            n_views: N_HEAP_VIEWS,
            elevation_min_deg: 0.0,
        };
        for number in 0..n_heaps {
            let seed = mix64(seed ^ mix64(STREAM_HEAPS + u64::from(number)));
            let heap = bin.thrown_anew(seed, lattice, library)?;
            for view in capture_all(&heap, None, false)? {
                recogniser.learn(&heap.scene, &view)?;
            }
        }
        Ok(recogniser)
    }

    fn learn(&mut self, scene: &BinScene, view: &CapturedView) -> Result<(), Failure> {
        for segment in &view.segments.segments {
            let (Some(object), Some(descriptors)) = (segment.object, &segment.descriptors) else {
                continue;
            };
            let object = &scene.objects[object];
            let view_id = ViewId {
                track_id: object.id.into(),
                view_id: self.n_views,
            };
            self.n_views += 1;
            let name = CategoryName::new(&object.name).map_err(Failure::general)?;
            let stored = self.index.insert(view_id, &name, &descriptors[0]);
            stored.map_err(Failure::general)?;
        }
        Ok(())
    }

    /// Label of a segment by the rule of perception, and its most probable categories with their
    /// probabilities.
    pub(super) fn recognise(
        &self,
        descriptors: Option<&ViewDescriptors>,
    ) -> (Option<String>, Vec<(String, f64)>) {
        let rule = UnknownRule::LessProbableThan {
            probability: pipeline::Config::KNOWN_PROBABILITY_MIN,
            novelty_prior: NoveltyPrior::default().probability(),
        };
        let found = descriptors.map(|known| self.index.recognise_any(known, rule));
        let Some(Ok(found)) = found else {
            return (None, Vec::new());
        };
        let category = |near: &Neighbour| {
            let probability = near.probability.unwrap_or(0.0).into();
            (near.category.as_str().to_owned(), probability)
        };
        let label = found.label.map(|label| label.as_str().to_owned());
        (
            label,
            found.nearest.iter().flatten().map(category).collect(),
        )
    }
}
