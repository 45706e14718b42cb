//! Assembly of frame timelines from the trace messages of several processes.

use crate::frame_timeline::{FrameTimeline, StageInterval};
use message::{ProcessKind, Span, Stage, TraceHeader};
use std::collections::BTreeMap;

/// Number of newer frames after which a frame is complete: by then every process has sent its
/// trace message. Chosen.
const N_NEWER_FRAMES: usize = 48;

/// Collects the trace messages of one daemon and returns complete frames, oldest first.
///
/// Messages of different processes arrive in any order. A frame that was not published is
/// returned without an end, or not at all if perception sent no message about it.
#[derive(Debug, Default)]
pub struct FrameAssembler {
    pending: BTreeMap<(u64, u64), FrameTimeline>,
    /// Sessions in order of arrival; session numbers are random.
    sessions: Vec<u64>,
    n_unknown: u64,
    n_left_out: u64,
}

impl FrameAssembler {
    /// Adds a trace message. Call [`next_frame`](Self::next_frame) afterwards until it returns
    /// `None`.
    pub fn add(&mut self, header: &TraceHeader, spans: &[Span]) {
        let Some(process) = ProcessKind::from_code(header.process) else {
            self.n_unknown += spans.len() as u64;
            return;
        };
        if !self.sessions.contains(&header.session) {
            self.sessions.push(header.session);
        }
        self.n_left_out += u64::from(header.n_left_out);
        let ordinal = self.ordinal(header.session);
        let timeline = self
            .pending
            .entry((ordinal, header.sequence))
            .or_insert_with(|| FrameTimeline {
                session: header.session,
                sequence: header.sequence,
                scheduled_ns: header.scheduled_ns,
                intervals: Vec::new(),
            });
        for span in spans {
            match Stage::from_code(span.stage) {
                Some(stage) => timeline.intervals.push(StageInterval {
                    stage,
                    process,
                    pid: header.pid,
                    span: *span,
                }),
                None => self.n_unknown += 1,
            }
        }
    }

    /// Timeline of the oldest complete frame, if any.
    pub fn next_frame(&mut self) -> Option<FrameTimeline> {
        (self.pending.len() > N_NEWER_FRAMES)
            .then(|| self.pending.pop_first())
            .flatten()
            .map(|(_, timeline)| timeline)
    }

    /// Drains the timelines of the remaining frames, complete or not, oldest first.
    pub fn drain(&mut self) -> impl Iterator<Item = FrameTimeline> {
        std::mem::take(&mut self.pending).into_values()
    }

    /// Number of spans of stages and processes unknown to this version.
    pub fn n_unknown(&self) -> u64 {
        self.n_unknown
    }

    /// Number of spans that did not fit into their messages.
    pub fn n_left_out(&self) -> u64 {
        self.n_left_out
    }

    fn ordinal(&self, session: u64) -> u64 {
        let place = self.sessions.iter().position(|known| *known == session);
        place.unwrap_or_default() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(process: ProcessKind, session: u64, sequence: u64) -> TraceHeader {
        TraceHeader {
            process: process.code(),
            session,
            sequence,
            scheduled_ns: sequence * 100,
            ..TraceHeader::default()
        }
    }

    fn span(stage: Stage) -> Span {
        Span::waiting(stage, 0, 1, 2)
    }

    #[test]
    fn spans_of_a_frame_are_assembled_in_any_order() {
        let mut assembler = FrameAssembler::default();
        for sequence in 0..100 {
            let hop = header(ProcessKind::MEMORY, 5, sequence);
            assembler.add(&hop, &[span(Stage::LabelHop)]);
            let frame = header(ProcessKind::PERCEPTION, 5, sequence);
            assembler.add(&frame, &[span(Stage::Detection), span(Stage::Publishing)]);
            let made = header(ProcessKind::SIMULATOR, 5, sequence);
            assembler.add(&made, &[span(Stage::Generation)]);
        }
        let mut timelines: Vec<FrameTimeline> =
            std::iter::from_fn(|| assembler.next_frame()).collect();
        assert_eq!(timelines.len(), 100 - N_NEWER_FRAMES);
        timelines.extend(assembler.drain());
        let sequences: Vec<u64> = timelines.iter().map(|timeline| timeline.sequence).collect();
        assert_eq!(sequences, (0..100).collect::<Vec<_>>());
        assert!(
            timelines
                .iter()
                .all(|timeline| timeline.intervals.len() == 4)
        );
        assert!(
            timelines
                .iter()
                .all(|timeline| timeline.scheduled_ns == timeline.sequence * 100)
        );
    }

    #[test]
    fn sessions_are_ordered_by_arrival() {
        let mut assembler = FrameAssembler::default();
        for (session, sequence) in [(900, 50), (900, 51), (3, 0), (3, 1)] {
            assembler.add(&header(ProcessKind::PERCEPTION, session, sequence), &[]);
        }
        let order: Vec<_> = assembler
            .drain()
            .map(|timeline| (timeline.session, timeline.sequence))
            .collect();
        assert_eq!(order, [(900, 50), (900, 51), (3, 0), (3, 1)]);
    }

    #[test]
    fn unknown_spans_are_counted_and_left_out() {
        let mut assembler = FrameAssembler::default();
        let broken = Span {
            stage: 4_000_000,
            ..Span::default()
        };
        assembler.add(&header(ProcessKind::CAMERA, 1, 1), &[broken]);
        assembler.add(&TraceHeader::default(), &[broken, broken]);
        assert_eq!(assembler.n_unknown(), 3);
        assert!(
            assembler
                .drain()
                .all(|timeline| timeline.intervals.is_empty())
        );
    }
}
