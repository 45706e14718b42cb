//! Image path of detection: the order of its stages, from an organised cloud to candidates.

use crate::candidate::Candidate;
use crate::carried_objects::{CarriedObjects, SharedBuffers, SurfaceFrame};
use crate::constraint_evaluation::ConstraintEvaluator;
use crate::execution::Execution;
use crate::input::DetectionInput;
use crate::near_limit::NearLimit;
use crate::outline_tracing::OutlineTracer;
use crate::output::Detection;
use crate::parallelism::{Parallelism, ScratchPool};
use crate::pixel_bounds::PixelBounds;
use crate::segmentation::SegmentationExamples;
use crate::stage::DetectionStage;
use crate::table::Table;
use crate::table_noise::noise_ratio;
use crate::table_selection::{TableSelectionBuffers, select_surfaces};
use crate::{Config, RawConfig};
use random::Random;

/// Width of the image border zone, pixels: a candidate that reaches it may be cut.
/// Chosen.
const BORDER_PX: usize = 3;

/// Buffers of the image path, reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct OrganizedBuffers {
    selection: TableSelectionBuffers,
    tracer: OutlineTracer,
    shared: SharedBuffers,
    /// Objects over each surface that carries some, in the order of the surfaces.
    carried: Vec<CarriedObjects>,
    candidates: ScratchPool<Vec<Candidate>>,
}

impl OrganizedBuffers {
    /// Empty a detection and keep the memory of its surfaces for the next one.
    pub(crate) fn recycle(&mut self, detection: &mut Detection) {
        self.selection.recycle(&mut detection.surfaces);
        detection.bodies.clear();
        detection.candidates.clear();
        detection.point_indices.clear();
    }
}

/// Stage of the detection over one surface.
type SurfaceStage = fn(&mut CarriedObjects, &SurfaceFrame<'_>, &mut SharedBuffers);

/// Stages from the pixels over a surface to hypotheses, in order.
const HYPOTHESIS_STAGES: [(DetectionStage, SurfaceStage); 5] = [
    (DetectionStage::Clustering, CarriedObjects::cluster),
    (DetectionStage::Segmentation, CarriedObjects::segment),
    (
        DetectionStage::TrackRegrouping,
        CarriedObjects::regroup_by_tracks,
    ),
    (
        DetectionStage::SupportPlaneGrowth,
        CarriedObjects::grow_to_surface,
    ),
    (
        DetectionStage::BoundingBoxes,
        CarriedObjects::find_hypotheses,
    ),
];

/// Detect the support surfaces and the candidates on them in an organised cloud; `detection`
/// comes empty. Without a table it stays empty.
pub(crate) fn detect_organized(
    frame: &DetectionInput<'_>,
    config: &Config,
    buffers: &mut OrganizedBuffers,
    detection: &mut Detection,
    mut execution: Execution<'_>,
) {
    let surfaces = &mut detection.surfaces;
    find_surfaces(frame, config.get(), buffers, surfaces, &mut execution);
    if surfaces.is_empty() {
        return;
    }
    let parallelism = execution.parallelism;
    let input = (frame, config.get(), parallelism);
    list_pixels(input, surfaces, buffers);
    execution.end_stage(DetectionStage::PrismFilter);
    for (stage, run) in HYPOTHESIS_STAGES {
        for_each_surface(input, surfaces, buffers, run);
        execution.end_stage(stage);
    }
    for surface in 0..carriers(&detection.surfaces).count() {
        write_candidates(frame, surface, config, parallelism, buffers, detection);
    }
    detection
        .bodies
        .assign(buffers.shared.reaching_bodies.map());
    execution.end_stage(DetectionStage::ConstraintEvaluation);
}

/// Frame, settings and threads of a detection.
type StageInput<'a> = (&'a DetectionInput<'a>, &'a RawConfig, &'a dyn Parallelism);

/// Run a stage for each surface that carries objects.
fn for_each_surface(
    (frame, config, parallelism): StageInput<'_>,
    surfaces: &[Table],
    buffers: &mut OrganizedBuffers,
    run: SurfaceStage,
) {
    for (objects, surface) in buffers.carried.iter_mut().zip(carriers(surfaces)) {
        let on_surface = SurfaceFrame {
            frame,
            surface,
            config,
            parallelism,
        };
        run(objects, &on_surface, &mut buffers.shared);
    }
}

/// Surfaces that carry objects; they come first.
fn carriers(surfaces: &[Table]) -> impl Iterator<Item = &Table> {
    surfaces
        .iter()
        .filter(|surface| surface.role.carries_objects())
}

/// List the pixels over each surface; those on and over a level belong to it alone.
fn list_pixels(input: StageInput<'_>, surfaces: &[Table], buffers: &mut OrganizedBuffers) {
    buffers.shared.walls.clear();
    for_each_surface(input, surfaces, buffers, CarriedObjects::list_pixels);
    let carried = &mut buffers.carried;
    let n_carriers = carriers(surfaces).count();
    for lower in 0..n_carriers {
        for upper in 0..n_carriers {
            let middle = surfaces[upper].middle_in_camera();
            if surfaces[lower].plane.height_m(&middle) > 0.0
                && let Ok([lower, over]) = carried.get_disjoint_mut([lower, upper])
            {
                lower.leave_to(&surfaces[upper], over, &input.0.cloud);
            }
        }
    }
}

/// Surfaces of a frame, those that carry objects with their cells and outlines.
fn find_surfaces(
    frame: &DetectionInput<'_>,
    config: &RawConfig,
    buffers: &mut OrganizedBuffers,
    surfaces: &mut Vec<Table>,
    execution: &mut Execution<'_>,
) {
    let OrganizedBuffers {
        selection,
        tracer,
        shared,
        carried,
        ..
    } = buffers;
    let samples = &mut shared.samples;
    samples.refill(&frame.cloud, config);
    execution.end_stage(DetectionStage::Subsampling);
    let (up, expected) = (frame.up_in_camera, frame.priors.surfaces);
    select_surfaces(samples, up, expected, config, selection, surfaces);
    execution.end_stage(DetectionStage::TablePlane);
    let carriers = surfaces
        .iter_mut()
        .filter(|surface| surface.role.carries_objects());
    let mut n_carriers = 0;
    for surface in carriers {
        if n_carriers == carried.len() {
            carried.push(CarriedObjects::default());
        }
        let cells = &mut carried[n_carriers].cells;
        cells.refill(surface, samples);
        surface.noise_ratio = noise_ratio(samples, surface, cells, &config.depth_noise);
        surface.depth_noise = config.depth_noise.scaled(surface.noise_ratio);
        if cells.differs_from_polygon() {
            tracer.trace(cells, &mut surface.outline);
        }
        n_carriers += 1;
    }
    if n_carriers > 0 {
        execution.end_stage(DetectionStage::TableSurface);
    }
}

/// Training examples of the segmentation in one frame, see
/// [`add_examples`](crate::add_examples).
pub(crate) fn add_segmentation_examples(
    frame: &DetectionInput<'_>,
    config: &Config,
    buffers: &mut OrganizedBuffers,
    objects: &[Option<u16>],
    random: &mut Random,
    examples: &mut SegmentationExamples,
) {
    let (mut surfaces, mut execution) = (Vec::new(), Execution::default());
    find_surfaces(frame, config.get(), buffers, &mut surfaces, &mut execution);
    let input = (frame, config.get(), execution.parallelism);
    list_pixels(input, &surfaces, buffers);
    for_each_surface(input, &surfaces, buffers, CarriedObjects::cluster);
    for (objects_over, surface) in buffers.carried.iter().zip(carriers(&surfaces)) {
        let on_surface = SurfaceFrame {
            frame,
            surface,
            config: config.get(),
            parallelism: execution.parallelism,
        };
        objects_over.add_examples(&on_surface, &mut buffers.shared, objects, random, examples);
    }
}

/// Evaluate the constraints of the hypotheses over a surface and append them as candidates.
fn write_candidates(
    frame: &DetectionInput<'_>,
    surface: usize,
    config: &Config,
    parallelism: &dyn Parallelism,
    buffers: &mut OrganizedBuffers,
    detection: &mut Detection,
) {
    let OrganizedBuffers {
        shared,
        carried,
        candidates,
        ..
    } = buffers;
    let (carried, table) = (&carried[surface], &detection.surfaces[surface]);
    let bounds = PixelBounds::of(&frame.cloud);
    let near_limit = NearLimit::of(frame.cloud, &shared.samples, table);
    let bodies = &shared.reaching_bodies;
    let evaluator = ConstraintEvaluator {
        cloud: frame.cloud,
        surface: (surface, table),
        priors: frame.priors,
        body_mask: &carried.body_mask,
        depth_bodies: bodies.map().is_any().then_some((bodies, &shared.samples)),
        config: config.get(),
    };
    let (indices, n_before) = (&mut detection.point_indices, detection.candidates.len());
    let mut first = indices.len();
    for hypothesis in carried.hypotheses() {
        indices.extend_from_slice(carried.pixels(hypothesis));
    }
    let hypotheses = carried.hypotheses().iter().map(|hypothesis| {
        let range = first..first + carried.pixels(hypothesis).len();
        first = range.end;
        (hypothesis, range)
    });
    candidates.for_each(
        parallelism,
        hypotheses,
        |candidates, (hypothesis, range)| {
            let pixels = &indices[range.clone()];
            let is_cut = bounds.is_touched_by(&hypothesis.statistics.pixel_bounds, BORDER_PX)
                || near_limit.cuts(pixels);
            let candidate = evaluator.candidate(hypothesis, range, pixels, is_cut, config.rule());
            candidates.push(candidate);
        },
    );
    candidates.gather(&mut detection.candidates);
    detection.candidates[n_before..].sort_unstable_by_key(|candidate| candidate.range.start);
}
