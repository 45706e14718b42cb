//! Recordings: what was written is read back; cut, damaged and hostile files give what is intact.
#![expect(clippy::unwrap_used, reason = "test helpers may panic")]

use geometry::PinholeCamera;
use mcap::records::op;
use message::{
    ArmState, CloudPoint, FrameHeader, PersonBody, SceneSummary, WireCapsule, frame_flag,
    service_name,
};
use mutation_fuzzing::{assert_sentence, fuzz};
use recording::documents::{ArmDocument, PersonDocument};
use recording::{
    ChannelSpec, Error, FramePlayer, MessageTime, PlayedFrame, ReadSummary, RecordingInfo,
    RecordingReader, RecordingWriter, encode_frame, recover,
};
use scene_document::HealthDocument;
use std::io::Read;

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
        let scene = message::document::scene(&SceneSummary::default(), &[], 0);
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

/// Places of the records of a file with this code: begin of the code, and end.
fn records(file: &[u8], opcode: u8) -> Vec<std::ops::Range<usize>> {
    let mut records = Vec::new();
    let mut at = mcap::MAGIC.len();
    while let Some(head) = file.get(at..at + 9) {
        let length = u64::from_le_bytes(head[1..].try_into().unwrap()) as usize;
        let end = at.saturating_add(9).saturating_add(length);
        if end > file.len() {
            break;
        }
        if head[0] == opcode {
            records.push(at..end);
        }
        at = end;
    }
    records
}

/// Reads all messages; returns the summary.
fn summary(file: &[u8]) -> ReadSummary {
    let mut reader = RecordingReader::new(file, file.len() as u64);
    while reader.next_message().unwrap().is_some() {}
    reader.summary()
}

#[test]
fn recovery_leaves_out_only_the_chunk_that_is_damaged() {
    for whole in [recorded(false), recorded(true)] {
        let chunks = records(&whole, op::CHUNK);
        assert!(chunks.len() as u64 > N_FRAMES);
        let mut n_lost = 0;
        for chunk in chunks {
            let mut file = whole.clone();
            // Behind the header, in what is compressed.
            file[usize::midpoint(chunk.start, chunk.end)] ^= 0x5a;
            let mut recovered = Vec::new();
            let report = recover(&file[..], file.len() as u64, &mut recovered).unwrap();
            let read = report.read;
            assert_eq!((read.n_damaged_chunks, read.n_without_channel), (1, 0));
            assert!(report.n_frames >= N_FRAMES - 1, "{report:?}");
            n_lost += N_FRAMES - report.n_frames;
            assert_eq!(frames(&recovered).0.len() as u64, report.n_frames);
        }
        assert_eq!(n_lost, N_FRAMES);
    }
}

#[test]
fn chunk_with_a_damaged_code_is_read_and_counted() {
    let whole = recorded(false);
    for chunk in records(&whole, op::CHUNK) {
        for bit in 0..8 {
            let mut file = whole.clone();
            file[chunk.start] ^= 1 << bit;
            let (frames, player) = frames(&file);
            assert_eq!(frames.len() as u64, N_FRAMES, "bit {bit}");
            assert_eq!(player.summary().n_damaged_records, 1, "bit {bit}");
        }
    }
}

#[test]
fn recording_is_complete_only_with_its_whole_end() {
    let whole = recorded(false);
    let read = summary(&whole);
    assert!(read.is_complete && read.n_damaged_records == 0, "{read:?}");
    let data_end = records(&whole, op::DATA_END).remove(0);
    for length in [
        data_end.start,
        data_end.end,
        whole.len() - 9,
        whole.len() - 1,
    ] {
        assert!(!summary(&whole[..length]).is_complete, "{length}");
    }
    let mut longer = whole.clone();
    longer.push(0);
    assert!(!summary(&longer).is_complete);
    // As a file system leaves what it had not written.
    let mut cut = whole[..data_end.start].to_vec();
    cut.resize(cut.len() + 4000, 0);
    assert_eq!(summary(&cut).lost_bytes, 4000);
}

/// File of one chunk without compression and checksum.
fn plain_chunk(content: &[u8], n_padding: usize) -> Vec<u8> {
    let mut chunk = vec![0; 16];
    chunk.extend((content.len() as u64).to_le_bytes());
    chunk.extend([0; 8]);
    chunk.extend((content.len() as u64).to_le_bytes());
    chunk.extend(content);
    chunk.resize(chunk.len() + n_padding, 0);
    [mcap::MAGIC, &record(op::CHUNK, &chunk)].concat()
}

fn record(opcode: u8, content: &[u8]) -> Vec<u8> {
    let length = (content.len() as u64).to_le_bytes();
    [&[opcode][..], &length, content].concat()
}

/// Chunk whose record reaches into the padding behind it.
fn chunk_with_a_long_record() -> Vec<u8> {
    let head = record(op::MESSAGE, &[0; 50]);
    plain_chunk(&head[..10], 90)
}

#[test]
fn record_that_is_longer_than_its_chunk_is_damage() {
    let read = summary(&chunk_with_a_long_record());
    assert_eq!((read.n_damaged_chunks, read.lost_bytes), (1, 0));
}

#[test]
fn chunk_within_a_chunk_is_damage() {
    let inner = recorded(false);
    let inner = &inner[records(&inner, op::CHUNK).remove(0)];
    let content = [inner, &record(op::MESSAGE, &[0; 30])].concat();
    let read = summary(&plain_chunk(&content, 0));
    assert_eq!((read.n_chunks, read.n_damaged_records), (1, 1));
    // The outer chunk goes on behind it.
    assert_eq!(read.n_without_channel, 1);
}

#[test]
fn chunk_with_another_compression_is_counted_apart() {
    let mut file = recorded(false);
    for chunk in records(&file, op::CHUNK) {
        let name = chunk.start + 9 + 32;
        assert_eq!(&file[name..name + 4], b"zstd");
        file[name..name + 4].copy_from_slice(b"lzma");
    }
    let read = summary(&file);
    assert_eq!((read.n_damaged_chunks, read.n_messages), (0, 0));
    assert!(read.n_unsupported_chunks > N_FRAMES);
}

#[test]
fn recovery_of_a_file_with_too_many_channels_keeps_the_first() {
    let mut content = Vec::new();
    for id in 0..u16::MAX {
        let id = id.to_le_bytes();
        let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
        let name = text(&u16::from_le_bytes(id).to_string());
        let schema = [&id[..], &name, &text(""), &text("")].concat();
        content.extend(record(op::SCHEMA, &schema));
        let channel = [&id[..], &id, &name, &text(""), &text("")].concat();
        content.extend(record(op::CHANNEL, &channel));
        content.extend(record(op::MESSAGE, &[&id[..], &[0; 20]].concat()));
    }
    let file = plain_chunk(&content, 0);
    let mut recovered = Vec::new();
    let report = recover(&file[..], file.len() as u64, &mut recovered).unwrap();
    assert!(report.read.n_messages > 1000, "{report:?}");
    assert!(report.read.n_without_channel > 1000, "{report:?}");
    assert_eq!(summary(&recovered).n_messages, report.read.n_messages);
}

/// Medium that fails behind some bytes.
struct FailingDisk<'a>(&'a [u8]);

impl Read for FailingDisk<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        match self.0.read(buffer)? {
            0 => Err(std::io::Error::other("bad sector")),
            n => Ok(n),
        }
    }
}

#[test]
fn recovery_keeps_what_is_before_an_error_of_the_medium() {
    let whole = recorded(false);
    let chunk = records(&whole, op::CHUNK).pop().unwrap();
    let (good, n_bytes) = (&whole[..chunk.start + 20], whole.len() as u64);
    let mut recovered = Vec::new();
    let report = recover(FailingDisk(good), n_bytes, &mut recovered).unwrap();
    assert_eq!(report.read_error, "bad sector");
    assert_eq!(report.read.lost_bytes, n_bytes - chunk.start as u64);
    assert!(!report.read.is_complete);
    assert_eq!(report.n_frames, N_FRAMES - 1);
    assert_eq!(frames(&recovered).0.len() as u64, N_FRAMES - 1);
}

#[test]
fn recovery_keeps_the_origin_and_all_schemas_of_a_topic() {
    let mut file = std::io::Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new().create(&mut file).unwrap();
    let metadata = [("format_version", "1"), ("origin", "kitchen")];
    let metadata = metadata.map(|(key, value)| (key.to_owned(), value.to_owned()));
    let metadata = mcap::records::Metadata {
        name: "tabula.recording".into(),
        metadata: metadata.into(),
    };
    writer.write_metadata(&metadata).unwrap();
    let none = std::collections::BTreeMap::new();
    for (log_time, name) in [(1, "First"), (2, "Second")] {
        let schema = writer.add_schema(name, "jsonschema", b"{}").unwrap();
        let channel_id = writer.add_channel(schema, "scene", "json", &none).unwrap();
        let header = mcap::records::MessageHeader {
            channel_id,
            sequence: 0,
            log_time,
            publish_time: log_time,
        };
        writer.write_to_known_channel(&header, b"{}").unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    let file = file.into_inner();
    let mut recovered = Vec::new();
    recover(&file[..], file.len() as u64, &mut recovered).unwrap();
    let mut reader = RecordingReader::new(&recovered[..], recovered.len() as u64);
    let mut schemas = Vec::new();
    while let Some(message) = reader.next_message().unwrap() {
        schemas.push(message.channel.schema.name.clone());
    }
    assert_eq!(schemas, ["First", "Second"]);
    assert_eq!(reader.metadata().unwrap().origin, "kitchen");
}

/// Recording of one message on a topic of JSON documents, and a frame.
fn with_state(topic: &str, state: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut writer = RecordingWriter::new(&mut file, "test").unwrap();
    let channel = ChannelSpec::json::<ArmDocument>(topic);
    writer.add_channel(&channel).unwrap();
    writer.write(topic, MessageTime::at(1), state).unwrap();
    let mut bytes = Vec::new();
    for _ in 0..2 {
        let mut header = header(1);
        header.flags |= frame_flag::LOCKSTEP;
        encode_frame(&header, &points(1), &mut bytes).unwrap();
        writer.write_frame(MessageTime::at(2), &bytes).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    file
}

#[test]
fn player_leaves_out_states_beyond_the_bounds_of_a_message() {
    let capsules = |n| vec![WireCapsule::default(); n];
    let arm = |n| ArmDocument::new(&ArmState::default(), &capsules(n));
    let person = |n| PersonDocument::new(&PersonBody::default(), &capsules(n));
    let most = message::MAX_CAPSULES;
    let long = format!("{{\"note\":\"{}\"}}", " ".repeat(70_000));
    for (topic, state, reason) in [
        (
            service_name::ARM_STATE,
            serde_json::to_string(&arm(most)),
            None,
        ),
        (
            service_name::ARM_STATE,
            serde_json::to_string(&arm(most + 1)),
            Some("33 capsules"),
        ),
        (
            service_name::PERSON_BODY,
            serde_json::to_string(&person(most)),
            None,
        ),
        (
            service_name::PERSON_BODY,
            serde_json::to_string(&person(most + 1)),
            Some("33 capsules"),
        ),
        (
            service_name::ARM_STATE,
            Ok(long),
            Some("more than any state"),
        ),
        (
            service_name::PERSON_BODY,
            Ok("{}".to_owned()),
            Some("no state"),
        ),
    ] {
        let file = with_state(topic, state.unwrap().as_bytes());
        let (frames, player) = frames(&file);
        let n_states = frames[0].arm.len() + frames[0].people.len();
        assert_eq!(n_states, usize::from(reason.is_none()));
        let unusable = player.first_unusable();
        assert_eq!(
            unusable.map(|unusable| unusable.topic),
            reason.map(|_| topic)
        );
        let sentence = unusable.map(|unusable| unusable.reason.to_string());
        let is_named = sentence
            .unwrap_or_default()
            .contains(reason.unwrap_or_default());
        assert!(is_named, "{unusable:?}");
    }
}

#[test]
fn player_gives_a_frame_that_was_sent_again_in_lockstep_once() {
    let file = with_state(service_name::HEALTH, b"{}");
    let (frames, _) = frames(&file);
    assert_eq!(sequences(&frames), [1]);
}

#[test]
fn player_refuses_a_newer_format() {
    let mut file = recorded(false);
    let key = b"format_version";
    let at = file.windows(key.len()).position(|bytes| bytes == key);
    file[at.unwrap() + key.len() + 4] = b'9';
    let mut player = FramePlayer::new(&file[..], file.len() as u64);
    let error = player.next_frame().unwrap_err();
    assert!(error.to_string().contains("format 9"), "{error}");
    // Recovery reads no content.
    let mut recovered = Vec::new();
    let report = recover(&file[..], file.len() as u64, &mut recovered).unwrap();
    assert_eq!(report.n_frames, N_FRAMES);
}

#[test]
fn info_counts_messages_by_topic_and_gaps_between_frames() {
    let mut file = Vec::new();
    let mut writer = RecordingWriter::new(&mut file, "kitchen").unwrap();
    let mut bytes = Vec::new();
    for sequence in [3, 4, 7, 9] {
        encode_frame(&header(sequence), &points(sequence), &mut bytes).unwrap();
        let time = MessageTime::at(sequence * 1_000_000_000);
        writer.write_frame(time, &bytes).unwrap();
    }
    let health = HealthDocument::default();
    let late = MessageTime::at(11_000_000_000);
    writer
        .write_document(service_name::HEALTH, late, &health)
        .unwrap();
    writer.finish().unwrap();
    drop(writer);
    let info = RecordingInfo::read(&file[..], file.len() as u64).unwrap();
    assert_eq!(info.metadata.unwrap().origin, "kitchen");
    assert!(info.read.is_complete);
    assert_eq!((info.n_gaps, info.n_missing_frames), (2, 3));
    assert_eq!(info.all.span_ns, Some((3_000_000_000, 11_000_000_000)));
    let frames = info.topics[service_name::CAMERA_CLOUD];
    // Three intervals in eight seconds.
    let recording_s = info.all.seconds();
    let rate_hz = frames.rate_hz(recording_s);
    assert_eq!((frames.n_messages, rate_hz), (4, Some(0.375)));
    assert_eq!(frames.rate_hz(0.099), None);
    assert_eq!(frames.n_bytes, 4 * bytes.len() as u64);
    assert_eq!(info.topics[service_name::HEALTH].rate_hz(recording_s), None);
}

#[test]
fn recording_without_frames_has_none() {
    let mut file = Vec::new();
    let mut writer = RecordingWriter::new(&mut file, "test").unwrap();
    let health = HealthDocument::default();
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
    fuzz(
        &[whole, small_uncompressed(), chunk_with_a_long_record()],
        |bytes| {
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
        },
    );
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
