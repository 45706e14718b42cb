use super::*;
use proptest::prelude::*;

/// Views on a line; the score is their distance.
struct Places(Vec<f32>);

impl ViewComparison for Places {
    fn queries(&self, view: ViewId) -> Vec<Vec<f32>> {
        vec![vec![self.0[view.view_id as usize]]]
    }

    fn bounded_score(&self, queries: &[Vec<f32>], view: ViewId, bound: f32) -> Option<f32> {
        let score = (queries[0][0] - self.0[view.view_id as usize]).abs();
        (score <= bound).then_some(score)
    }

    fn distance(&self, score: f32) -> f32 {
        score
    }
}

fn id(view_id: u32) -> ViewId {
    ViewId {
        track_id: 1,
        view_id,
    }
}

/// Member whose hash is not in the order of its id.
fn member(view_id: u32) -> Member {
    Member {
        hash: random::mix64(view_id.into()),
        id: id(view_id),
    }
}

/// Mean distance of the views to their nearest neighbours.
fn mean(places: &[f32], views: &[u32]) -> f64 {
    let distance = |a: u32, b: u32| (places[a as usize] - places[b as usize]).abs();
    let nearest = |view: &u32| {
        let others = views.iter().filter(|other| *other != view);
        others.map(|other| distance(*view, *other)).reduce(f32::min)
    };
    let distances: Vec<f64> = views.iter().filter_map(nearest).map(f64::from).collect();
    distances.iter().sum::<f64>() / distances.len() as f64
}

proptest! {
    #[test]
    fn distances_after_any_changes_are_those_of_the_remaining_views(
        places in prop::collection::vec(0.0_f32..9.0, 12),
        steps in prop::collection::vec(prop::collection::btree_set(0_u32..12, 0..6), 0..8),
    ) {
        let places = Places(places);
        let mut spread = IntraCategoryDistances::default();
        let mut views = BTreeSet::new();
        for toggled in steps {
            let (gone, new): (Vec<u32>, Vec<u32>) = toggled.iter().partition(|v| views.contains(*v));
            let removed = gone.iter().map(|view| id(*view)).collect();
            let added: Vec<Member> = new.iter().map(|view| member(*view)).collect();
            spread.update(&removed, &added, &places);
            views = views.symmetric_difference(&toggled).copied().collect();
        }
        let found = spread.distances();
        let views: Vec<u32> = views.into_iter().collect();
        if views.len() < 2 {
            prop_assert_eq!(found, DistanceSum::default());
        } else {
            prop_assert_eq!(found.n, views.len());
            let expected = mean(&places.0, &views) * views.len() as f64;
            prop_assert!((found.sum - expected).abs() < 1e-6);
        }
    }
}

#[test]
fn a_large_category_is_estimated_and_its_history_does_not_matter() {
    let n = 10 * N_SAMPLED as u32;
    let mut random = random::Random::from_seed(3);
    let places = Places((0..2 * n).map(|_| random.unit_f32()).collect());
    let all: Vec<Member> = (0..n).map(member).collect();
    let mut at_once = IntraCategoryDistances::default();
    at_once.update(&BTreeSet::new(), &all, &places);

    // One after another, mixed with as many views that are removed again.
    let mut by_steps = IntraCategoryDistances::default();
    for view in 0..n {
        let passing = member(n + view);
        by_steps.update(&BTreeSet::new(), &[passing, member(view)], &places);
        if view % 7 != 0 {
            by_steps.update(&BTreeSet::from([passing.id]), &[], &places);
        }
    }
    let passing = (0..n).step_by(7).map(|view| id(n + view)).collect();
    by_steps.update(&passing, &[], &places);
    assert_eq!(at_once.distances(), by_steps.distances());

    let DistanceSum { sum, n: n_found } = at_once.distances();
    assert_eq!(n_found, n as usize);
    let views: Vec<u32> = (0..n).collect();
    let expected = mean(&places.0, &views);
    let relative = sum / f64::from(n) / expected;
    // Exponential distances: a standard deviation of their mean, so 6 % for the sample.
    assert!((relative - 1.0).abs() < 0.2, "{relative}");
}
