//! View selection: the views of a data set, read and described once for an experiment.

use super::recognition::{
    HypothesisDescriptors, RecogniserFactory, RecognitionMethod, ViewDescriber,
};
use super::view_table::{Omissions, ViewTable};
use crate::arguments::DescriptionArguments;
use crate::metric_views::MetricViews;
use crate::parallel;
use command_line::{Output, progress_bar};
use dataset::object_views::{ObjectView, ObjectViews, ViewFile};
use description::ObjectPoints;
use evaluation::recogniser::LabelledView;
use service::Failure;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// Selected views of a data set.
pub(super) struct ViewSelection {
    views: ObjectViews,
    /// Indices of the selected views in the data set, by category and object; those of an object
    /// go around it.
    selected: Vec<usize>,
}

impl ViewSelection {
    /// Lists a data set and selects at most `views_max` views of each category.
    pub(super) fn open(dataset: &Path, views_max: Option<u32>) -> Result<Self, Failure> {
        let views = ObjectViews::open(dataset).map_err(Failure::usage)?;
        let most = views_max.map_or(usize::MAX, |n| n as usize);
        Ok(Self {
            selected: selected(views.files(), most),
            views,
        })
    }

    /// Reads the views on all cores and describes each with all methods, upright if the upward
    /// direction of all views is known. A view that cannot be read, is no object on a table, or
    /// cannot be described by one of the methods, is omitted from all, with its reason.
    ///
    /// Returns the table of the views and, by method, their descriptors in the same order.
    pub(super) fn describe_by(
        &self,
        methods: &[RecognitionMethod],
        output: &Output,
    ) -> Result<(ViewTable, Vec<Vec<HypothesisDescriptors>>), Failure> {
        let describers = methods.iter().map(RecognitionMethod::describer);
        let describers: Vec<ViewDescriber> = describers.collect::<Result<_, _>>()?;
        let knows_up = self.views.is_up_known();
        let bar = progress_bar(self.views.files().len() as u64, "sizes", output);
        let metric = MetricViews::new(&self.views, None, &bar);
        bar.finish_and_clear();
        metric
            .notes()
            .iter()
            .for_each(|note| output.print_status(note));
        let bar = progress_bar(self.selected.len() as u64, "views", output);
        let own = || describers.clone();
        let described = parallel::map(self.selected.len(), &bar, own, |describers, job| {
            let index = self.selected[job];
            let view = metric.load(index)?;
            let begin = Instant::now();
            let descriptions = describe(describers, &view, knows_up).map_err(|error| {
                let path = self.views.files()[index].path.display();
                format!("the view {path} cannot be described: {error}")
            })?;
            Ok((descriptions, begin.elapsed().as_secs_f64() * 1e3))
        });
        bar.finish_and_clear();
        let (table, of_views) = self.table(described)?;
        let mut by_method: Vec<Vec<HypothesisDescriptors>> =
            methods.iter().map(|_| Vec::new()).collect();
        for of_view in of_views {
            for (of_method, readings) in by_method.iter_mut().zip(of_view) {
                of_method.push(readings);
            }
        }
        Ok((table, by_method))
    }

    /// Table of the described views, with their descriptors.
    fn table<T>(
        &self,
        described: Vec<Result<(T, f64), String>>,
    ) -> Result<(ViewTable, Vec<T>), Failure> {
        let mut left_out = self.left_out();
        let (mut files, mut descriptions, mut sum_ms) = (Vec::new(), Vec::new(), 0.0);
        for (&index, result) in self.selected.iter().zip(described) {
            match result {
                Ok((description, ms)) => {
                    files.push(&self.views.files()[index]);
                    descriptions.push(description);
                    sum_ms += ms;
                }
                Err(reason) => left_out.add(1, || reason),
            }
        }
        if files.is_empty() {
            let first = left_out.reasons.first().map_or("", String::as_str);
            return Err(Failure::general(format!(
                "none of the {} views can be used; the first: {first}",
                left_out.n
            )));
        }
        let (categories, labels) = numbered(&files);
        let table = ViewTable {
            categories,
            labels,
            files: files.iter().map(|file| text_of(&file.path)).collect(),
            omissions: left_out,
            is_up_known: self.views.is_up_known(),
            describe_ms: sum_ms / descriptions.len() as f64,
        };
        Ok((table, descriptions))
    }

    /// Views left out of the listing, with reasons.
    fn left_out(&self) -> Omissions {
        let mut left_out = Omissions::default();
        for error in self.views.unusable() {
            left_out.add(1, || error.to_string());
        }
        let n = self.views.n_incomplete();
        if n > 0 {
            left_out.add(n, || {
                format!("{n} views have neither all of their images nor points")
            });
        }
        left_out
    }
}

/// Reads and describes the views of a data set as the arguments demand.
pub(super) fn read_and_describe(
    dataset: &Path,
    arguments: &DescriptionArguments,
    output: &Output,
) -> Result<(ViewTable, Box<dyn RecogniserFactory>), Failure> {
    let selection = ViewSelection::open(dataset, arguments.views_max)?;
    let method = RecognitionMethod::of(arguments);
    let (table, mut descriptions) = selection.describe_by(&[method], output)?;
    let descriptions = descriptions.pop().unwrap_or_default();
    let factory = method.recogniser_factory(&table, descriptions)?;
    Ok((table, factory))
}

fn describe(
    describers: &mut [ViewDescriber],
    view: &ObjectView,
    knows_up: bool,
) -> Result<Vec<HypothesisDescriptors>, description::Error> {
    let up = view.up.as_ref().filter(|_| knows_up);
    let points = ObjectPoints::all(&view.points);
    let describe = |describer: &mut ViewDescriber| describer.describe(points, up);
    describers.iter_mut().map(describe).collect()
}

fn text_of(path: &Path) -> String {
    path.display().to_string()
}

/// Indices of at most `most` views of each category, spread evenly over its views. The views of an
/// object come in the order of the turntable, those from different heights beside each other.
fn selected(files: &[ViewFile], most: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..files.len()).collect();
    let object = |&index: &usize| (&files[index].category, &files[index].instance);
    for of_object in order.chunk_by_mut(|a, b| object(a) == object(b)) {
        of_object.sort_by_key(|&index| files[index].frame);
    }
    let is_same = |a: &usize, b: &usize| files[*a].category == files[*b].category;
    let mut selected = Vec::new();
    for of_category in order.chunk_by(is_same) {
        let n = of_category.len().min(most);
        selected.extend((0..n).map(|i| of_category[i * of_category.len() / n]));
    }
    selected
}

/// Category names in order, and the labels of the views.
fn numbered(files: &[&ViewFile]) -> (Vec<String>, Vec<LabelledView>) {
    let mut categories: Vec<String> = Vec::new();
    let mut instances: BTreeMap<(&str, &str), u32> = BTreeMap::new();
    let mut labels = Vec::new();
    for file in files {
        if categories.last() != Some(&file.category) {
            categories.push(file.category.clone());
        }
        let instance = file.instance.as_deref().map(|instance| {
            let n = instances.len() as u32;
            *instances.entry((&file.category, instance)).or_insert(n)
        });
        labels.push(LabelledView {
            category: categories.len() as u32 - 1,
            instance,
        });
    }
    (categories, labels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(category: &str, instance: Option<&str>) -> ViewFile {
        ViewFile {
            path: category.into(),
            category: category.into(),
            instance: instance.map(str::to_owned),
            frame: None,
        }
    }

    #[test]
    fn selection_is_spread_evenly_over_the_views() {
        let files: Vec<ViewFile> = (0..13)
            .map(|i| file(if i < 10 { "a" } else { "b" }, None))
            .collect();
        assert_eq!(selected(&files, 4), [0, 2, 5, 7, 10, 11, 12]);
        assert_eq!(selected(&files, usize::MAX), (0..13).collect::<Vec<_>>());
    }

    #[test]
    fn views_of_an_object_go_around_it() {
        let view = |instance: &str, frame: u32| ViewFile {
            frame: Some(frame),
            ..file("a", Some(instance))
        };
        // Two heights of the turntable, one after the other, and another object.
        let files = [
            view("1", 1),
            view("1", 2),
            view("1", 1),
            view("1", 2),
            view("2", 1),
        ];
        assert_eq!(selected(&files, usize::MAX), [0, 2, 1, 3, 4]);
    }

    #[test]
    fn instances_are_distinguished_by_category() {
        let files = [
            file("a", Some("1")),
            file("a", Some("2")),
            file("b", Some("1")),
            file("b", Some("1")),
            file("c", None),
        ];
        let (categories, labels) = numbered(&files.iter().collect::<Vec<_>>());
        assert_eq!(categories, ["a", "b", "c"]);
        let instances: Vec<_> = labels.iter().map(|label| label.instance).collect();
        assert_eq!(instances, [Some(0), Some(1), Some(2), Some(2), None]);
        assert_eq!(labels.last().unwrap().category, 2);
    }
}
