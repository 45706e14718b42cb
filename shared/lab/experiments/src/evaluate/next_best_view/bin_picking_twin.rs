//! Generated twin of the bin-picking scenes (Doumanoglou et al. 2016) on which the paper measures
//! its prediction: one model many times in a bin.

use super::captured_view::capture_all;
use super::published_statistic::{PaperFigures, SceneStatistic};
use super::scene_planner::ScenePlanner;
use super::simulated_bin::{SimulatedBin, ViewLattice};
use random::mix64;
use service::Failure;
use simulated_world::{ModelChoice, ModelLibrary, Scene, SceneKind};

/// Least elevation of the cameras, degrees. Chosen: above it every camera looks into the bin over
/// its nearer wall.
const ELEVATION_MIN_DEG: f64 = 30.0;
/// Number of throws after which no scene with all objects in the bin is expected. Chosen.
const N_THROWS: u64 = 50;
/// Instance of the generated model of all scenes. Chosen: the data set has one model of a kind.
const INSTANCE: u64 = 1;

coded_enum::coded_enum! {
    /// Kind of bin-picking scene.
    pub(super) enum TwinKind {
        /// 15 coffee cups.
        CoffeeCups, "coffee-cups";
        /// 5 juice boxes.
        JuiceBoxes, "juice-boxes";
    }
}

impl TwinKind {
    /// Number of objects of a scene.
    pub(super) fn n_objects(self) -> usize {
        match self {
            Self::CoffeeCups => 15,
            Self::JuiceBoxes => 5,
        }
    }

    /// Figures of the paper for the kind.
    pub(super) fn paper(self) -> PaperFigures {
        match self {
            Self::CoffeeCups => PaperFigures {
                sd: 0.105,
                mse: 5.22,
            },
            Self::JuiceBoxes => PaperFigures {
                sd: 0.067,
                mse: 3.95,
            },
        }
    }

    /// Model of the objects: a mug of 9 cm, and a carton of a quarter litre with a straw.
    fn model(self) -> ModelChoice {
        let category = match self {
            Self::CoffeeCups => "mug",
            Self::JuiceBoxes => "juice-box",
        };
        ModelChoice::Generated {
            category: category.to_owned(),
            instance: INSTANCE,
        }
    }
}

/// Throws the objects of a kind until all of them rest in the bin.
pub(super) fn thrown(kind: TwinKind, seed: u64, n_views: u32) -> Result<SimulatedBin, Failure> {
    let views = ViewLattice {
        n_views,
        elevation_min_deg: ELEVATION_MIN_DEG,
    };
    for throw in 0..N_THROWS {
        let (seed, mut library) = (mix64(seed ^ mix64(throw)), ModelLibrary::generated());
        let scene = Scene::generate(SceneKind::Bin, kind.n_objects(), seed, &mut library);
        let mut scene = scene.map_err(Failure::general)?;
        for object in &mut scene.objects {
            object.model = kind.model();
        }
        let bin = SimulatedBin::of_scene(scene, views, library)?;
        if bin.scene.objects.len() == kind.n_objects() {
            return Ok(bin);
        }
    }
    Err(Failure::general(format!(
        "in {N_THROWS} throws of {} {} some always fell beside the bin; choose another --seed",
        kind.n_objects(),
        kind.word()
    )))
}

/// Statistic of one scene of a kind.
pub(super) fn run(kind: TwinKind, seed: u64, n_views: u32) -> Result<SceneStatistic, Failure> {
    let bin = thrown(kind, seed, n_views)?;
    let planner = ScenePlanner::new(&bin.scene, None, seed, false)?;
    let views = capture_all(&bin, Some(&planner), false)?;
    Ok(SceneStatistic::of(&views))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twin_has_all_objects_of_one_model_and_is_the_same_for_a_seed() {
        for kind in TwinKind::ALL {
            let bin = thrown(kind, 1001, 59).unwrap();
            let objects = bin.world.objects();
            assert_eq!(bin.scene.objects.len(), kind.n_objects());
            assert!(
                objects
                    .iter()
                    .all(|object| object.model.name == objects[0].model.name)
            );
            assert_eq!(bin.scene.cameras.len(), 59);
            let is_above = bin
                .mounts
                .iter()
                .all(|mount| mount.elevation_deg > ELEVATION_MIN_DEG);
            assert!(is_above && bin.mounts.iter().any(|mount| mount.elevation_deg > 80.0));
            let poses = |bin: &SimulatedBin| -> Vec<_> {
                let objects = bin.scene.objects.iter();
                objects.map(|object| object.world_from_object).collect()
            };
            assert_eq!(poses(&bin), poses(&thrown(kind, 1001, 59).unwrap()));
            assert_ne!(poses(&bin), poses(&thrown(kind, 1002, 59).unwrap()));
        }
    }
}
