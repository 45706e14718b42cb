//! `tabula-lab evaluate lighting`: objects are taught under a neutral lamp and recognised under
//! other lamps and beside other tables.

mod lit_views;
mod report;
mod report_page;

use crate::arguments::LightingArguments;
use crate::evaluate::tabular_report::forest_figure;
use crate::output_files::create_folder;
use command_line::{Output, progress_bar};
use learning::{CategoryIndex, CategoryName, UnknownRule, ViewId};
use lit_views::{LitView, ROOMS, Room, Treatment, Turntables};
use report::{LightingReport, RoomFigures};
use service::Failure;
use simulated_world::ModelLibrary;
use std::process::ExitCode;

/// Runs the evaluation and writes its figures.
pub(super) fn run(arguments: &LightingArguments, output: &Output) -> Result<ExitCode, Failure> {
    create_folder(&arguments.out)?;
    let library = ModelLibrary::open(&arguments.models).map_err(Failure::usage)?;
    let models = library.choose(arguments.objects as usize, arguments.seed);
    let n_jobs = models.len() * (1 + ROOMS.len());
    let turntables = Turntables {
        library: &library,
        models: &models,
        n_views: arguments.views as usize,
        seed: arguments.seed,
        bar: progress_bar(n_jobs as u64, "objects", output),
    };
    let lessons = turntables.views(Room::LESSONS, 0.0)?;
    let mut indexes = Vec::new();
    for treatment in Treatment::ALL {
        indexes.push((treatment, index_of(&lessons, treatment)?));
    }
    let mut rooms = Vec::new();
    for room in ROOMS {
        let views = turntables.views(room, 0.5)?;
        let mut shares = Vec::new();
        for (treatment, index) in &indexes {
            shares.push(correct_shares(&views, models.len(), *treatment, index)?);
        }
        rooms.push(RoomFigures::of(room, &shares, arguments.seed));
    }
    turntables.bar.finish_and_clear();
    write_all(&LightingReport::of(arguments, rooms), arguments, output)
}

/// Category name of an object: each object is taught as itself.
fn name_of(object: usize) -> Result<CategoryName, Failure> {
    CategoryName::new(&format!("object {object}")).map_err(Failure::general)
}

/// Index with the taught views of all objects.
fn index_of(lessons: &[LitView], treatment: Treatment) -> Result<CategoryIndex, Failure> {
    let mut index = pipeline::category_index();
    for (number, view) in lessons.iter().enumerate() {
        let id = ViewId {
            track_id: view.object as u64 + 1,
            view_id: number as u32,
        };
        let stored = &view.described[treatment as usize][0];
        index
            .insert(id, &name_of(view.object)?, stored)
            .map_err(Failure::general)?;
    }
    Ok(index)
}

/// Share of the correctly recognised views of each object; `None` for an object without a view.
fn correct_shares(
    views: &[LitView],
    n_objects: usize,
    treatment: Treatment,
    index: &CategoryIndex,
) -> Result<Vec<Option<f64>>, Failure> {
    let mut counts = vec![(0, 0); n_objects];
    for view in views {
        let described = &view.described[treatment as usize];
        let found = index.recognise_any(described, UnknownRule::FartherThan(f32::INFINITY));
        let found = found.map_err(Failure::general)?;
        let (n_correct, n) = &mut counts[view.object];
        *n_correct += usize::from(found.label == Some(name_of(view.object)?));
        *n += 1;
    }
    let share = |(n_correct, n): (usize, usize)| (n > 0).then(|| n_correct as f64 / n as f64);
    Ok(counts.into_iter().map(share).collect())
}

fn write_all(
    document: &LightingReport,
    arguments: &LightingArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let out = &arguments.out;
    let caption = "Accuracy in each room with its 95 % interval";
    let rows = report_page::figure_rows(document);
    let figure = forest_figure(out, "accuracy.svg", (caption, "accuracy"), &rows)?;
    report_page::page(document, figure).publish(out, "lighting.json", document, output)
}

#[cfg(test)]
mod tests;
