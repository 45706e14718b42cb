//! Benchmarks of comprehension with 50 objects, without and with WordNet.

use std::path::Path;

use divan::Bencher;
use referring_expression::{Lexicon, Presence, QueryWorld, Viewpoint, WordNet, WorldObject, find};

const NAMES: [&str; 10] = [
    "mug",
    "cereal-box",
    "bottle",
    "apple",
    "bowl",
    "tin-can",
    "sponge",
    "plate",
    "banana",
    "knife",
];

const QUERIES: [&str; 4] = [
    "the red mug",
    "the biggest red mug left of the box behind the bottle",
    "all fruits between the mug and the bowl",
    "the container that is not next to the plate",
];

/// Longest and most nested query.
const WORST_QUERIES: [&str; 2] = ["between the mug and ", "left of the mug "];

fn main() {
    divan::main();
}

fn objects() -> Vec<WorldObject> {
    (0..50_u8)
        .map(|number| {
            let mut color_shares = [0.0; 11];
            color_shares[usize::from(number) % 11] = 0.8;
            color_shares[3] += 0.2;
            WorldObject {
                track_id: u64::from(number),
                names: vec![(NAMES[usize::from(number) % 10].to_owned(), 0.9)],
                is_labelled: number % 2 == 0,
                color_shares,
                centre_in_world_m: [
                    f64::from(number % 7) * 0.2,
                    f64::from(number / 7) * 0.2,
                    0.75,
                ],
                orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
                size_m: [0.05 + f64::from(number) * 0.002, 0.08, 0.1],
                presence: Presence::InView,
                first_seen_ns: i64::from(number),
                last_seen_ns: 0,
            }
        })
        .collect()
}

fn run(bencher: Bencher<'_, '_>, query: &str, lexicon: Option<&dyn Lexicon>) {
    let objects = objects();
    let world = QueryWorld {
        objects: &objects,
        viewpoint: Some(Viewpoint {
            position_in_world_m: [0.0, -1.0, 1.4],
            right_in_world: [1.0, 0.0, 0.0],
            forward_in_world: [0.0, 1.0, 0.0],
        }),
        lessons: &[],
        taught_names: &[],
        now_ns: 0,
        utc_offset_s: 0,
        speaker: None,
    };
    bencher.bench_local(|| find(divan::black_box(query), &world, lexicon));
}

#[divan::bench(args = QUERIES)]
fn without_wordnet(bencher: Bencher<'_, '_>, query: &str) {
    run(bencher, query, None);
}

#[divan::bench(args = WORST_QUERIES)]
fn worst_query(bencher: Bencher<'_, '_>, part: &str) {
    let query = part.repeat(referring_expression::QUERY_CHARACTERS_MAX / part.len());
    run(bencher, &query, None);
}

/// Queries after the first one, which fills the cache. Skipped without `wordnet-base`.
#[divan::bench(args = QUERIES)]
fn with_wordnet(bencher: Bencher<'_, '_>, query: &str) {
    if let Ok(wordnet) = WordNet::open(Path::new("/usr/share/wordnet")) {
        run(bencher, query, Some(&wordnet));
    }
}

/// Opening and the first query, with an empty cache.
#[divan::bench(args = QUERIES)]
fn first_with_wordnet(bencher: Bencher<'_, '_>, query: &str) {
    let objects = objects();
    let world = QueryWorld {
        objects: &objects,
        viewpoint: None,
        lessons: &[],
        taught_names: &[],
        now_ns: 0,
        utc_offset_s: 0,
        speaker: None,
    };
    bencher.bench_local(|| {
        let wordnet = WordNet::open(Path::new("/usr/share/wordnet")).ok();
        let lexicon = wordnet.as_ref().map(|wordnet| wordnet as &dyn Lexicon);
        find(divan::black_box(query), &world, lexicon)
    });
}
