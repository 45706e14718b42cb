//! Generated queries: phrases that are true of certain objects of a scene by a clear margin.

use super::TrueQuery;
use super::query_scene::{QueryScene, TrueObject};
use nalgebra::Vector3;
use point_cloud::ColorTerm;
use random::Random;

/// Least share of a colour on an object that is called by it.
const COLOR_SHARE_MIN: f64 = 0.7;
/// Greatest share of that colour on the objects that are not meant.
const OTHER_SHARE_MAX: f64 = 0.1;
/// Least ratio of the heights of the tallest and the next object.
const HEIGHT_RATIO_MIN: f64 = 1.25;
/// Least lead of the outermost object over the next, metres.
const LEAD_MIN_M: f64 = 0.05;
/// Least ratio of the offset along a direction to the one across it.
const DIRECTION_RATIO_MIN: f64 = 1.5;
/// Fruit among the categories of the scenes.
const FRUIT: [&str; 4] = ["banana", "apple", "lemon", "orange"];
/// Categories that a scene is asked about in vain.
const ABSENT: [&str; 6] = ["mug", "banana", "hammer", "teapot", "stapler", "candle"];

/// Colours that a scene is asked about in vain, with those that border on them.
const ABSENT_COLORS: [(ColorTerm, &[ColorTerm]); 3] = [
    (
        ColorTerm::Red,
        &[
            ColorTerm::Pink,
            ColorTerm::Orange,
            ColorTerm::Brown,
            ColorTerm::Purple,
        ],
    ),
    (ColorTerm::Green, &[ColorTerm::Yellow, ColorTerm::Blue]),
    (
        ColorTerm::Blue,
        &[
            ColorTerm::Purple,
            ColorTerm::Green,
            ColorTerm::Grey,
            ColorTerm::White,
        ],
    ),
];

/// Queries about a scene, of as many kinds as it allows.
pub(super) fn queries(scene: &QueryScene, n_queries: usize) -> Vec<TrueQuery> {
    let mut random = Random::substream(
        scene.objects.len() as u64,
        u64::from(scene.taught_yesterday),
    );
    let mut kinds: Vec<Vec<TrueQuery>> = vec![
        names(scene),
        colored_names(scene),
        colors(scene),
        tallest(scene),
        relations(scene),
        outermost(scene),
        all_of_a_category(scene),
        absent(scene),
        lessons(scene),
        kinds_of_things(scene),
    ];
    for queries in &mut kinds {
        random.shuffle(queries);
    }
    let n_most = kinds.iter().map(Vec::len).max().unwrap_or(0);
    let in_turn = (0..n_most).flat_map(|round| {
        let of_round = kinds.iter().filter_map(move |queries| queries.get(round));
        of_round.cloned().collect::<Vec<_>>()
    });
    in_turn.take(n_queries).collect()
}

/// Query for the objects of a scene that fulfil a condition; `None` when one of them is not
/// tracked, which is no matter of words.
fn query(
    scene: &QueryScene,
    words: String,
    is_meant: impl Fn(&TrueObject) -> bool,
) -> Option<TrueQuery> {
    let meant = scene.objects.iter().filter(|object| is_meant(object));
    let meant: Vec<&TrueObject> = meant.collect();
    meant
        .iter()
        .all(|object| object.track_id.is_some())
        .then(|| TrueQuery {
            words,
            objects: meant.iter().map(|object| object.id).collect(),
        })
}

fn query_for(scene: &QueryScene, words: String, id: u16) -> Option<TrueQuery> {
    query(scene, words, |object| object.id == id)
}

fn of_category<'a>(
    scene: &'a QueryScene,
    category: &'a str,
) -> impl Iterator<Item = &'a TrueObject> + Clone {
    let objects = scene.objects.iter();
    objects.filter(move |object| object.category == category)
}

fn is_unique(scene: &QueryScene, object: &TrueObject) -> bool {
    of_category(scene, &object.category).count() == 1
}

fn names(scene: &QueryScene) -> Vec<TrueQuery> {
    let unique = scene
        .objects
        .iter()
        .filter(|object| is_unique(scene, object));
    unique
        .filter_map(|object| query_for(scene, format!("the {}", object.spoken()), object.id))
        .collect()
}

/// True if a colour term tells an object from the others.
fn is_distinct(
    object: &TrueObject,
    term: ColorTerm,
    mut others: impl Iterator<Item = f64>,
) -> bool {
    object.share(term) >= COLOR_SHARE_MIN && others.all(|share| share <= OTHER_SHARE_MAX)
}

fn colored_names(scene: &QueryScene) -> Vec<TrueQuery> {
    let repeated = scene
        .objects
        .iter()
        .filter(|object| !is_unique(scene, object));
    let colored = repeated.flat_map(|object| {
        ColorTerm::ALL.into_iter().filter_map(move |term| {
            let others = of_category(scene, &object.category);
            let others = others.filter(|other| other.id != object.id);
            let shares = others.map(|other| other.share(term));
            let words = format!("the {} {}", term.word(), object.spoken());
            is_distinct(object, term, shares).then(|| query_for(scene, words, object.id))?
        })
    });
    colored.collect()
}

fn colors(scene: &QueryScene) -> Vec<TrueQuery> {
    let colored = scene.objects.iter().flat_map(|object| {
        ColorTerm::ALL.into_iter().filter_map(move |term| {
            let others = scene.objects.iter().filter(|other| other.id != object.id);
            let shares = others.map(|other| other.share(term));
            let words = format!("find the {} object", term.word());
            is_distinct(object, term, shares).then(|| query_for(scene, words, object.id))?
        })
    });
    colored.collect()
}

fn tallest(scene: &QueryScene) -> Vec<TrueQuery> {
    let tallest = scene.objects.iter().filter(|object| {
        let others = of_category(scene, &object.category).filter(|other| other.id != object.id);
        let mut others = others.peekable();
        others.peek().is_some()
            && others.all(|other| object.size_m.z > HEIGHT_RATIO_MIN * other.size_m.z)
    });
    tallest
        .filter_map(|object| {
            query_for(scene, format!("the tallest {}", object.spoken()), object.id)
        })
        .collect()
}

/// Direction of a relation, with its words.
fn directions(scene: &QueryScene) -> [(&'static str, Vector3<f64>); 4] {
    let right = Vector3::from(scene.viewpoint.right_in_world);
    let forward = Vector3::from(scene.viewpoint.forward_in_world);
    [
        ("left of", -right),
        ("to the right of", right),
        ("behind", forward),
        ("in front of", -forward),
    ]
}

fn relations(scene: &QueryScene) -> Vec<TrueQuery> {
    let landmarks = scene
        .objects
        .iter()
        .filter(|object| is_unique(scene, object));
    let pairs = landmarks.flat_map(|landmark| {
        let targets = scene
            .objects
            .iter()
            .filter(move |object| object.id != landmark.id);
        targets.map(move |target| (target, landmark))
    });
    pairs
        .flat_map(|(target, landmark)| {
            directions(scene)
                .into_iter()
                .filter_map(move |(words, direction)| {
                    let is_there = is_clearly_there(target, landmark, &direction);
                    let mut others = of_category(scene, &target.category)
                        .filter(|other| other.id != target.id && other.id != landmark.id);
                    let only =
                        others.all(|other| is_clearly_not_there(other, landmark, &direction));
                    let words =
                        format!("the {} {words} the {}", target.spoken(), landmark.spoken());
                    (is_there && only).then(|| query_for(scene, words, target.id))?
                })
        })
        .collect()
}

fn is_clearly_there(target: &TrueObject, landmark: &TrueObject, direction: &Vector3<f64>) -> bool {
    let offset = target.centre_in_world_m - landmark.centre_in_world_m;
    let along = offset.dot(direction);
    let across = (Vector3::new(offset.x, offset.y, 0.0) - along * direction).norm();
    let extents = 0.5 * (target.size_m.xy().max() + landmark.size_m.xy().max());
    along > extents && along > DIRECTION_RATIO_MIN * across
}

fn is_clearly_not_there(
    other: &TrueObject,
    landmark: &TrueObject,
    direction: &Vector3<f64>,
) -> bool {
    let offset = other.centre_in_world_m - landmark.centre_in_world_m;
    offset.dot(direction) < -0.02
}

fn outermost(scene: &QueryScene) -> Vec<TrueQuery> {
    let words = [
        "the leftmost thing",
        "the rightmost thing",
        "the farthest object",
        "the nearest object",
    ];
    let camera = Vector3::from(scene.viewpoint.position_in_world_m);
    let measure = |object: &TrueObject, direction: usize| match direction {
        2 => (object.centre_in_world_m - camera).norm(),
        3 => -(object.centre_in_world_m - camera).norm(),
        _ => object
            .centre_in_world_m
            .dot(&directions(scene)[direction].1),
    };
    let outermost = words
        .into_iter()
        .enumerate()
        .filter_map(|(direction, words)| {
            let value = |object: &TrueObject| measure(object, direction);
            let mut sorted: Vec<&TrueObject> = scene.objects.iter().collect();
            sorted.sort_by(|a, b| value(b).total_cmp(&value(a)));
            let (first, second) = (sorted.first()?, sorted.get(1)?);
            let is_clear = value(first) - value(second) > LEAD_MIN_M;
            is_clear.then(|| query_for(scene, words.to_owned(), first.id))?
        });
    outermost.collect()
}

fn all_of_a_category(scene: &QueryScene) -> Vec<TrueQuery> {
    let firsts = scene.objects.iter().filter(|object| {
        let mut of_category = of_category(scene, &object.category);
        of_category
            .next()
            .is_some_and(|first| first.id == object.id)
            && !is_unique(scene, object)
    });
    firsts
        .filter_map(|object| {
            let words = format!("all {}", plural(&object.spoken()));
            query(scene, words, |other| other.category == object.category)
        })
        .collect()
}

fn plural(name: &str) -> String {
    if name.ends_with('x') || name.ends_with('s') {
        format!("{name}es")
    } else {
        format!("{name}s")
    }
}

fn absent(scene: &QueryScene) -> Vec<TrueQuery> {
    let absent = ABSENT
        .iter()
        .filter(|name| of_category(scene, name).next().is_none());
    let names = absent.map(|name| format!("where is the {name}?"));
    let colored = scene.objects.iter().flat_map(|object| {
        let of_category = of_category(scene, &object.category);
        let is_absent = move |&(term, near): &(ColorTerm, &[ColorTerm])| {
            of_category.clone().all(|other| {
                let near: f64 = near.iter().map(|&near| other.share(near)).sum();
                let clear: f64 = other.color_shares.iter().sum();
                other.share(term) + near < 0.01 && clear >= COLOR_SHARE_MIN
            })
        };
        let words = move |term: ColorTerm| format!("the {} {}", term.word(), object.spoken());
        let terms = ABSENT_COLORS.into_iter().filter(is_absent);
        terms.map(move |(term, _)| words(term))
    });
    let none = |words| TrueQuery {
        words,
        objects: Vec::new(),
    };
    names.chain(colored).map(none).collect()
}

fn lessons(scene: &QueryScene) -> Vec<TrueQuery> {
    let words = [
        "the one I showed you yesterday",
        "the thing anna taught you yesterday",
    ];
    words
        .into_iter()
        .filter_map(|words| query_for(scene, words.to_owned(), scene.taught_yesterday))
        .filter(|query| !query.objects.is_empty())
        .collect()
}

/// Queries by words that are more general than the taught names.
fn kinds_of_things(scene: &QueryScene) -> Vec<TrueQuery> {
    let is_fruit = |object: &TrueObject| FRUIT.contains(&object.category.as_str());
    let n_fruits = scene.objects.iter().filter(|object| is_fruit(object));
    let words = match n_fruits.count() {
        0 => return Vec::new(),
        1 => "the fruit",
        _ => "all fruits",
    };
    query(scene, words.to_owned(), is_fruit)
        .into_iter()
        .collect()
}
