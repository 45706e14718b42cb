use super::*;
use proptest::prelude::*;

const PERIOD: u32 = CLOCK_HZ / 30;

/// Pairing of numbers instead of frames, with the real number of buffers.
fn pairing() -> Pairing<usize, usize> {
    Pairing::new((1..N_FRAMES).collect(), (1..N_FRAMES).collect())
}

fn stamped(stamp_ticks: u32) -> StampedFrame<usize> {
    StampedFrame {
        stamp_ticks,
        arrived: Instant::now(),
        frame: 0,
    }
}

/// Feeds frames `(stream, stamp)` in order and checks the resulting pairs.
fn check_pairs(
    arrivals: &[(char, u32)],
    expected_pairs: &[(u32, u32)],
    expected_alone: (u64, u64),
) {
    let mut pairing = pairing();
    let mut pairs = Vec::new();
    for &(stream, stamp) in arrivals {
        match stream {
            'd' => pairing.depth_arrived(stamped(stamp)),
            _ => pairing.video_arrived(stamped(stamp)),
        }
        if let Some(pair) = pairing.take_ready() {
            pairs.push((pair.depth.stamp_ticks, pair.video.stamp_ticks));
            pairing.recycle(pair);
        }
    }
    assert_eq!(pairs, expected_pairs);
    let counts = pairing.statistics();
    assert_eq!(
        (counts.n_unpaired_depth, counts.n_unpaired_video),
        expected_alone
    );
    assert_eq!(counts.n_pairs, expected_pairs.len() as u64);
}

#[test]
fn frames_of_a_moment_pair_in_either_order() {
    check_pairs(&[('d', 100), ('v', 600_100)], &[(100, 600_100)], (0, 0));
    check_pairs(&[('v', 600_100), ('d', 100)], &[(100, 600_100)], (0, 0));
}

#[test]
fn half_a_period_is_too_far() {
    check_pairs(&[('d', 0), ('v', 1_000_000)], &[], (0, 0));
    check_pairs(&[('d', 0), ('v', 999_999)], &[(0, 999_999)], (0, 0));
    check_pairs(&[('v', 0), ('d', 999_999)], &[(999_999, 0)], (0, 0));
}

#[test]
fn a_lost_colour_frame_leaves_one_depth_frame_alone() {
    let (t0, t1) = (10, 10 + PERIOD);
    check_pairs(
        &[('d', t0), ('d', t1), ('v', t1 + 9)],
        &[(t1, t1 + 9)],
        (1, 0),
    );
}

#[test]
fn a_stream_may_lag_by_more_than_a_period() {
    let (t0, t1) = (10, 10 + PERIOD);
    check_pairs(
        &[('d', t0), ('d', t1), ('v', t0), ('v', t1)],
        &[(t0, t0), (t1, t1)],
        (0, 0),
    );
}

#[test]
fn the_wrap_of_the_counter_is_no_gap() {
    check_pairs(
        &[('d', u32::MAX - 5), ('v', 7)],
        &[(u32::MAX - 5, 7)],
        (0, 0),
    );
}

#[test]
fn after_a_jump_of_the_clock_pairs_return() {
    let late = 1_000_000_000;
    let arrivals = [
        ('d', late),
        ('d', late + PERIOD),
        ('d', 0),
        ('v', 0),
        ('d', PERIOD),
        ('v', PERIOD),
    ];
    check_pairs(&arrivals, &[(0, 0), (PERIOD, PERIOD)], (2, 0));
}

#[test]
fn a_pair_not_taken_is_superseded_by_the_next() {
    let mut pairing = pairing();
    for stamp in [0, PERIOD, 2 * PERIOD] {
        pairing.depth_arrived(stamped(stamp));
        pairing.video_arrived(stamped(stamp));
    }
    assert_eq!(pairing.take_ready().unwrap().depth.stamp_ticks, 2 * PERIOD);
    assert!(pairing.take_ready().is_none());
    assert_eq!(pairing.statistics().n_superseded, 2);
}

proptest! {
    /// Buffer conservation: for any arrivals there is always a free buffer, none is handed out
    /// twice, and every frame is counted.
    #[test]
    fn frames_are_neither_lost_nor_doubled(
        arrivals in prop::collection::vec((any::<bool>(), 0u32..20, any::<bool>()), 0..200)
    ) {
        let mut pairing = pairing();
        let (mut depth_filling, mut video_filling) = (0, 0);
        let mut held: Option<Pair<usize, usize>> = None;
        let mut n_arrived = 0;
        for (is_depth, half_periods, look) in arrivals {
            let stamp_ticks = half_periods * (PERIOD / 2);
            let arrived = Instant::now();
            n_arrived += 1;
            if is_depth {
                let next = pairing.spare_depth().expect("a depth frame is free");
                let frame = std::mem::replace(&mut depth_filling, next);
                pairing.depth_arrived(StampedFrame { stamp_ticks, arrived, frame });
            } else {
                let next = pairing.spare_video().expect("a colour frame is free");
                let frame = std::mem::replace(&mut video_filling, next);
                pairing.video_arrived(StampedFrame { stamp_ticks, arrived, frame });
            }
            if look && let Some(pair) = pairing.take_ready()
                && let Some(old) = held.replace(pair)
            {
                pairing.recycle(old);
            }
        }
        let counts = pairing.statistics();
        let waiting = pairing.depth.frames.len() + pairing.video.frames.len();
        prop_assert_eq!(
            n_arrived,
            2 * counts.n_pairs + counts.n_unpaired_depth + counts.n_unpaired_video + waiting as u64
        );
        let mut depth_frames = vec![depth_filling];
        depth_frames.extend(&pairing.depth.spare);
        depth_frames.extend(pairing.depth.frames.iter().map(|frame| frame.frame));
        depth_frames.extend(pairing.ready.iter().map(|pair| pair.depth.frame));
        depth_frames.extend(held.iter().map(|pair| pair.depth.frame));
        depth_frames.sort_unstable();
        prop_assert_eq!(depth_frames, (0..N_FRAMES).collect::<Vec<_>>());
    }
}
