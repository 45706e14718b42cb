//! Planning of views from snapshots, with what is kept from plan to plan: stored models, visited
//! views, the random numbers of the draws.

use super::motion::Motion;
use super::plan_document::{self, PlanDocument};
use super::publication::PlanPublisher;
use super::{picture, pose_file, remarks};
use crate::arguments::PlanArguments;
use channel::{Domain, DomainName, Error};
use geometry::RigidTransform;
use next_best_view::OccupancyGrid;
use random::Random;
use scene_client::{DaemonModels, ModelShelf, PlanningFrame, Snapshot};
use service::{CommonArguments, Failure};
use std::time::Instant;
use view_planning::{PlanContent, PlanSettings, ViewPlan, hemisphere};

/// Number of visited views that are kept.
const N_VISITED_MAX: usize = 1000;

/// Planning of views with what is kept from plan to plan.
pub(crate) struct ViewPlanning<'a> {
    common: &'a CommonArguments,
    arguments: &'a PlanArguments,
    /// Poses of `--views` in the world.
    given: Option<Vec<RigidTransform>>,
    /// Poses of `--visited` and of earlier plans in the world.
    visited: Vec<RigidTransform>,
    shelf: ModelShelf,
    random: Random,
    publisher: Option<PlanPublisher>,
}

impl<'a> ViewPlanning<'a> {
    /// Planning by arguments.
    ///
    /// # Errors
    /// When a file of poses is bad, or the picture would replace what is no regular file.
    pub(crate) fn new(
        common: &'a CommonArguments,
        arguments: &'a PlanArguments,
    ) -> Result<Self, Failure> {
        if let Some(file) = &arguments.picture {
            dataset::check_output(file).map_err(Failure::usage)?;
        }
        let given = arguments
            .views
            .as_deref()
            .map(pose_file::read)
            .transpose()?;
        if let (Some(file), Some([])) = (&arguments.views, given.as_deref()) {
            return Err(Failure::usage(format!(
                "the file of poses {} has none; give at least one view, or leave --views out",
                file.display()
            )));
        }
        let visited = arguments.visited.as_deref().map(pose_file::read);
        Ok(Self {
            common,
            arguments,
            given,
            visited: visited.transpose()?.unwrap_or_default(),
            shelf: ModelShelf::default(),
            random: Random::from_seed(arguments.seed),
            publisher: None,
        })
    }

    pub(crate) fn arguments(&self) -> &PlanArguments {
        self.arguments
    }

    pub(crate) fn domain_name(&self) -> &DomainName {
        &self.common.domain
    }

    /// Joins the topic of plans.
    ///
    /// # Errors
    /// When the topic has no room for another planner.
    pub(crate) fn join(&mut self, domain: &Domain) -> Result<(), Error> {
        self.publisher = Some(PlanPublisher::new(domain)?);
        Ok(())
    }

    /// Delivers the newest plan to new subscribers.
    ///
    /// # Errors
    /// When shared memory fails.
    pub(crate) fn greet(&self) -> Result<(), Error> {
        self.publisher.as_ref().map_or(Ok(()), PlanPublisher::greet)
    }

    /// Plans from a snapshot, publishes the plan, and counts the present view as visited.
    ///
    /// # Errors
    /// When there is nothing to look at, no candidate is left, or the picture cannot be written.
    pub(crate) fn plan(&mut self, snapshot: &Snapshot) -> Result<PlanDocument, Failure> {
        let begun = Instant::now();
        let Some(frame) = PlanningFrame::of(snapshot) else {
            return Err(Failure::general(
                "no object is seen, and the middle of the image has no depth, so that there is \
                 nothing to look at; point the camera at the table",
            ));
        };
        let mut notes = frame.notes.clone();
        let open = || DaemonModels::connect(self.common);
        if let Err(failure) = self.shelf.refresh(snapshot, open) {
            notes.push(format!("the stored models are not used: {failure}"));
        }
        let settings: PlanSettings = self.arguments.settings();
        let wants_occupancy = settings.gain_weight > 0.0;
        let content = PlanContent::of(snapshot, frame, &self.shelf, wants_occupancy)?;
        notes.extend(remarks::remarks(snapshot, &content.hypotheses));
        let visited = content.frame.poses(&self.visited);
        let candidates = self.candidates(&content.frame);
        let random = &mut self.random;
        let plan = view_planning::plan(&content, &candidates, &visited, &settings, random);
        // The present view is taken, even where no other is left.
        let n_visited = self.visited.len() + 1;
        self.note_visited(snapshot);
        let plan = plan?;
        let is_published = self.publish(snapshot, &plan, &content.frame, &mut notes);
        if let Some(file) = &self.arguments.picture {
            picture::write(file, &content, &plan)?;
        }
        let mut document = document(snapshot, &plan, &content, n_visited);
        document.is_published = is_published;
        document.notes = notes;
        document.processing_ms = 1e3 * begun.elapsed().as_secs_f64();
        Ok(document)
    }

    /// Candidates in the frame of planning.
    fn candidates(&self, frame: &PlanningFrame) -> Vec<RigidTransform> {
        if let Some(given) = &self.given {
            return frame.poses(given);
        }
        let present_m = frame.plan_from_camera.translation.vector.norm();
        hemisphere(
            self.arguments.candidates.into(),
            self.arguments.distance_m.unwrap_or(present_m),
            self.arguments.min_elevation_deg.to_radians(),
        )
    }

    /// Keeps the present pose. Poses in the frames of a camera that moves cannot be compared.
    fn note_visited(&mut self, snapshot: &Snapshot) {
        if let Some(pose) = snapshot.world_from_camera {
            if self.visited.len() >= N_VISITED_MAX {
                self.visited.remove(0);
            }
            self.visited.push(pose);
        }
    }

    fn publish(
        &mut self,
        snapshot: &Snapshot,
        plan: &ViewPlan,
        frame: &PlanningFrame,
        notes: &mut Vec<String>,
    ) -> bool {
        let Some(publisher) = &mut self.publisher else {
            return false;
        };
        let published = publisher.publish(snapshot, plan, &frame.world_from_plan);
        if let Err(error) = &published {
            notes.push(format!("the plan was not published: {error}"));
        }
        published.is_ok()
    }
}

fn document(
    snapshot: &Snapshot,
    plan: &ViewPlan,
    content: &PlanContent,
    n_visited: usize,
) -> PlanDocument {
    let world_from_plan = &content.frame.world_from_plan;
    let (views, present) = plan_document::views(plan, world_from_plan);
    let present_pose = plan.present.plan_from_camera;
    let chosen_pose = plan.views[plan.chosen].plan_from_camera;
    let target = if content.hypotheses.is_empty() {
        "the place in the middle of the present image"
    } else {
        "the middle of the objects"
    };
    PlanDocument {
        chosen: views[plan.chosen].clone(),
        reason: plan_document::reason_word(plan.reason),
        motion: Motion::new(present_pose, chosen_pose).in_words(target),
        present,
        views,
        hypotheses: plan_document::hypotheses(snapshot, &content.hypotheses, plan, world_from_plan),
        objects: plan_document::objects(snapshot, &content.hypotheses),
        n_background_points: content.background.len(),
        n_unknown_voxels: content
            .occupancy
            .as_ref()
            .map_or(0, OccupancyGrid::n_unknown),
        n_visited,
        frame_sequence: snapshot.sequence,
        source_name: snapshot.source_name.clone(),
        has_world_pose: snapshot.world_from_camera.is_some(),
        is_published: false,
        notes: Vec::new(),
        processing_ms: 0.0,
    }
}
