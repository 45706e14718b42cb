//! Player of a recording's frames, each with the states of arm and people before it.

use crate::documents::{ArmDocument, PersonDocument};
use crate::{Error, FrameRecord, InvalidRecord, ReadSummary, RecordingReader};
use message::service_name::{ARM_STATE, CAMERA_CLOUD, PERSON_BODY};
use message::{ArmState, CloudPoint, PersonBody, WireCapsule};
use std::collections::VecDeque;
use std::io::Read;

/// Largest number of states that wait for their frame. A recording has eight of them for a
/// frame, a hostile one could have any number.
const MAX_WAITING: usize = 4096;

/// Recorded state of the arm and its capsules.
pub type ArmSample = (ArmState, Vec<WireCapsule>);
/// Recorded bodies of people.
pub type PersonSample = (PersonBody, Vec<WireCapsule>);

/// Frame of a recording with what was published before it.
#[derive(Debug, Default)]
pub struct PlayedFrame {
    data: Vec<u8>,
    capture_ns: u64,
    n_points: usize,
    /// States of the arm up to the frame's capture, in their order.
    pub arm: Vec<ArmSample>,
    /// Bodies of people up to the frame's capture, in their order.
    pub people: Vec<PersonSample>,
}

impl PlayedFrame {
    /// Capture time of the frame on the recording's clock, nanoseconds.
    pub fn capture_ns(&self) -> u64 {
        self.capture_ns
    }

    /// Number of points of the frame.
    pub fn n_points(&self) -> usize {
        self.n_points
    }

    /// Header and planes of the frame.
    ///
    /// # Errors
    /// When the frame is damaged.
    pub fn record(&self) -> Result<FrameRecord<'_>, InvalidRecord> {
        FrameRecord::parse(&self.data)
    }

    /// Decodes the points, row by row.
    ///
    /// # Errors
    /// When the frame is damaged, or the buffer has another length.
    pub fn fill(&self, points: &mut [CloudPoint]) -> Result<(), InvalidRecord> {
        self.record()?.fill(points)
    }
}

/// Player of the frames of one recording, front to back.
pub struct FramePlayer<R> {
    reader: RecordingReader<R>,
    arm: VecDeque<ArmSample>,
    people: VecDeque<PersonSample>,
    n_unusable: u64,
}

impl<R: Read> FramePlayer<R> {
    /// Player of a file of this length, bytes.
    pub fn new(input: R, file_bytes: u64) -> Self {
        Self {
            reader: RecordingReader::new(input, file_bytes),
            arm: VecDeque::new(),
            people: VecDeque::new(),
            n_unusable: 0,
        }
    }

    /// Next frame with a valid header; `None` at the end. States later than its capture wait for
    /// the next one.
    ///
    /// # Errors
    /// When the file cannot be read, or is no MCAP file.
    pub fn next_frame(&mut self) -> Result<Option<PlayedFrame>, Error> {
        while let Some(message) = self.reader.next_message()? {
            match message.channel.topic.as_str() {
                ARM_STATE => match serde_json::from_slice::<ArmDocument>(message.data) {
                    Ok(document) => push(&mut self.arm, document.to_wire()),
                    Err(_) => self.n_unusable += 1,
                },
                PERSON_BODY => match serde_json::from_slice::<PersonDocument>(message.data) {
                    Ok(document) => push(&mut self.people, document.to_wire()),
                    Err(_) => self.n_unusable += 1,
                },
                CAMERA_CLOUD => match FrameRecord::parse(message.data) {
                    Ok(record) => {
                        let (capture_ns, n_points) =
                            (record.header.capture_stamp_ns, record.n_points());
                        let data = message.data.to_vec();
                        return Ok(Some(self.played(data, capture_ns, n_points)));
                    }
                    Err(_) => self.n_unusable += 1,
                },
                _ => {}
            }
        }
        Ok(None)
    }

    fn played(&mut self, data: Vec<u8>, capture_ns: u64, n_points: usize) -> PlayedFrame {
        let arm = up_to(&mut self.arm, |(state, _)| state.stamp_ns <= capture_ns);
        let people = up_to(&mut self.people, |(body, _)| body.stamp_ns <= capture_ns);
        PlayedFrame {
            data,
            capture_ns,
            n_points,
            arm,
            people,
        }
    }

    /// Number of frames and states left out because they are damaged.
    pub fn n_unusable(&self) -> u64 {
        self.n_unusable
    }

    /// Summary of reading the file so far.
    pub fn summary(&self) -> ReadSummary {
        self.reader.summary()
    }
}

/// Appends a state; the oldest makes room.
fn push<T>(waiting: &mut VecDeque<T>, state: T) {
    if waiting.len() >= MAX_WAITING {
        waiting.pop_front();
    }
    waiting.push_back(state);
}

/// Takes the states for which a predicate holds, in their order.
fn up_to<T>(waiting: &mut VecDeque<T>, is_due: impl Fn(&T) -> bool) -> Vec<T> {
    let (due, later) = std::mem::take(waiting).into_iter().partition(is_due);
    *waiting = Vec::into(later);
    due
}
