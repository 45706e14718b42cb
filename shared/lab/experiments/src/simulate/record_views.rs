//! `tabula-lab simulate views`: training views of single objects in the layout of the Washington
//! RGB-D Object Dataset.

use super::turntable::{ELEVATIONS, SegmentedView, Turntable, TurntableRoom};
use crate::arguments::ViewsArguments;
use command_line::{Output, progress_bar};
use dataset::washington::{CAMERA, CroppedView, ViewName, write_view};
use indicatif::ProgressBar;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;
use service::Failure;
use simulated_world::{ModelChoice, ModelLibrary, ModelSource};
use std::collections::BTreeMap;
use std::process::ExitCode;

/// One view in this number may be lost without a failure of the command. Chosen.
const MOST_LOST: usize = 10;

/// Object view to be rendered.
struct RenderJob {
    model: ModelChoice,
    category: String,
    /// Instance number within the category, from 1.
    instance: u32,
}

impl RenderJob {
    /// Number of the object, which does not depend on the other objects of the run (FNV-1a).
    fn number(&self) -> u64 {
        let name = self.category.bytes().chain(self.instance.to_le_bytes());
        name.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
    }
}

/// Counts and notes of the rendered views.
#[derive(Debug, Default, Serialize)]
struct ViewsReport {
    views: usize,
    objects: usize,
    categories: usize,
    /// Number of views in which detection did not find the object.
    not_detected: usize,
    /// Mean intersection over union of segmented and true pixels.
    mean_overlap: f64,
    /// Sum of the overlaps, in parts per million: integers add up to the same in any order.
    #[serde(skip)]
    overlap_ppm: u64,
    /// Remarks about the views, one sentence each.
    notes: Vec<String>,
    /// Unusable models, one sentence each.
    failures: Vec<String>,
}

/// Renders, segments and writes the views of all objects, on all cores.
pub(super) fn run(arguments: &ViewsArguments, output: &Output) -> Result<ExitCode, Failure> {
    let library = ModelLibrary::open(&arguments.models).map_err(Failure::usage)?;
    let mut library = library.with_import(arguments.import());
    let notes = library.take_notes();
    let jobs = jobs(arguments, &library)?;
    let n_views = jobs.len() as u64 * u64::from(arguments.views);
    let bar = progress_bar(n_views, "views", output);
    let parts = jobs
        .par_iter()
        .map(|job| record_object(arguments, &library, job, &bar));
    let parts: Vec<Result<ViewsReport, Failure>> = parts.collect();
    bar.finish_and_clear();
    let mut report = ViewsReport {
        notes,
        ..ViewsReport::default()
    };
    for part in parts {
        report.add(part?);
    }
    report.finish(&jobs);
    output.answer(&report, || text(&report, arguments));
    Ok(if report.has_many_losses() {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    })
}

fn text(report: &ViewsReport, arguments: &ViewsArguments) -> String {
    let sentences = report.notes.iter().chain(&report.failures);
    let sentences = sentences.fold(String::new(), |all, one| all + one + "\n");
    format!(
        "{sentences}{} views of {} objects in {} categories are in {}\n\
         cut out by detection; {} views without the object, mean overlap with the truth {:.1} %",
        report.views,
        report.objects,
        report.categories,
        arguments.out.display(),
        report.not_detected,
        report.mean_overlap * 100.0
    )
}

impl ViewsReport {
    /// Adds the counts and sentences of another report.
    fn add(&mut self, mut part: Self) {
        self.views += part.views;
        self.not_detected += part.not_detected;
        self.overlap_ppm += part.overlap_ppm;
        self.notes.append(&mut part.notes);
        self.failures.append(&mut part.failures);
    }

    /// True if more than a tenth of the views were lost, or there is none.
    fn has_many_losses(&self) -> bool {
        let n_asked = self.views + self.not_detected;
        self.views == 0 || self.not_detected > n_asked / MOST_LOST
    }

    fn finish(&mut self, jobs: &[RenderJob]) {
        self.objects = jobs.len() - self.failures.len();
        let categories: std::collections::BTreeSet<&str> =
            jobs.iter().map(|job| job.category.as_str()).collect();
        self.categories = categories.len();
        self.mean_overlap = self.overlap_ppm as f64 * 1e-6 / self.views.max(1) as f64;
        self.notes.sort();
        self.failures.sort();
    }
}

fn jobs(arguments: &ViewsArguments, library: &ModelLibrary) -> Result<Vec<RenderJob>, Failure> {
    let mut jobs = Vec::new();
    let mut n_of_category: BTreeMap<String, u32> = BTreeMap::new();
    for model in library.all(arguments.instances, arguments.seed) {
        let category = model.category();
        if !arguments.category.is_empty() && !arguments.category.contains(&category) {
            continue;
        }
        let instance = n_of_category.entry(category.clone()).or_default();
        *instance += 1;
        jobs.push(RenderJob {
            instance: *instance,
            model,
            category,
        });
    }
    for wanted in &arguments.category {
        if !n_of_category.contains_key(wanted) {
            let source = match library.source() {
                ModelSource::Generated => "`tabula simulate categories` lists those there are",
                ModelSource::Folder(_) => "the folder has no such model",
            };
            return Err(Failure::usage(format!(
                "there is no category `{wanted}`; {source}"
            )));
        }
    }
    Ok(jobs)
}

/// Records all views of one object; an unusable model is reported, not an error.
fn record_object(
    arguments: &ViewsArguments,
    library: &ModelLibrary,
    job: &RenderJob,
    bar: &ProgressBar,
) -> Result<ViewsReport, Failure> {
    let mut report = ViewsReport::default();
    let seed = (arguments.seed, job.number());
    let room = TurntableRoom {
        lighting: arguments.lighting,
        ..TurntableRoom::default()
    };
    match Turntable::new(&job.model, library.clone(), CAMERA, room, seed) {
        Ok(mut turntable) => {
            report.notes = turntable.take_notes();
            record(&mut turntable, job, arguments, &mut report, bar)?;
        }
        Err(error) => {
            report.failures.push(error.to_string());
            bar.inc(arguments.views.into());
        }
    }
    Ok(report)
}

/// Records the views of an object, alternating between the camera heights.
fn record(
    turntable: &mut Turntable,
    job: &RenderJob,
    arguments: &ViewsArguments,
    report: &mut ViewsReport,
    bar: &ProgressBar,
) -> Result<(), Failure> {
    let n_views = arguments.views as usize;
    let n_turns = n_views.div_ceil(ELEVATIONS.len());
    for index in 0..n_views {
        let (height, turn) = (index % ELEVATIONS.len(), index / ELEVATIONS.len());
        let cut_out = turntable.view(height, turn as f64 / n_turns as f64);
        if let Some(cut_out) = cut_out.map_err(Failure::general)? {
            let (sequence, frame) = (ELEVATIONS[height].0, turn as u32 + 1);
            let name =
                ViewName::new(&job.category, job.instance, sequence, frame).ok_or_else(|| {
                    Failure::general(format!("`{}` is no category's name", job.category))
                })?;
            let view = washington_view(&cut_out);
            write_view(&arguments.out, &name, &view, Some(&CAMERA)).map_err(Failure::general)?;
            report.views += 1;
            report.overlap_ppm += (cut_out.overlap * 1e6) as u64;
        } else {
            report.not_detected += 1;
        }
        bar.inc(1);
    }
    Ok(())
}

/// Converts a segmented view to a Washington-dataset view: crop to the bounding rectangle of the
/// segmented points, with the white balance that perception finds in the whole frame.
fn washington_view(cut_out: &SegmentedView<'_>) -> CroppedView {
    let white_balance = cut_out.white_balance();
    let width = CAMERA.width;
    let columns = cut_out.point_indices.iter().map(|index| index % width);
    let rows = cut_out.point_indices.iter().map(|index| index / width);
    let (left, right) = columns.fold((u32::MAX, 0), |(l, r), c| (l.min(c), r.max(c)));
    let (top, bottom) = rows.fold((u32::MAX, 0), |(t, b), r| (t.min(r), b.max(r)));
    let size = (right - left + 1, bottom - top + 1);
    let n_pixels = (size.0 * size.1) as usize;
    let mut view = CroppedView {
        size,
        top_left: (left, top),
        color: Vec::with_capacity(3 * n_pixels),
        depth_mm: Vec::with_capacity(n_pixels),
        mask: vec![0; n_pixels],
    };
    for row in top..=bottom {
        for column in left..=right {
            let point = &cut_out.cloud[(row * width + column) as usize];
            view.color
                .extend_from_slice(&white_balance.color(point.color).rgb());
            // A pixel without depth is NaN, which becomes 0.
            view.depth_mm.push((point.z * 1000.0).round() as u16);
        }
    }
    for index in cut_out.point_indices {
        let (column, row) = (index % width - left, index / width - top);
        view.mask[(row * size.0 + column) as usize] = 255;
    }
    view
}
