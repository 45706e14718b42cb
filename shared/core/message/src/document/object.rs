//! Document of a tracked object.

use super::rounding::rounded;
use crate::pose::is_covariance;
use crate::{ActorStamps, SceneObject, SceneTime, TrackState};
use point_cloud::ColorTerm;
use scene_document::{
    ActorStampsDocument, ColorShareDocument, CovarianceDocument, NearCategoryDocument,
    ObjectDocument,
};

/// Document of an object in a scene at a time of the monotonic clock, nanoseconds.
pub fn object(object: &SceneObject, scene: SceneTime, now_ns: u64) -> ObjectDocument {
    let seconds = |from_ns: u64, to_ns: u64| to_ns.saturating_sub(from_ns) as f64 * 1e-9;
    let [_, red, green, blue] = object.mean_argb.to_be_bytes();
    let state = TrackState::from_code(object.state).map_or("unknown", TrackState::word);
    let label = object.label().map(str::to_owned);
    let number = |value: f32| value.is_finite().then(|| rounded(value));
    ObjectDocument {
        track_id: object.track_id,
        state: if scene.is_stale(now_ns) {
            TrackState::STALE_WORD
        } else {
            state
        }
        .into(),
        scene_age_s: Some(scene.age_s(now_ns)),
        capture_stamp_ns: Some(scene.capture_ns),
        answer: object.answer(),
        label,
        distance: number(object.distance),
        probability: number(object.probability),
        position_m: object.pose.position_m,
        orientation_xyzw: object.pose.orientation_xyzw,
        size_m: object.size_m.map(rounded),
        first_seen_ns: object.first_seen_ns,
        last_seen_ns: object.last_seen_ns,
        age_s: seconds(object.first_seen_ns, scene.capture_ns),
        unseen_s: seconds(object.last_seen_ns, scene.present_ns(now_ns)),
        n_points: object.n_points,
        n_views: object.n_views,
        mean_rgb: [red, green, blue],
        colors: color_shares(object),
        cut_by_image: object.cut_by_image == 1,
        memory_sequence: object.memory_sequence,
        covariance: covariance(object),
        velocity_m_s: finite(object.velocity_m_s),
        angular_velocity_rad_s: finite(object.angular_velocity_rad_s),
        view: object.view(),
        is_key_view: object.is_key_view == 1,
        n_key_views: object.n_key_views,
        n_sides: object.n_sides,
        categories: near_categories(object.categories()),
        linked_to: object.linked_to(),
        stamps: stamps(&object.stamps),
    }
}

/// Documents of near categories: name, distance and probability of each.
pub fn near_categories<'a>(
    categories: impl Iterator<Item = (&'a str, f32, f32)>,
) -> Vec<NearCategoryDocument> {
    let document = |(label, distance, probability): (&str, f32, f32)| NearCategoryDocument {
        label: label.to_owned(),
        distance: rounded(distance),
        probability: rounded(probability),
    };
    categories.map(document).collect()
}

fn stamps(stamps: &ActorStamps) -> ActorStampsDocument {
    let stamp = |ns: u64| (ns != 0).then_some(ns);
    ActorStampsDocument {
        asked_ns: stamp(stamps.asked_ns),
        begun_ns: stamp(stamps.begun_ns),
        described_ns: stamp(stamps.described_ns),
        recognised_ns: stamp(stamps.recognised_ns),
        answered_ns: stamp(stamps.answered_ns),
    }
}

fn covariance(object: &SceneObject) -> Option<CovarianceDocument> {
    let given = [
        &object.position_covariance_m2,
        &object.rotation_covariance_rad2,
    ];
    let [position_m2, rotation_rad2] = given.map(|six| six.map(f64::from));
    given
        .into_iter()
        .all(is_covariance)
        .then_some(CovarianceDocument {
            position_m2,
            rotation_rad2,
        })
}

/// Colour terms of an object with a share, greatest first.
fn color_shares(object: &SceneObject) -> Vec<ColorShareDocument> {
    let shares = ColorTerm::ALL.into_iter().zip(object.color_percents);
    let mut shares: Vec<_> = shares.filter(|(_, percent)| *percent > 0).collect();
    shares.sort_by_key(|(_, percent)| std::cmp::Reverse(*percent));
    let share = |(term, percent): (ColorTerm, u8)| ColorShareDocument {
        color: term.word().to_owned(),
        share: f64::from(percent) / 100.0,
    };
    shares.into_iter().map(share).collect()
}

/// Rounded vector; `None` when a component is not finite.
fn finite(values: [f32; 3]) -> Option<[f64; 3]> {
    let are_finite = values.iter().all(|value| value.is_finite());
    are_finite.then(|| values.map(rounded))
}
