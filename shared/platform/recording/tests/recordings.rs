//! Recordings: what was written is read back; cut, damaged and hostile files give what is intact.
#![expect(clippy::unwrap_used, reason = "test helpers may panic")]

use geometry::PinholeCamera;
use message::{
    ArmState, CloudPoint, FrameHeader, Health, PersonBody, SceneSummary, WireCapsule, service_name,
};
use mutation_fuzzing::{assert_sentence, fuzz};
use recording::documents::{ArmDocument, HealthDocument, PersonDocument, SceneDocument};
use recording::{
    Error, FramePlayer, MessageTime, PlayedFrame, RecordingReader, RecordingWriter, encode_frame,
    recover,
};

const N_FRAMES: u64 = 6;
const FRAME_NS: u64 = 33_000_000;

fn camera() -> PinholeCamera {
    PinholeCamera {
        fx_px: 40.0,
        fy_px: 40.0,
        cx_px: 15.5,
        cy_px: 11.5,
        width: 32,
        height: 24,
    }
}

fn header(sequence: u64) -> FrameHeader {
    let mut header = FrameHeader {
        session: 5,
        sequence,
        capture_stamp_ns: sequence * FRAME_NS,
        ..FrameHeader::default()
    };
    header.set_camera(&camera());
    header
}

fn points(sequence: u64) -> Vec<CloudPoint> {
    let point = |i: u32| CloudPoint {
        x: i as f32,
        y: 0.5,
        z: 1.0 + sequence as f32,
        argb: i.wrapping_mul(2_654_435_761),
    };
    (0..camera().n_pixels() as u32).map(point).collect()
}

/// Writes frames, each with a state of the arm before its capture and one behind it.
fn write_frames(writer: &mut RecordingWriter<&mut Vec<u8>>, is_flushed: bool) {
    let mut bytes = Vec::new();
    for sequence in 0..N_FRAMES {
        let header = header(sequence);
        let time = MessageTime::at(1_000 + header.capture_stamp_ns);
        for stamp_ns in [
            header.capture_stamp_ns,
            header.capture_stamp_ns + FRAME_NS / 2,
        ] {
            let state = ArmState {
                stamp_ns,
                ..ArmState::default()
            };
            let arm = ArmDocument::new(&state, &[WireCapsule::default()]);
            writer
                .write_document(service_name::ARM_STATE, time, &arm)
                .unwrap();
        }
        let body = PersonBody {
            stamp_ns: header.capture_stamp_ns,
            ..PersonBody::default()
        };
        let person = PersonDocument::new(&body, &[]);
        writer
            .write_document(service_name::PERSON_BODY, time, &person)
            .unwrap();
        encode_frame(&header, &points(sequence), &mut bytes).unwrap();
        writer.write_frame(time, &bytes).unwrap();
        let scene = SceneDocument::new(&SceneSummary::default(), &[]);
        writer
            .write_document(service_name::SCENE, time, &scene)
            .unwrap();
        if is_flushed {
            writer.flush().unwrap();
        }
    }
}

/// Recording with a chunk for each frame; not closed if `is_cut`.
fn recorded(is_cut: bool) -> Vec<u8> {
    let mut file = Vec::new();
    let mut writer = RecordingWriter::new(&mut file, "test").unwrap();
    write_frames(&mut writer, true);
    if is_cut {
        // As a killed process leaves it.
        std::mem::forget(writer);
    } else {
        writer.finish().unwrap();
        drop(writer);
    }
    file
}

fn frames(file: &[u8]) -> (Vec<PlayedFrame>, FramePlayer<&[u8]>) {
    let mut player = FramePlayer::new(file, file.len() as u64);
    let mut frames = Vec::new();
    while let Some(frame) = player.next_frame().unwrap() {
        frames.push(frame);
    }
    (frames, player)
}

fn sequences(frames: &[PlayedFrame]) -> Vec<u64> {
    let sequence = |frame: &PlayedFrame| frame.record().unwrap().header.sequence;
    frames.iter().map(sequence).collect()
}

#[test]
fn recording_gives_its_frames_back_with_the_states_before_each() {
    let file = recorded(false);
    let (frames, player) = frames(&file);
    assert!(player.summary().is_complete);
    assert_eq!(frames.len() as u64, N_FRAMES);
    for (sequence, frame) in (0..).zip(&frames) {
        let record = frame.record().unwrap();
        assert_eq!(record.header, header(sequence));
        let mut read = vec![CloudPoint::default(); frame.n_points()];
        frame.fill(&mut read).unwrap();
        assert_eq!(read, points(sequence));
        let stamps: Vec<u64> = frame.arm.iter().map(|(state, _)| state.stamp_ns).collect();
        let capture_ns = sequence * FRAME_NS;
        let expected = match sequence {
            0 => vec![0],
            _ => vec![capture_ns - FRAME_NS / 2, capture_ns],
        };
        assert_eq!(stamps, expected);
        assert_eq!(frame.people[0].0.stamp_ns, capture_ns);
    }
}

#[test]
fn recording_of_a_killed_writer_has_all_flushed_frames() {
    let file = recorded(true);
    let (frames, player) = frames(&file);
    assert_eq!(sequences(&frames), [0, 1, 2, 3, 4, 5]);
    assert!(!player.summary().is_complete);
}

#[test]
fn recovery_of_a_file_cut_anywhere_keeps_all_whole_chunks() {
    let file = recorded(false);
    let mut n_frames_before = 0;
    for length in (0..file.len()).step_by(97).chain([file.len()]) {
        let cut = &file[..length];
        let mut recovered = Vec::new();
        let report = match recover(cut, length as u64, &mut recovered) {
            Ok(report) => report,
            Err(Error::NotMcap) if length < 8 => continue,
            Err(error) => panic!("{length}: {error}"),
        };
        assert!(report.n_frames >= n_frames_before, "{length}");
        n_frames_before = report.n_frames;
        let (frames, player) = frames(&recovered);
        assert_eq!(frames.len() as u64, report.n_frames);
        assert!(player.summary().is_complete);
    }
    assert_eq!(n_frames_before, N_FRAMES);
}

#[test]
fn recovery_leaves_a_damaged_chunk_out_and_counts_it() {
    let mut file = recorded(false);
    let third = file.len() / 3;
    for byte in &mut file[third..third + 8] {
        *byte ^= 0x5a;
    }
    let mut recovered = Vec::new();
    let report = recover(&file[..], file.len() as u64, &mut recovered).unwrap();
    assert_eq!(report.read.n_damaged_chunks, 1);
    assert_eq!(report.n_frames, N_FRAMES - 1);
    assert_eq!(report.read.lost_bytes, 0);
    assert_eq!(frames(&recovered).0.len() as u64, N_FRAMES - 1);
}

#[test]
fn recording_without_frames_has_none() {
    let mut file = Vec::new();
    let mut writer = RecordingWriter::new(&mut file, "test").unwrap();
    let health = HealthDocument::from(&Health::default());
    writer
        .write_document(service_name::HEALTH, MessageTime::at(1), &health)
        .unwrap();
    writer.finish().unwrap();
    drop(writer);
    assert_eq!(frames(&file).0.len(), 0);
}

#[test]
fn file_of_another_kind_is_refused() {
    for file in [&b""[..], b"P6 640 480", &[0; 4000]] {
        let mut reader = RecordingReader::new(file, file.len() as u64);
        let error = reader.next_message().unwrap_err();
        assert!(matches!(error, Error::NotMcap), "{error}");
    }
}

#[test]
fn chunk_that_promises_more_than_its_file_accounts_for_is_left_out() {
    const CONTENT_BYTES: usize = 64 << 20;
    let mut file = std::io::Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new().chunk_size(Some(1 << 30));
    let mut writer = options.create(&mut file).unwrap();
    let none = std::collections::BTreeMap::new();
    let id = writer.add_channel(0, "zeros", "none", &none).unwrap();
    let header = mcap::records::MessageHeader {
        channel_id: id,
        sequence: 0,
        log_time: 0,
        publish_time: 0,
    };
    let zeros = vec![0; CONTENT_BYTES];
    writer.write_to_known_channel(&header, &zeros).unwrap();
    writer.finish().unwrap();
    drop(writer);
    let file = file.into_inner();
    assert!(file.len() < 32_000, "{} bytes", file.len());
    let mut reader = RecordingReader::new(&file[..], file.len() as u64);
    assert!(reader.next_message().unwrap().is_none());
    assert_eq!(reader.summary().n_damaged_chunks, 1);
}

#[test]
fn fuzz_recordings() {
    let whole = recorded(false);
    // Without compression, corruptions reach the records and the frames.
    fuzz(&[whole, small_uncompressed()], |bytes| {
        let mut player = FramePlayer::new(bytes, bytes.len() as u64);
        loop {
            match player.next_frame() {
                Ok(Some(frame)) => {
                    let mut read = vec![CloudPoint::default(); frame.n_points()];
                    frame.fill(&mut read).unwrap();
                }
                Ok(None) => break,
                Err(error) => {
                    assert_sentence(&error);
                    break;
                }
            }
        }
    });
}

/// Recording of one small frame as plain records, without chunks and checksums.
fn small_uncompressed() -> Vec<u8> {
    let mut header = FrameHeader::default();
    header.set_camera(&PinholeCamera {
        fx_px: 4.0,
        fy_px: 4.0,
        cx_px: 1.5,
        cy_px: 1.0,
        width: 4,
        height: 3,
    });
    let mut bytes = Vec::new();
    encode_frame(&header, &[CloudPoint::default(); 12], &mut bytes).unwrap();
    let mut file = std::io::Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new()
        .use_chunks(false)
        .compression(None);
    let mut writer = options.create(&mut file).unwrap();
    let none = std::collections::BTreeMap::new();
    let topic = service_name::CAMERA_CLOUD;
    let id = writer.add_channel(0, topic, "tabula-frame", &none).unwrap();
    let header = mcap::records::MessageHeader {
        channel_id: id,
        sequence: 0,
        log_time: 0,
        publish_time: 0,
    };
    writer.write_to_known_channel(&header, &bytes).unwrap();
    writer.finish().unwrap();
    drop(writer);
    file.into_inner()
}
