//! What is dealt into parts: the views of a data set, or those of simulated scenes.

use crate::arguments::{CrossValidationArguments, ViewProtocol};
use crate::evaluate::recognition::{RecogniserFactory, RecognitionMethod};
use crate::evaluate::scene_views::{self, SceneViews};
use crate::evaluate::view_selection::read_and_describe;
use crate::evaluate::view_table::ViewTable;
use command_line::Output;
use evaluation::cross_validation::{FoldAssignment, Folds};
use evaluation::recogniser::LabelledView;
use service::{Failure, exit_code};

/// Views with their descriptions and parts.
pub(super) struct FoldData {
    /// What it was made from.
    pub(super) source: String,
    pub(super) views: ViewTable,
    pub(super) learner: Box<dyn RecogniserFactory>,
    pub(super) folds: Folds,
    /// How the views were dealt out.
    pub(super) dealing: &'static str,
    pub(super) scenes: Option<SceneStatistics>,
}

/// What only scenes have.
pub(super) struct SceneStatistics {
    pub(super) n_scenes: usize,
    /// Fold of each candidate that is no object, or a smaller part of one; its description stands behind those of
    /// the views, in the same order.
    pub(super) folds_of_clutter: Vec<u32>,
    /// By category: how many of these are parts of its object.
    pub(super) n_parts: Vec<u32>,
    /// By category: objects that show a pixel with depth.
    pub(super) n_visible: Vec<u32>,
    /// Objects that show none.
    pub(super) n_hidden: u32,
    /// Drawn scenes: what they are, and where.
    pub(super) pictures: Vec<(String, String)>,
}

impl FoldData {
    /// What the command line names, described and dealt out.
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
            Failure::new(exit_code::USAGE, rule)
        })?;
        let (views, learner) = read_and_describe(dataset, &arguments.description, output)?;
        let dealing = dealing(arguments, &views);
        Ok(Self {
            source: dataset.display().to_string(),
            folds: deal(&views.labels, dealing, arguments)?,
            views,
            learner,
            dealing: match dealing {
                FoldAssignment::ByView => "view",
                FoldAssignment::ByInstance => "instance-disjoint",
                FoldAssignment::Contiguous => "contiguous",
            },
            scenes: None,
        })
    }

    /// All views of a scene are in one part, and each part has as many scenes of each
    /// set and camera.
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
            n_parts,
            descriptions,
            kinds,
            n_visible,
            n_hidden,
            pictures,
        } = scene_views::simulate(n_scenes, seed, method, out, output)?;
        let kind = |&category: &u32| LabelledView {
            category,
            instance: None,
        };
        let kinds: Vec<LabelledView> = kinds.iter().map(kind).collect();
        let of_scenes = deal(&kinds, FoldAssignment::ByView, arguments)?;
        let fold_of = |scenes: &[usize]| -> Vec<u32> {
            scenes
                .iter()
                .map(|&scene| of_scenes.of_view[scene])
                .collect()
        };
        Ok(Self {
            source: format!("{n_scenes} simulated scenes"),
            folds: Folds {
                of_view: fold_of(&scenes),
                ..of_scenes
            },
            learner: method.recogniser_factory(&table, descriptions)?,
            views: table,
            dealing: "scene",
            scenes: Some(SceneStatistics {
                n_scenes: n_scenes as usize,
                folds_of_clutter: fold_of(&scenes_of_clutter),
                n_parts,
                n_visible,
                n_hidden,
                pictures,
            }),
        })
    }
}

fn deal(
    views: &[LabelledView],
    dealing: FoldAssignment,
    arguments: &CrossValidationArguments,
) -> Result<Folds, Failure> {
    Folds::assign(views, arguments.folds, dealing, arguments.seed)
        .map_err(|error| Failure::new(exit_code::USAGE, error))
}

/// Object by object where objects are known, unless something else is wished.
fn dealing(arguments: &CrossValidationArguments, views: &ViewTable) -> FoldAssignment {
    let is_known = views.labels.iter().any(|view| view.instance.is_some());
    match arguments.protocol {
        _ if arguments.contiguous => FoldAssignment::Contiguous,
        Some(ViewProtocol::InstanceDisjoint) => FoldAssignment::ByInstance,
        None if is_known => FoldAssignment::ByInstance,
        Some(ViewProtocol::View) | None => FoldAssignment::ByView,
    }
}
