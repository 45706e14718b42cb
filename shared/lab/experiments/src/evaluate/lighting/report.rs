//! Report of recognition under different lamps.

use super::lit_views::{Room, Treatment};
use crate::arguments::LightingArguments;
use serde::Serialize;
use statistics::bootstrap::Estimate;

/// Report of recognition under different lamps.
#[derive(Debug, Serialize)]
pub(super) struct LightingReport {
    pub(super) n_objects: u32,
    /// Number of views of an object in the lessons, and in each room.
    pub(super) n_views: u32,
    pub(super) seed: u64,
    pub(super) rooms: Vec<RoomFigures>,
    /// Greatest loss of accuracy in a room against the white lamp beside the same table; `None`
    /// without views.
    pub(super) worst_loss: Option<f64>,
    /// The same without white balance.
    pub(super) worst_loss_as_seen: Option<f64>,
}

/// Accuracies in one room, means over the objects with their 95 % intervals.
#[derive(Debug, Serialize)]
pub(super) struct RoomFigures {
    pub(super) lighting: &'static str,
    pub(super) table: &'static str,
    /// Accuracy with white balance, as in the live system.
    pub(super) accuracy: Option<Estimate>,
    /// Accuracy with the colours as the camera sees them.
    pub(super) as_seen: Option<Estimate>,
    /// Accuracy without colours.
    pub(super) shape_only: Option<Estimate>,
}

impl RoomFigures {
    /// Figures of a room from the shares of correct views of its objects, by treatment.
    pub(super) fn of(room: Room, shares: &[Vec<Option<f64>>], seed: u64) -> Self {
        let mean = |treatment: Treatment| Estimate::mean(&shares[treatment as usize], seed);
        Self {
            lighting: room.lighting.word(),
            table: room.table.word(),
            accuracy: mean(Treatment::Balanced),
            as_seen: mean(Treatment::AsSeen),
            shape_only: mean(Treatment::ShapeOnly),
        }
    }

    fn is_white(&self) -> bool {
        self.lighting == Room::LESSONS.lighting.word()
    }
}

impl LightingReport {
    pub(super) fn of(arguments: &LightingArguments, rooms: Vec<RoomFigures>) -> Self {
        Self {
            n_objects: arguments.objects,
            n_views: arguments.views,
            seed: arguments.seed,
            worst_loss: worst_loss(&rooms, |room| room.accuracy),
            worst_loss_as_seen: worst_loss(&rooms, |room| room.as_seen),
            rooms,
        }
    }
}

/// Greatest loss of a room against the white lamp beside the same table.
fn worst_loss(
    rooms: &[RoomFigures],
    accuracy: impl Fn(&RoomFigures) -> Option<Estimate>,
) -> Option<f64> {
    let loss = |room: &RoomFigures| {
        let mut same_table = rooms.iter().filter(|other| other.table == room.table);
        let white = same_table.find(|other| other.is_white())?;
        Some(accuracy(white)?.value - accuracy(room)?.value)
    };
    rooms.iter().filter_map(loss).max_by(f64::total_cmp)
}
