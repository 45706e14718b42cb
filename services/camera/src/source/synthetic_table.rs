//! Frame source for the synthetic table.

use super::{DEFAULT_RATE_HZ, FrameInfo, FrameSize, Playback, Source, SourceError};
use crate::synthetic::SyntheticTable;
use point_cloud::Point;

/// Number of frames for which each of several tables is shown. Chosen (3 s at 30 Hz).
const FRAMES_PER_TABLE: usize = 90;

/// Endless player of one table, or of several in turn; the frame number seeds the noise.
pub(super) struct SyntheticSource {
    /// Synthetic tables shown in turn; at least one.
    tables: Vec<SyntheticTable>,
    name: String,
    rate_hz: f64,
    playback: Playback,
    next: usize,
}

impl SyntheticSource {
    /// Source of an arrangement of a few objects.
    pub(super) fn arrangement(number: u32, playback: &Playback) -> Self {
        let table = SyntheticTable::new(number);
        Self::new(vec![table], format!("synthetic:{number}"), playback)
    }

    /// Frame source that shows a crowd of blocks.
    pub(super) fn crowd(n: u32, playback: &Playback) -> Self {
        let tables = vec![SyntheticTable::crowd(n)];
        Self::new(tables, format!("crowd:{n}"), playback)
    }

    /// Source of a crowd of blocks that come and go.
    pub(super) fn parade(n: u32, playback: &Playback) -> Self {
        let tables = SyntheticTable::parade(n).into();
        Self::new(tables, format!("parade:{n}"), playback)
    }

    fn new(tables: Vec<SyntheticTable>, name: String, playback: &Playback) -> Self {
        Self {
            tables,
            name,
            rate_hz: playback.rate_hz.unwrap_or(DEFAULT_RATE_HZ),
            playback: *playback,
            next: playback.from.unwrap_or(0),
        }
    }
}

impl Source for SyntheticSource {
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
        Ok(Some(FrameSize::of(&self.tables[0].camera())))
    }

    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        let frame = self.next;
        self.next += 1;
        let table = &self.tables[frame / FRAMES_PER_TABLE % self.tables.len()];
        table.fill(frame as u64, points);
        Ok(FrameInfo {
            camera: table.camera(),
            is_calibrated: true,
            world_from_camera: Some(table.world_from_camera()),
            up_in_camera: Some(table.up_in_camera()),
            source_frame: frame,
            captured_ns: None,
        })
    }
}
