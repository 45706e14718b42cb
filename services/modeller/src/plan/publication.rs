//! Publication of plans on the topic `view/plan`.

use channel::topic::ViewPlans;
use channel::{Domain, Error, Publisher};
use geometry::RigidTransform;
use message::{MAX_PLANNED_VIEWS, PlannedView, ViewPlanHeader, WirePose};
use scene_client::Snapshot;
use view_planning::{RatedView, ViewPlan};

/// Publisher of plans.
pub(crate) struct PlanPublisher(Publisher<ViewPlans>);

impl PlanPublisher {
    /// Joins the topic. Subscribers that poll it meanwhile get the first plan.
    ///
    /// # Errors
    /// When as many planners run as the topic has room for.
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Publisher::new(domain).map(Self)
    }

    /// Publishes a plan.
    ///
    /// # Errors
    /// When shared memory fails.
    pub(crate) fn publish(
        &mut self,
        snapshot: &Snapshot,
        plan: &ViewPlan,
        world_from_plan: &RigidTransform,
    ) -> Result<(), Error> {
        let header = ViewPlanHeader {
            has_world_pose: u32::from(snapshot.world_from_camera.is_some()),
            session: snapshot.session,
            sequence: snapshot.sequence,
            capture_ns: snapshot.capture_ns,
            world_from_camera: WirePose::from(&snapshot.pose()),
            entropy: plan.present.score.entropy,
            n_candidates: plan.views.len() as u32,
            n_objects: plan.shares.len() as u32,
            ..ViewPlanHeader::default()
        };
        self.0
            .send_copy(header, &planned_views(plan, world_from_plan))
    }

    /// Delivers the newest plan to subscribers that have come since.
    ///
    /// # Errors
    /// When shared memory fails.
    pub(crate) fn greet(&self) -> Result<(), Error> {
        self.0.deliver_history()
    }
}

/// Views as they are sent: the chosen one, the others by rank, those that cannot be chosen.
fn planned_views(plan: &ViewPlan, world_from_plan: &RigidTransform) -> Vec<PlannedView> {
    let mut order: Vec<usize> = (0..plan.views.len()).collect();
    order.sort_by_key(|&index| {
        let rank = plan.views[index].rank.unwrap_or(usize::MAX);
        (index != plan.chosen, rank)
    });
    order.truncate(MAX_PLANNED_VIEWS);
    let wire = |index: usize| {
        let view: &RatedView = &plan.views[index];
        PlannedView {
            world_from_camera: WirePose::from(&(world_from_plan * view.plan_from_camera)),
            entropy: view.score.entropy,
            gain: view.score.gain,
            weight: view.score.weight,
            utility: view.score.utility,
            state: view.state.code(),
            rank: view.rank.unwrap_or(0) as u32,
            is_chosen: u32::from(index == plan.chosen),
            n_objects_seen: view.n_objects_seen as u32,
        }
    };
    order.into_iter().map(wire).collect()
}
