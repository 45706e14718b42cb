//! Loop closure: all pairs of views that see the same side agree with each other.

use crate::pose_graph::{Edge, Node, optimise};
use crate::view::BuiltView;
use nalgebra::Isometry3;
use registration::{Prior, refine};
use std::sync::atomic::{AtomicBool, Ordering};

/// Greatest angle between the viewing directions of a pair, 50°. Chosen: beyond it too little of
/// the surface is common.
const PAIR_COSINE_MIN: f64 = 0.643;

/// Number of views that a view is paired with, at most. Chosen.
const N_PAIRS_MAX: usize = 6;

/// Number of rounds of pairing and optimising. Chosen: the second one starts close.
const N_ROUNDS: usize = 2;

/// Contradiction from which a pair of views does not count. Chosen.
const CONTRADICTION_MAX: f64 = 1.2;

/// Number of views since which an earlier view counts as the other end of a loop, and the cosine
/// of the angle within which the ends meet, 25°.
const N_LOOP_MIN: usize = 6;
const MEETING_COSINE: f64 = 0.906;

/// Cosine of the angle that a view of the loop must be away from its ends, 100°.
const AWAY_COSINE: f64 = -0.17;

/// `true` if the last view sees the same side as an early one, and views between them saw the
/// other side.
pub(crate) fn is_orbit_closed(views: &[BuiltView]) -> bool {
    let Some((last, earlier)) = views.split_last() else {
        return false;
    };
    let direction = last.direction();
    let n = earlier.len().saturating_sub(N_LOOP_MIN);
    let meets = |view: &BuiltView| view.direction().dot(&direction) > MEETING_COSINE;
    let is_away = |view: &BuiltView| view.direction().dot(&direction) < AWAY_COSINE;
    let Some(start) = earlier[..n].iter().position(meets) else {
        return false;
    };
    earlier[start..].iter().any(is_away)
}

/// Brings the poses of all views into agreement, by the registrations of pairs of them and by the
/// reported poses; `false` if it was stopped, which leaves them as they are.
pub(crate) fn close_loop(views: &mut [BuiltView], stop: &AtomicBool) -> bool {
    let mut poses: Vec<Isometry3<f64>> = views.iter().map(|v| v.object_from_camera).collect();
    for _ in 0..N_ROUNDS {
        let mut edges = Vec::new();
        for (target, source) in pairs(views) {
            if stop.load(Ordering::Relaxed) {
                return false;
            }
            edges.extend(edge((views, &poses), target, source));
        }
        let mut nodes: Vec<Node> = views
            .iter()
            .zip(&poses)
            .map(|(view, pose)| Node {
                object_from_camera: *pose,
                reported: view.reported,
                sigma: view.sigma,
            })
            .collect();
        optimise(&mut nodes, &edges);
        poses = nodes.iter().map(|node| node.object_from_camera).collect();
    }
    for (view, pose) in views.iter_mut().zip(poses) {
        view.object_from_camera = pose;
    }
    true
}

/// Pairs of views, each with those nearest in viewing direction.
fn pairs(views: &[BuiltView]) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for (source, view) in views.iter().enumerate() {
        let direction = view.direction();
        let mut near: Vec<(usize, f64)> = views[..source]
            .iter()
            .map(|other| other.direction().dot(&direction))
            .enumerate()
            .filter(|(_, cosine)| *cosine > PAIR_COSINE_MIN)
            .collect();
        near.sort_by(|a, b| b.1.total_cmp(&a.1));
        // Half of them the nearest ones, half of them evenly farther ones.
        let step = near.len().div_ceil(N_PAIRS_MAX).max(1);
        pairs.extend(
            near.iter()
                .step_by(step)
                .map(|(target, _)| (*target, source)),
        );
    }
    pairs
}

/// Registration of two views in their present poses; `None` where they do not fit.
fn edge(
    (views, poses): (&[BuiltView], &[Isometry3<f64>]),
    target: usize,
    source: usize,
) -> Option<Edge> {
    let prior = Prior {
        target_from_source: poses[target].inverse() * poses[source],
        translation_sigma_m: 0.01,
        rotation_sigma_rad: 0.05,
    };
    let surface = |index: usize| &views[index].depth.surface;
    let alignment = refine(surface(target), surface(source), &prior).ok()?;
    (alignment.contradiction < CONTRADICTION_MAX).then_some(Edge {
        target,
        source,
        alignment,
    })
}
