//! Player of a recording's frames, each with the states of arm and people before it.

use crate::documents::{ArmDocument, CapsuleDocument, PersonDocument};
use crate::{Error, FORMAT_VERSION, FrameRecord, InvalidRecord, ReadSummary, RecordingReader};
use message::service_name::{ARM_STATE, CAMERA_CLOUD, PERSON_BODY};
use message::{ArmState, CloudPoint, MAX_CAPSULES, PersonBody, WireCapsule, frame_flag};
use serde::de::DeserializeOwned;
use std::collections::VecDeque;
use std::io::Read;

/// Largest number of states that wait for their frame. A recording has eight of them for a
/// frame, a hostile one could have any number.
const MAX_WAITING: usize = 4096;
/// Largest state, bytes. One of 32 capsules has about 6 kB.
const MAX_STATE_BYTES: usize = 1 << 16;

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
    /// Session and sequence of the newest frame.
    newest: Option<(u64, u64)>,
    n_unusable: u64,
    first_unusable: Option<UnusableMessage>,
}

/// Message that was left out because it is damaged.
#[derive(Debug, Clone, PartialEq)]
pub struct UnusableMessage {
    /// Topic of the message.
    pub topic: &'static str,
    /// Reason why it cannot be used.
    pub reason: InvalidRecord,
}

impl<R: Read> FramePlayer<R> {
    /// Player of a file of this length, bytes.
    pub fn new(input: R, file_bytes: u64) -> Self {
        Self {
            reader: RecordingReader::new(input, file_bytes),
            arm: VecDeque::new(),
            people: VecDeque::new(),
            newest: None,
            n_unusable: 0,
            first_unusable: None,
        }
    }

    /// Next frame with a valid header; `None` at the end. States later than its capture wait for
    /// the next one. A frame that was sent again in lockstep comes once.
    ///
    /// # Errors
    /// When the file cannot be read, is no MCAP file, or has a newer format.
    pub fn next_frame(&mut self) -> Result<Option<PlayedFrame>, Error> {
        while self.reader.advance()? {
            self.check_version()?;
            let Some(message) = self.reader.message() else {
                break;
            };
            let data = message.data;
            let (topic, taken) = match message.channel.topic.as_str() {
                ARM_STATE => (ARM_STATE, take_state(data, &mut self.arm, arm_sample)),
                PERSON_BODY => {
                    let taken = take_state(data, &mut self.people, person_sample);
                    (PERSON_BODY, taken)
                }
                CAMERA_CLOUD => match FrameRecord::parse(data) {
                    Ok(FrameRecord { header, camera, .. }) => {
                        let number = Some((header.session, header.sequence));
                        if self.newest == number && header.has(frame_flag::LOCKSTEP) {
                            continue;
                        }
                        self.newest = number;
                        let data = data.to_vec();
                        let capture_ns = header.capture_stamp_ns;
                        return Ok(Some(self.played(data, capture_ns, camera.n_pixels())));
                    }
                    Err(reason) => (CAMERA_CLOUD, Err(reason)),
                },
                _ => continue,
            };
            if let Err(reason) = taken {
                self.n_unusable += 1;
                let unusable = UnusableMessage { topic, reason };
                self.first_unusable.get_or_insert(unusable);
            }
        }
        Ok(None)
    }

    fn check_version(&self) -> Result<(), Error> {
        let metadata = self.reader.metadata();
        match metadata.map(|metadata| metadata.format_version) {
            Some(found) if found > FORMAT_VERSION => Err(Error::Version {
                found,
                known: FORMAT_VERSION,
            }),
            _ => Ok(()),
        }
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

    /// First of the messages left out.
    pub fn first_unusable(&self) -> Option<&UnusableMessage> {
        self.first_unusable.as_ref()
    }

    /// Summary of reading the file so far.
    pub fn summary(&self) -> ReadSummary {
        self.reader.summary()
    }
}

/// Reads a state and appends it; the oldest makes room.
fn take_state<T>(
    data: &[u8],
    waiting: &mut VecDeque<T>,
    parse: impl Fn(&[u8]) -> Result<T, InvalidRecord>,
) -> Result<(), InvalidRecord> {
    if data.len() > MAX_STATE_BYTES {
        return Err(InvalidRecord::StateLength(data.len()));
    }
    let state = parse(data)?;
    if waiting.len() >= MAX_WAITING {
        waiting.pop_front();
    }
    waiting.push_back(state);
    Ok(())
}

fn arm_sample(data: &[u8]) -> Result<ArmSample, InvalidRecord> {
    let document: ArmDocument = from_json(data)?;
    check_capsules(&document.capsules)?;
    Ok(document.to_wire())
}

fn person_sample(data: &[u8]) -> Result<PersonSample, InvalidRecord> {
    let document: PersonDocument = from_json(data)?;
    check_capsules(&document.capsules)?;
    Ok(document.to_wire())
}

fn from_json<T: DeserializeOwned>(data: &[u8]) -> Result<T, InvalidRecord> {
    serde_json::from_slice(data).map_err(|error| InvalidRecord::State(error.to_string()))
}

fn check_capsules(capsules: &[CapsuleDocument]) -> Result<(), InvalidRecord> {
    if capsules.len() > MAX_CAPSULES {
        return Err(InvalidRecord::Capsules(capsules.len()));
    }
    Ok(())
}

/// Takes the states for which a predicate holds, in their order.
fn up_to<T>(waiting: &mut VecDeque<T>, is_due: impl Fn(&T) -> bool) -> Vec<T> {
    let (due, later) = std::mem::take(waiting).into_iter().partition(is_due);
    *waiting = Vec::into(later);
    due
}
