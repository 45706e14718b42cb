//! Track initiation: the candidates that no track explains are followed, without a track-id and
//! without an actor, until an existence test accepts or rejects their objects.

use crate::Config;
use crate::candidate_measurement::{CandidateMeasurement, observed_candidates};
use crate::frame_pose::FramePose;
use crate::track::Track;
use tracking::{
    ArrivalPrior, AssociationBuffers, DepthView, Existence, ExistenceTest, MotionConfig,
    MotionFilter, OcclusionState, PredictedTrack, Visibility, associate, fraction_inside,
};

/// Time without a sighting after which a prospective object is dropped, nanoseconds. Chosen.
const UNSEEN_TIMEOUT_NS: u64 = 300_000_000;

/// Time after hand contact in which no new track starts near the handled object,
/// nanoseconds. Chosen.
const HANDLED_NS: u64 = 500_000_000;

/// Margin around a recently handled object in which no new track starts, metres: the
/// hand may split the object into parts. Chosen.
const HANDLED_MARGIN_M: f64 = 0.03;

/// Distance from the box of a track out of view within which a candidate may be its object,
/// metres: the largest error of the camera pose that is looked for. Chosen.
const RETURNING_MARGIN_M: f64 = 0.10;

/// Fraction of a candidate inside a visible track's box, or of that box inside the
/// candidate, above which they fill the same space.
pub(crate) const SAME_SPACE_FRACTION_MIN: f64 = 0.5;

/// Prospective object: found in some frames, and not yet certain.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ProspectiveObject {
    /// Capture stamp of the first measurement, nanoseconds.
    pub(crate) first_seen_ns: u64,
    /// Motion state after the last measurement.
    pub(crate) updated_filter: MotionFilter,
    /// Motion state predicted to the last frame.
    pub(crate) filter: MotionFilter,
    /// Last measurement of the object.
    pub(crate) measured: CandidateMeasurement,
    /// Index of the candidate in the last frame.
    candidate: Option<usize>,
    existence: ExistenceTest,
}

impl ProspectiveObject {
    fn start(candidate: usize, measured: &CandidateMeasurement, motion: &MotionConfig) -> Self {
        let filter = MotionFilter::start(&measured.measurement, motion);
        Self {
            first_seen_ns: filter.stamp_ns(),
            updated_filter: filter,
            filter,
            measured: *measured,
            candidate: Some(candidate),
            existence: ExistenceTest::start(measured.evidence),
        }
    }

    /// Continues with a candidate. A measurement that does not fit the motion starts it anew.
    fn sighted(
        &mut self,
        candidate: usize,
        measured: &CandidateMeasurement,
        motion: &MotionConfig,
    ) {
        let measurement = &measured.measurement;
        let updated = self.updated_filter.updated(measurement, None, motion);
        self.updated_filter = updated.unwrap_or_else(|_| MotionFilter::start(measurement, motion));
        self.filter = self.updated_filter;
        self.measured = *measured;
        self.candidate = Some(candidate);
        self.existence = self.existence.sighted(measured.evidence);
    }

    /// Continues without a candidate. True if the object may still be there.
    fn missed(&mut self, capture_ns: u64, view: Option<&DepthView<'_>>) -> bool {
        self.candidate = None;
        let occlusion = view.map_or(OcclusionState::Unknown, |view| {
            view.occlusion_of(&self.filter.box_in_world())
        });
        if occlusion == OcclusionState::Unknown {
            self.existence = self.existence.missed();
        }
        let unseen_ns = capture_ns.saturating_sub(self.updated_filter.stamp_ns());
        occlusion != OcclusionState::Empty && unseen_ns < UNSEEN_TIMEOUT_NS && !self.is_rejected()
    }

    /// True if the test has found that there is no object, by any prior.
    fn is_rejected(&self) -> bool {
        self.existence.existence(ArrivalPrior::Even) == Existence::Rejected
    }

    /// Place and appearance for data association.
    fn predicted(&self) -> PredictedTrack {
        PredictedTrack {
            box_in_world: self.filter.box_in_world(),
            covariance_m2: self.filter.position_covariance_m2(),
            appearance: self.measured.appearance,
        }
    }
}

/// Prospective objects with the buffers of association.
#[derive(Debug, Default)]
pub(crate) struct TrackInitiation {
    prospects: Vec<ProspectiveObject>,
    association: AssociationBuffers,
}

impl TrackInitiation {
    /// Drops all prospective objects.
    pub(crate) fn clear(&mut self) {
        self.prospects.clear();
    }

    /// Prospective objects, in the order in which they were first seen.
    pub(crate) fn prospects(&self) -> &[ProspectiveObject] {
        &self.prospects
    }

    /// Predicts the prospective objects to a frame.
    pub(crate) fn predict(&mut self, capture_ns: u64, motion: &MotionConfig) {
        for prospect in &mut self.prospects {
            prospect.filter = prospect.updated_filter.predicted(capture_ns, motion);
        }
    }

    /// Follows the prospective objects to the candidates that no track has, which leave `measured`.
    pub(crate) fn follow(
        &mut self,
        measured: &mut [Option<CandidateMeasurement>],
        frame: &FramePose,
        view: Option<&DepthView<'_>>,
        config: &Config,
    ) {
        let expected = self
            .prospects
            .iter()
            .map(|prospect| Some(prospect.predicted()));
        let matched = associate(
            expected,
            observed_candidates(measured, config),
            config.association(),
            &mut self.association,
        );
        let mut matched = matched.iter();
        self.prospects.retain_mut(|prospect| {
            let candidate = matched.next().copied().flatten();
            let found = candidate.and_then(|i| Some((i, measured[i].take()?)));
            match found {
                Some((candidate, measured)) => {
                    prospect.sighted(candidate, &measured, config.motion());
                    !prospect.is_rejected()
                }
                None => prospect.missed(frame.capture_ns, view),
            }
        });
    }

    /// Starts a prospective object with each candidate that is left in `measured` and may be one
    /// by a predicate over its index and its measurement.
    pub(crate) fn start(
        &mut self,
        measured: &[Option<CandidateMeasurement>],
        config: &Config,
        may_be_object: impl Fn(usize, &CandidateMeasurement) -> bool,
    ) {
        for (i, measured) in measured.iter().enumerate() {
            if let Some(measured) = measured.as_ref().filter(|one| may_be_object(i, one)) {
                self.prospects
                    .push(ProspectiveObject::start(i, measured, config.motion()));
            }
        }
    }

    /// Takes the objects that are certain by a prior and were seen in the last frame, as long as
    /// `start` accepts them with their candidates.
    pub(crate) fn take_certain(
        &mut self,
        prior: ArrivalPrior,
        mut start: impl FnMut(&ProspectiveObject, usize) -> bool,
    ) {
        self.prospects.retain(|prospect| {
            let is_certain = prospect.existence.existence(prior) == Existence::Accepted;
            let candidate = prospect.candidate.filter(|_| is_certain);
            !candidate.is_some_and(|candidate| start(prospect, candidate))
        });
    }

    /// True if a candidate of the last frame belongs to a prospective object.
    pub(crate) fn has_candidate(&self, candidate: usize) -> bool {
        let mut prospects = self.prospects.iter();
        prospects.any(|prospect| prospect.candidate == Some(candidate))
    }
}

/// True if a candidate that no track has may be a part of an object that has one.
pub(crate) fn may_be_part(
    measured: &CandidateMeasurement,
    (tracks, frame, config): (&[Track], &FramePose, &Config),
) -> bool {
    is_part_of_handled(tracks, measured, frame)
        || is_part_of_returning(tracks, measured, config)
        || is_inside_visible(tracks, measured)
}

/// True if a candidate may be a part of a recently handled object.
fn is_part_of_handled(
    tracks: &[Track],
    measured: &CandidateMeasurement,
    frame: &FramePose,
) -> bool {
    let centre = measured.measurement.box_in_world().centre();
    tracks.iter().any(|track| {
        track.was_handled(frame.capture_ns, HANDLED_NS)
            && track.box_in_world().contains(&centre, HANDLED_MARGIN_M)
    })
}

/// True if a candidate that the image border cuts may be the part in view of a kept track that
/// is still out of view. More of it decides: a new track would be a second one of the object.
fn is_part_of_returning(
    tracks: &[Track],
    measured: &CandidateMeasurement,
    config: &Config,
) -> bool {
    let (part, centre) = (
        &measured.appearance,
        measured.measurement.box_in_world().centre(),
    );
    let similarity_min = config.association().color_similarity_min;
    measured.is_truncated_by_image
        && tracks.iter().any(|track| {
            track.visibility() == Visibility::OutOfView
                && track.box_in_world().contains(&centre, RETURNING_MARGIN_M)
                && track.appearance.colors.similarity(&part.colors) >= similarity_min
        })
}

/// True if a candidate fills the same space as an object that was seen in this frame: it is
/// a fragment of that object, or both are.
fn is_inside_visible(tracks: &[Track], measured: &CandidateMeasurement) -> bool {
    let seen = measured.measurement.box_in_world();
    tracks
        .iter()
        .filter(|track| track.is_visible())
        .any(|track| {
            let known = track.box_in_world();
            fraction_inside(seen, &known) >= SAME_SPACE_FRACTION_MIN
                || fraction_inside(&known, seen) >= SAME_SPACE_FRACTION_MIN
        })
}
