//! Grasp plan: candidates with scores and reasons, and the rejected ones with theirs.

use crate::contact_point::ContactEvidence;
use crate::grasp_scene::GraspScene;
use crate::reach::GraspJoints;
use crate::rejection::Rejection;
use geometry::RigidTransform;
use nalgebra::Vector3;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Vertical part of the approach from which on a grasp is from above, and below which it is from
/// the side: sines of 60° and 30°.
const ABOVE: f64 = 0.866;
const SIDE: f64 = 0.5;

/// Direction of an approach.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ApproachKind {
    /// Down, within 30°.
    Above,
    /// Between both.
    Slanted,
    /// Level, within 30°.
    Side,
}

impl ApproachKind {
    /// Kind of a unit direction of approach, z against gravity.
    pub fn of(approach: &Vector3<f64>) -> Self {
        match -approach.z {
            down if down >= ABOVE => Self::Above,
            down if down >= SIDE => Self::Slanted,
            _ => Self::Side,
        }
    }

    /// Kind in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Above => "from above",
            Self::Slanted => "slanted",
            Self::Side => "from the side",
        }
    }
}

/// Grasp of an object: pose of the tool, openings and what speaks for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Grasp {
    /// Pose of the tool when the fingers close.
    pub plan_from_tool: RigidTransform,
    /// Opening before the grasp, metres.
    pub opening_m: f64,
    /// Distance between the pads when they touch, metres.
    pub width_m: f64,
    /// Length of the straight approach along z of the tool, metres.
    pub approach_m: f64,
    /// Length of the straight way up, metres.
    pub lift_m: f64,
    /// Score, 0 to 1: the product of the factors.
    pub score: f64,
    /// Factors of the score.
    pub factors: ScoreFactors,
    /// Weaker evidence of both contacts.
    pub evidence: ContactEvidence,
    /// Joint angles; `None` when no arm was given.
    pub joints: Option<GraspJoints>,
}

impl Grasp {
    /// Direction of approach.
    pub fn kind(&self) -> ApproachKind {
        ApproachKind::of(&(self.plan_from_tool.rotation * Vector3::z()))
    }
}

/// Factors of a grasp's score, each 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScoreFactors {
    /// Distance of the pads' normals from the edge of the friction cone.
    pub friction: f64,
    /// Touching share of the pads.
    pub contact: f64,
    /// Distance of the contact from the middle of the pads.
    pub centring: f64,
    /// Distance of the estimated centre of mass from the line between the pads.
    pub balance: f64,
    /// Evidence for the contacts.
    pub evidence: f64,
    /// Room between the open fingers and the object.
    pub room: f64,
    /// Space that was seen on the hand's way.
    pub seen_way: f64,
}

impl ScoreFactors {
    /// Product of the factors.
    pub fn product(&self) -> f64 {
        self.friction
            * self.contact
            * self.centring
            * self.balance
            * self.evidence
            * self.room
            * self.seen_way
    }

    /// Factors by name, the worst first.
    pub fn by_name(&self) -> [(&'static str, f64); 7] {
        let mut factors = [
            ("friction", self.friction),
            ("contact", self.contact),
            ("centring", self.centring),
            ("balance", self.balance),
            ("evidence", self.evidence),
            ("room", self.room),
            ("seen way", self.seen_way),
        ];
        factors.sort_by(|a, b| a.1.total_cmp(&b.1));
        factors
    }
}

/// Rejected grasp with its reason.
#[derive(Debug, Clone, PartialEq)]
pub struct RejectedGrasp {
    /// Pose of the tool.
    pub plan_from_tool: RigidTransform,
    /// Reason.
    pub reason: Rejection,
}

/// Plan of the grasps of an object.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GraspPlan {
    /// Grasps, best first.
    pub grasps: Vec<Grasp>,
    /// Rejected grasps, in the order in which they were tried.
    pub rejected: Vec<RejectedGrasp>,
}

impl GraspPlan {
    /// Reasons of the rejected grasps in words with their numbers: first of those that came farthest,
    /// and of these the most frequent.
    pub fn reasons(&self, scene: &GraspScene<'_>) -> Vec<(String, usize)> {
        let mut counts = BTreeMap::<(Reverse<u8>, String), usize>::new();
        for rejected in &self.rejected {
            let key = (
                Reverse(rejected.reason.stage()),
                rejected.reason.words(scene),
            );
            *counts.entry(key).or_default() += 1;
        }
        let mut reasons: Vec<_> = counts.into_iter().collect();
        reasons.sort_by(|a, b| a.0.0.cmp(&b.0.0).then(b.1.cmp(&a.1)));
        reasons
            .into_iter()
            .map(|((_, words), n)| (words, n))
            .collect()
    }

    /// Sentence that says why there is no grasp; `None` when there is one.
    pub fn why_none(&self, scene: &GraspScene<'_>, track: u64) -> Option<String> {
        if !self.grasps.is_empty() {
            return None;
        }
        let reasons = self.reasons(scene);
        if reasons.is_empty() {
            return Some(format!(
                "no grasp of track {track} was found: no two opposite sides of it are seen or \
                 can be estimated; look at it from another side"
            ));
        }
        let words = |(words, n): &(String, usize)| format!("{n} × {words}");
        let told: Vec<String> = reasons.iter().take(4).map(words).collect();
        Some(format!(
            "no grasp of track {track} is possible, of {} that were tried: {}",
            self.rejected.len(),
            told.join("; ")
        ))
    }
}
