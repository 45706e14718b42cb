//! The synthetic table as a source.

use super::{FrameInfo, FrameSize, Playback, Source, SourceError};
use crate::synthetic::SyntheticTable;
use point_cloud::Point;

const DEFAULT_RATE_HZ: f64 = 30.0;

/// Plays the table for ever, or from and to a frame of its noise.
pub(super) struct Synthetic {
    table: SyntheticTable,
    name: String,
    rate_hz: f64,
    playback: Playback,
    next: usize,
}

impl Synthetic {
    /// An arrangement of a few objects.
    pub(super) fn arrangement(number: u32, playback: &Playback) -> Self {
        let table = SyntheticTable::new(number);
        Self::new(table, format!("synthetic:{number}"), playback)
    }

    /// A crowd of blocks.
    pub(super) fn crowd(n: u32, playback: &Playback) -> Self {
        Self::new(SyntheticTable::crowd(n), format!("crowd:{n}"), playback)
    }

    fn new(table: SyntheticTable, name: String, playback: &Playback) -> Self {
        Self {
            table,
            name,
            rate_hz: playback.rate_hz.unwrap_or(DEFAULT_RATE_HZ),
            playback: *playback,
            next: playback.from.unwrap_or(0),
        }
    }
}

impl Source for Synthetic {
    fn name(&self) -> &str {
        &self.name
    }

    fn rate_hz(&self) -> Option<f64> {
        Some(self.rate_hz)
    }

    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError> {
        if self.playback.to.is_some_and(|to| self.next >= to) {
            if !self.playback.looped {
                return Ok(None);
            }
            self.next = self.playback.from.unwrap_or(0);
        }
        let camera = self.table.camera();
        Ok(Some(FrameSize {
            width: camera.width as usize,
            height: camera.height as usize,
        }))
    }

    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        let frame = self.next;
        self.next += 1;
        self.table.fill(frame as u64, points);
        Ok(FrameInfo {
            camera: self.table.camera(),
            is_calibrated: true,
            world_from_camera: Some(self.table.world_from_camera()),
            up_in_camera: Some(self.table.up_in_camera()),
            source_frame: frame,
            captured_ns: None,
        })
    }
}
