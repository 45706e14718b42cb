//! Views of objects under different lamps and beside different tables, described in several ways.

use crate::evaluate::recognition::HypothesisDescriptors;
use crate::parallel;
use crate::simulate::turntable::{ELEVATIONS, SegmentedView, Turntable, TurntableRoom};
use dataset::washington::CAMERA;
use description::{AppearanceDescriptor, AppearanceWeights, ObjectPoints};
use indicatif::ProgressBar;
use service::Failure;
use simulated_world::{Lighting, ModelChoice, ModelLibrary, TableFinish, TablePattern};

/// Treatment of an object's colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Treatment {
    /// White balance, as in the live system.
    Balanced,
    /// Colours as the camera sees them.
    AsSeen,
    /// No colours.
    ShapeOnly,
}

impl Treatment {
    /// All treatments, in the order of their numbers.
    pub(super) const ALL: [Self; 3] = [Self::Balanced, Self::AsSeen, Self::ShapeOnly];
}

coded_enum::coded_enum! {
    /// Table of a room.
    pub(super) enum TestTable {
        Oak, "oak";
        White, "white";
        DarkWood, "dark wood";
        BlueCloth, "blue cloth";
    }
}

impl TestTable {
    fn finish(self) -> TableFinish {
        let finish = |color, pattern| TableFinish {
            color,
            pattern,
            contrast_percent: 15,
        };
        match self {
            Self::Oak => TableFinish::default(),
            Self::White => finish([205, 204, 200], TablePattern::Plain),
            Self::DarkWood => finish([74, 62, 56], TablePattern::WoodGrain),
            Self::BlueCloth => finish([108, 126, 152], TablePattern::Mottle),
        }
    }
}

/// Room of a test: lighting and table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Room {
    pub(super) lighting: Lighting,
    pub(super) table: TestTable,
}

impl Room {
    /// Room of the lessons.
    pub(super) const LESSONS: Self = room(Lighting::White, TestTable::Oak);
}

const fn room(lighting: Lighting, table: TestTable) -> Room {
    Room { lighting, table }
}

/// Rooms of the tests: all lightings on the table of the lessons, three of them on others.
pub(super) const ROOMS: [Room; 16] = [
    room(Lighting::White, TestTable::Oak),
    room(Lighting::Dawn, TestTable::Oak),
    room(Lighting::Tungsten, TestTable::Oak),
    room(Lighting::Mixed, TestTable::Oak),
    room(Lighting::RedWalls, TestTable::Oak),
    room(Lighting::GreenWalls, TestTable::Oak),
    room(Lighting::BlueWalls, TestTable::Oak),
    room(Lighting::White, TestTable::White),
    room(Lighting::Tungsten, TestTable::White),
    room(Lighting::Mixed, TestTable::White),
    room(Lighting::White, TestTable::DarkWood),
    room(Lighting::Tungsten, TestTable::DarkWood),
    room(Lighting::Mixed, TestTable::DarkWood),
    room(Lighting::White, TestTable::BlueCloth),
    room(Lighting::Tungsten, TestTable::BlueCloth),
    room(Lighting::Mixed, TestTable::BlueCloth),
];

/// View of an object.
pub(super) struct LitView {
    /// Number of the object.
    pub(super) object: usize,
    /// Descriptors by the number of the treatment.
    pub(super) described: [HypothesisDescriptors; Treatment::ALL.len()],
}

/// Turntables of all objects.
pub(super) struct Turntables<'a> {
    pub(super) library: &'a ModelLibrary,
    pub(super) models: &'a [ModelChoice],
    /// Number of views of an object in a room.
    pub(super) n_views: usize,
    pub(super) seed: u64,
    pub(super) bar: ProgressBar,
}

impl Turntables<'_> {
    /// Views of all objects in a room, in their order; `offset` turns the objects by a share of
    /// the angle between two views. A view in which detection does not find the object is left
    /// out.
    pub(super) fn views(&self, room: Room, offset: f64) -> Result<Vec<LitView>, Failure> {
        let describer = Describer::new()?;
        let copy = || describer.clone();
        let views = parallel::map(self.models.len(), &self.bar, copy, |describer, object| {
            self.views_of_object(describer, object, room, offset)
        });
        let views: Result<Vec<Vec<LitView>>, Failure> = views.into_iter().collect();
        Ok(views?.into_iter().flatten().collect())
    }

    fn views_of_object(
        &self,
        describer: &mut Describer,
        object: usize,
        room: Room,
        offset: f64,
    ) -> Result<Vec<LitView>, Failure> {
        let surroundings = TurntableRoom {
            lighting: Some(room.lighting),
            table_finish: room.table.finish(),
        };
        let (model, library) = (&self.models[object], self.library.clone());
        let seed = (self.seed, object as u64);
        let mut turntable =
            Turntable::new(model, library, CAMERA, surroundings, seed).map_err(Failure::general)?;
        let n_turns = self.n_views.div_ceil(ELEVATIONS.len()) as f64;
        let mut views = Vec::new();
        for number in 0..self.n_views {
            let (turn, height) = (number / ELEVATIONS.len(), number % ELEVATIONS.len());
            let seen = turntable.view(height, (turn as f64 + offset) / n_turns);
            let described = seen
                .map_err(Failure::general)?
                .and_then(|view| describer.describe(&view));
            views.extend(described.map(|described| LitView { object, described }));
        }
        Ok(views)
    }
}

/// Descriptors with and without colour.
#[derive(Clone)]
struct Describer {
    appearance: AppearanceDescriptor,
    shape: AppearanceDescriptor,
}

impl Describer {
    fn new() -> Result<Self, Failure> {
        let with = |weights| AppearanceDescriptor::new(weights).map_err(Failure::general);
        Ok(Self {
            appearance: with(AppearanceWeights::default())?,
            shape: with(AppearanceWeights::shape_only())?,
        })
    }

    /// Descriptors of a view in all treatments; `None` for a view with too few points.
    fn describe(
        &mut self,
        view: &SegmentedView<'_>,
    ) -> Option<[HypothesisDescriptors; Treatment::ALL.len()]> {
        let points = ObjectPoints::selected(view.cloud, view.point_indices).ok()?;
        let up = Some(&view.up_in_camera);
        let balanced = points.balanced(view.white_balance());
        let balanced = self.appearance.describe(balanced, up).ok()?.to_vec();
        let as_seen = self.appearance.describe(points, up).ok()?.to_vec();
        let shape = self.shape.describe(points, up).ok()?.to_vec();
        Some([balanced, as_seen, shape])
    }
}
