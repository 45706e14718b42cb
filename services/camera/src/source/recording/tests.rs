use super::*;
use crate::source::playback_clock::SESSION_GAP_NS;
use geometry::PinholeCamera;
use message::CloudPoint;
use recording::{MessageTime, RecordingWriter, encode_frame};

fn camera() -> PinholeCamera {
    PinholeCamera {
        fx_px: 4.0,
        fy_px: 4.0,
        cx_px: 1.5,
        cy_px: 1.0,
        width: 4,
        height: 3,
    }
}

/// Writes frames with these capture times; the depth of frame `n` is `n` metres.
fn record(path: &Path, captures_ns: &[u64]) {
    let mut writer = RecordingWriter::new(File::create(path).unwrap(), "test").unwrap();
    let mut bytes = Vec::new();
    for (sequence, &capture_stamp_ns) in (0..).zip(captures_ns) {
        let mut header = FrameHeader {
            sequence,
            capture_stamp_ns,
            flags: frame_flag::HAS_WORLD_POSE,
            ..FrameHeader::default()
        };
        header.set_camera(&camera());
        // A rotation by an angle whose matrix changes when it is converted to a quaternion.
        let (sin, cos) = 0.1_f64.sin_cos();
        header.world_from_camera.rows[0] = [cos, -sin, 0.0, 0.3];
        header.world_from_camera.rows[1] = [sin, cos, 0.0, 0.1];
        let z = sequence as f32;
        let points = [CloudPoint {
            z,
            ..CloudPoint::default()
        }; 12];
        encode_frame(&header, &points, &mut bytes).unwrap();
        writer
            .write_frame(MessageTime::at(capture_stamp_ns), &bytes)
            .unwrap();
    }
    writer.finish().unwrap();
}

/// Depths and times of the frames that are played, at most `n`.
fn played(path: &Path, playback: &Playback, n: usize) -> Vec<(f32, Option<u64>)> {
    let mut source = RecordingSource::open(path, playback, None).unwrap();
    let mut frames = Vec::new();
    let mut points = [Point::default(); 12];
    while frames.len() < n && source.prepare().unwrap().is_some() {
        source.fill(&mut points).unwrap();
        frames.push((points[5].z, source.frame_time_ns()));
    }
    frames
}

#[test]
fn recording_is_played_at_its_own_intervals() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    // The third frame is of another session, whose clock begins anew.
    record(&path, &[500, 540, 100, 160]);
    let gap = SESSION_GAP_NS;
    let times = [0, 40, 40 + gap, 100 + gap];
    let expected = |n: usize, time: u64| (n as f32, Some(time));
    let all = played(&path, &Playback::default(), 9);
    let of_one_round: Vec<_> = (0..4).map(|n| expected(n, times[n])).collect();
    assert_eq!(all, of_one_round);
    let part = Playback {
        from: Some(1),
        to: Some(3),
        looped: true,
        ..Playback::default()
    };
    let looped = played(&path, &part, 3);
    assert_eq!(
        looped,
        [expected(1, 0), expected(2, gap), expected(1, 440 + gap)]
    );
    let at_rate = Playback {
        rate_hz: Some(10.0),
        ..Playback::default()
    };
    assert_eq!(played(&path, &at_rate, 1), [(0.0, None)]);
}

#[test]
fn recording_gives_its_pose_back_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    record(&path, &[500]);
    let mut source = RecordingSource::open(&path, &Playback::default(), None).unwrap();
    source.prepare().unwrap();
    let info = source.fill(&mut [Point::default(); 12]).unwrap();
    let mut header = FrameHeader::default();
    let pose = info.world_from_camera.unwrap();
    header.world_from_camera = message::WireTransform::from(&pose);
    source.complete_header(&mut header);
    assert_eq!(header.world_from_camera.rows[0][0], 0.1_f64.cos());
    assert_eq!(header.world_from_camera.rows[1][0], 0.1_f64.sin());
}

#[test]
fn recording_tells_what_it_lacks_only_when_it_was_read_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    record(&path, &[1, 2, 3]);
    let lack = |to: Option<usize>| {
        let playback = Playback {
            to,
            ..Playback::default()
        };
        let mut source = RecordingSource::open(&path, &playback, None).unwrap();
        while source.next_frame().unwrap().is_some() {}
        source.lack()
    };
    assert_eq!([lack(Some(2)), lack(None)], [None, None]);
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() - 3]).unwrap();
    assert_eq!(lack(Some(2)), None);
    assert!(lack(None).unwrap().contains("not closed"));
}

#[test]
fn frame_larger_than_the_memory_of_the_frames_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let mut writer = RecordingWriter::new(File::create(&path).unwrap(), "test").unwrap();
    let mut bytes = Vec::new();
    for (width, height) in [(4, 3), (641, 480), (4, 3)] {
        let camera = PinholeCamera {
            fx_px: 80.0,
            fy_px: 80.0,
            width,
            height,
            ..camera()
        };
        let mut header = FrameHeader::default();
        header.set_camera(&camera);
        let points = vec![CloudPoint::default(); camera.n_pixels()];
        encode_frame(&header, &points, &mut bytes).unwrap();
        writer.write_frame(MessageTime::at(1), &bytes).unwrap();
    }
    writer.finish().unwrap();
    let mut source = RecordingSource::open(&path, &Playback::default(), None).unwrap();
    assert!(source.prepare().unwrap().is_some());
    let refused = source.prepare().unwrap_err();
    assert!(matches!(refused, SourceError::Frame { .. }), "{refused}");
    assert!(refused.to_string().contains("points"), "{refused}");
    assert!(source.prepare().unwrap().is_some());
}

#[test]
fn recording_without_usable_frames_names_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let mut writer = RecordingWriter::new(File::create(&path).unwrap(), "test").unwrap();
    let frame_of_version_9 = 9_u32.to_le_bytes();
    let time = MessageTime::at(1);
    writer.write_frame(time, &frame_of_version_9).unwrap();
    writer.finish().unwrap();
    let refused = RecordingSource::open(&path, &Playback::default(), None);
    let sentence = refused.err().unwrap().to_string();
    assert!(sentence.contains("version 9"), "{sentence}");
}

#[test]
fn recording_without_the_wanted_frames_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let refused = |playback: &Playback| {
        let opened = RecordingSource::open(&path, playback, None);
        opened.err().unwrap().to_string()
    };
    record(&path, &[]);
    assert!(refused(&Playback::default()).contains("no frame"));
    record(&path, &[1, 2]);
    let from = Playback {
        from: Some(2),
        ..Playback::default()
    };
    assert!(refused(&from).contains("has 2 frames"));
    std::fs::write(&path, "no recording").unwrap();
    assert!(refused(&Playback::default()).contains("MCAP"));
}
