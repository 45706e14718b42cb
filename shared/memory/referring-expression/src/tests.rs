//! Tests of comprehension in a world made by hand.

mod empty_answers;
mod extremes;
mod negated_nouns;
mod pantry;
mod phrases;
mod robustness;

use crate::{Answer, Lesson, Presence, QueryWorld, Viewpoint, WorldObject, find};

const SECOND: i64 = 1_000_000_000;
const HOUR: i64 = 3600 * SECOND;

/// Wednesday, 15 November 2023, 10:00 UTC.
const NOW: i64 = 1_700_042_400 * SECOND;

/// Objects on a table, seen from the south: x to the right, y away from the viewer.
struct Tabletop {
    objects: Vec<WorldObject>,
    lessons: Vec<Lesson>,
    taught_names: Vec<String>,
}

/// Object that stands on the table, of one colour.
fn object(
    track_id: u64,
    name: &str,
    color: usize,
    place_m: [f64; 2],
    size_m: [f64; 3],
) -> WorldObject {
    let mut color_shares = [0.0; 11];
    color_shares[color] = 1.0;
    let id = i64::try_from(track_id).unwrap();
    WorldObject {
        track_id,
        names: vec![(name.to_owned(), 1.0)],
        is_labelled: true,
        color_shares,
        centre_in_world_m: [place_m[0], place_m[1], 0.7 + 0.5 * size_m[2]],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        size_m,
        presence: Presence::InView,
        first_seen_ns: NOW - HOUR + id * SECOND,
        last_seen_ns: NOW,
    }
}

const WHITE: usize = 1;
const RED: usize = 3;
const GREEN: usize = 4;
const YELLOW: usize = 5;
const BLUE: usize = 6;
const BROWN: usize = 7;
const ORANGE: usize = 8;

impl Tabletop {
    /// ```text
    /// back    5 bottle         6 cereal-box  9 tin-can
    /// middle  1 red mug   3 box (10 apple on it)   2 blue mug
    /// front   7 unknown   8 bowl (11 orange in it)         4 small mug
    /// ```
    fn new() -> Self {
        let cup = [0.08, 0.08, 0.1];
        let mut objects = vec![
            object(1, "mug", RED, [-0.3, 0.5], cup),
            object(2, "mug", BLUE, [0.3, 0.5], cup),
            object(3, "box", BROWN, [0.0, 0.5], [0.2, 0.15, 0.1]),
            object(4, "mug", WHITE, [0.5, 0.2], [0.06, 0.06, 0.07]),
            object(5, "bottle", GREEN, [-0.3, 0.9], [0.07, 0.07, 0.25]),
            object(6, "cereal-box", YELLOW, [0.3, 0.9], [0.2, 0.07, 0.3]),
            object(7, "sponge", YELLOW, [-0.5, 0.2], [0.1, 0.06, 0.03]),
            object(8, "bowl", WHITE, [-0.05, 0.2], [0.16, 0.16, 0.08]),
            object(9, "tin-can", RED, [0.5, 0.9], [0.08, 0.08, 0.11]),
            object(10, "apple", RED, [0.0, 0.5], [0.07, 0.07, 0.07]),
            object(11, "orange", ORANGE, [-0.05, 0.2], [0.07, 0.07, 0.07]),
        ];
        objects[6].is_labelled = false;
        objects[6].names = vec![("sponge".to_owned(), 0.61), ("mug".to_owned(), 0.2)];
        objects[8].color_shares[RED] = 0.38;
        objects[8].color_shares[WHITE] = 0.62;
        objects[8].presence = Presence::OutOfView;
        objects[8].last_seen_ns = NOW - 35 * SECOND;
        objects[9].centre_in_world_m[2] = 0.835;
        objects[10].centre_in_world_m[2] = 0.75;
        let lesson = |track_id, category: &str, author: &str, age_ns: i64| Lesson {
            track_id,
            category: category.to_owned(),
            author: author.to_owned(),
            wall_ns: NOW - age_ns,
        };
        Self {
            objects,
            lessons: vec![
                lesson(Some(1), "mug", "Anna", 20 * HOUR),
                lesson(Some(5), "bottle", "Ben", 2 * HOUR),
                lesson(Some(8), "bowl", "Anna", 3 * HOUR),
                lesson(Some(99), "cereal-box", "Ben", 50 * HOUR),
                lesson(Some(3), "box", "Ben", 120 * SECOND),
            ],
            taught_names: ["fork", "mug", "pop-tarts"].map(str::to_owned).to_vec(),
        }
    }

    fn world(&self) -> QueryWorld<'_> {
        QueryWorld {
            objects: &self.objects,
            viewpoint: Some(Viewpoint {
                position_in_world_m: [0.0, -0.5, 1.3],
                right_in_world: [1.0, 0.0, 0.0],
                forward_in_world: [0.0, 1.0, -0.4],
            }),
            lessons: &self.lessons,
            taught_names: &self.taught_names,
            now_ns: NOW,
            utc_offset_s: 0,
            speaker: Some("Ben"),
        }
    }
}

fn ask(query: &str) -> Answer {
    find(query, &Tabletop::new().world(), None).unwrap()
}

fn ids(answer: &Answer) -> Vec<u64> {
    let mut ids: Vec<u64> = answer.matches.iter().map(|found| found.track_id).collect();
    ids.sort_unstable();
    ids
}

fn doubts(answer: &Answer) -> String {
    let doubts = answer.matches.iter().flat_map(|found| found.doubts.clone());
    doubts.collect::<Vec<_>>().join("; ")
}
