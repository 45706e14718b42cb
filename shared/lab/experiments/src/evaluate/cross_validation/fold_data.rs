//! Views with their fold assignment: from a data set or from simulated scenes.

use crate::arguments::{CrossValidationArguments, FoldProtocol};
use crate::evaluate::recognition::{RecogniserFactory, RecognitionMethod};
use crate::evaluate::scene_views::{self, SceneStatistics, SceneViews};
use crate::evaluate::view_selection::read_and_describe;
use crate::evaluate::view_table::ViewTable;
use command_line::Output;
use evaluation::cross_validation::{FoldAssignment, Folds};
use evaluation::recogniser::LabelledView;
use service::Failure;

/// Described views with their folds.
pub(super) struct FoldData {
    /// Name of the data source.
    pub(super) source: String,
    pub(super) views: ViewTable,
    pub(super) recogniser_factory: Box<dyn RecogniserFactory>,
    pub(super) folds: Folds,
    /// Name of the rule that assigned views to folds.
    pub(super) fold_assignment: &'static str,
    pub(super) scenes: Option<SceneStatistics>,
}

impl FoldData {
    /// Described views and folds of the arguments.
    pub(super) fn of(
        arguments: &CrossValidationArguments,
        output: &Output,
    ) -> Result<Self, Failure> {
        match arguments.scenes {
            Some(n_scenes) => Self::of_scenes(n_scenes, arguments, output),
            None => Self::of_data_set(arguments, output),
        }
    }

    fn of_data_set(arguments: &CrossValidationArguments, output: &Output) -> Result<Self, Failure> {
        let dataset = arguments.dataset.as_ref().ok_or_else(|| {
            let rule = "name a data set, or let scenes be simulated with --scenes";
            Failure::usage(rule)
        })?;
        let (views, recogniser_factory) =
            read_and_describe(dataset, &arguments.description, output)?;
        let is_object_known = views.labels.iter().any(|view| view.instance.is_some());
        for (needs_objects, option) in [
            (arguments.sides > 1, "--sides"),
            (
                arguments.protocol == Some(FoldProtocol::OtherSide),
                "--protocol other-side",
            ),
        ] {
            if needs_objects && !is_object_known {
                return Err(Failure::usage(format!(
                    "the data set does not tell which views show the same object, so its sides \
                     are not known: leave out {option}"
                )));
            }
        }
        let fold_assignment = fold_assignment(arguments, is_object_known);
        let folds = assign_folds(&views.labels, fold_assignment, arguments)?;
        Ok(Self {
            source: dataset.display().to_string(),
            views,
            recogniser_factory,
            fold_assignment: name_of(fold_assignment, &folds),
            folds,
            scenes: None,
        })
    }

    /// Data of simulated scenes. All views of a scene are in one fold, and each fold has as many
    /// scenes of each object set and camera height.
    fn of_scenes(
        n_scenes: u32,
        arguments: &CrossValidationArguments,
        output: &Output,
    ) -> Result<Self, Failure> {
        let method = RecognitionMethod::of(&arguments.description);
        let (seed, out) = (arguments.seed, &arguments.out);
        let SceneViews {
            table,
            scenes,
            scenes_of_clutter,
            descriptions,
            kinds,
            statistics,
        } = scene_views::simulate(n_scenes, seed, method, out, output)?;
        let kind = |&category: &u32| LabelledView {
            category,
            instance: None,
        };
        let kinds: Vec<LabelledView> = kinds.iter().map(kind).collect();
        let folds_of_scenes = assign_folds(&kinds, FoldAssignment::ByView, arguments)?;
        let fold_of = |scenes: &[usize]| -> Vec<u32> {
            scenes
                .iter()
                .map(|&scene| folds_of_scenes.of_view[scene])
                .collect()
        };
        Ok(Self {
            source: format!("{n_scenes} simulated scenes"),
            folds: Folds {
                of_view: fold_of(&scenes),
                ..folds_of_scenes
            },
            recogniser_factory: method.recogniser_factory(&table, descriptions)?,
            views: table,
            fold_assignment: "scene",
            scenes: Some(SceneStatistics {
                folds_of_clutter: fold_of(&scenes_of_clutter),
                ..statistics
            }),
        })
    }
}

/// Name of the rule by which the views were dealt in fact: apart by object only where a category
/// has several objects.
fn name_of(fold_assignment: FoldAssignment, folds: &Folds) -> &'static str {
    match fold_assignment {
        FoldAssignment::ByInstance if folds.n_grouped > 0 => "instance-disjoint",
        FoldAssignment::ByInstance | FoldAssignment::ByView => "view",
        FoldAssignment::BySide => "other-side",
        FoldAssignment::Contiguous => "contiguous",
    }
}

fn assign_folds(
    views: &[LabelledView],
    fold_assignment: FoldAssignment,
    arguments: &CrossValidationArguments,
) -> Result<Folds, Failure> {
    Folds::assign(views, arguments.folds, fold_assignment, arguments.seed).map_err(Failure::usage)
}

/// Fold assignment: by object where objects are known, unless the arguments say otherwise.
fn fold_assignment(arguments: &CrossValidationArguments, is_object_known: bool) -> FoldAssignment {
    match arguments.protocol {
        _ if arguments.contiguous => FoldAssignment::Contiguous,
        Some(FoldProtocol::OtherSide) => FoldAssignment::BySide,
        Some(FoldProtocol::InstanceDisjoint) => FoldAssignment::ByInstance,
        None if is_object_known => FoldAssignment::ByInstance,
        Some(FoldProtocol::View) | None => FoldAssignment::ByView,
    }
}
