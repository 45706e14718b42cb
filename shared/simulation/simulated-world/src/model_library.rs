//! Models by name, each loaded once.

use crate::error::Error;
use crate::object_model::ObjectModel;
use crate::scene::{ModelChoice, ModelSource};
use crate::{arrangement, model_file};
use std::path::PathBuf;
use std::sync::Arc;

/// The models of a scene and those a person could bring.
#[derive(Debug, Clone)]
pub struct ModelLibrary {
    source: ModelSource,
    /// Files of a model folder.
    files: Arc<[PathBuf]>,
    loaded: Vec<(ModelChoice, Arc<ObjectModel>)>,
    notes: Vec<String>,
}

impl ModelLibrary {
    /// The generated household objects.
    pub fn generated() -> Self {
        Self {
            source: ModelSource::Generated,
            files: Arc::new([]),
            loaded: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// The models of a source.
    ///
    /// # Errors
    /// When a folder can not be read or holds no model.
    pub fn open(source: &ModelSource) -> Result<Self, Error> {
        let mut library = Self::generated();
        if let ModelSource::Folder(folder) = source {
            library.files = model_file::list(folder)?.into();
            library.source = source.clone();
        }
        Ok(library)
    }

    /// Where the models come from.
    pub fn source(&self) -> &ModelSource {
        &self.source
    }

    /// All models: of each generated category so many instances, which another
    /// seed makes others; of a folder every file.
    pub fn all(&self, n_instances: u64, seed: u64) -> Vec<ModelChoice> {
        match self.source {
            ModelSource::Generated => category_names()
                .into_iter()
                .flat_map(|category| {
                    (0..n_instances).map(move |index| ModelChoice::Generated {
                        category: category.to_owned(),
                        instance: seed.wrapping_mul(1_000_003).wrapping_add(index),
                    })
                })
                .collect(),
            ModelSource::Folder(_) => self.files.iter().cloned().map(ModelChoice::File).collect(),
        }
    }

    /// Chooses `n_models`, each category or file once before one comes twice.
    pub fn choose(&self, n_models: usize, seed: u64) -> Vec<ModelChoice> {
        match self.source {
            ModelSource::Generated => arrangement::choose(&category_names(), n_models, seed),
            ModelSource::Folder(_) => arrangement::choose_files(&self.files, n_models, seed),
        }
    }

    /// The model of a choice.
    ///
    /// # Errors
    /// When there is no such category or the file can not be used.
    pub fn load(&mut self, choice: &ModelChoice) -> Result<Arc<ObjectModel>, Error> {
        if let Some(model) = self.loaded(choice) {
            return Ok(model);
        }
        let model = Arc::new(make(choice, &mut self.notes)?);
        self.loaded.push((choice.clone(), Arc::clone(&model)));
        Ok(model)
    }

    /// The model of a choice, which is not kept.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub(crate) fn look_at(&self, choice: &ModelChoice) -> Result<Arc<ObjectModel>, Error> {
        match self.loaded(choice) {
            Some(model) => Ok(model),
            None => make(choice, &mut Vec::new()).map(Arc::new),
        }
    }

    fn loaded(&self, choice: &ModelChoice) -> Option<Arc<ObjectModel>> {
        let (_, model) = self.loaded.iter().find(|(known, _)| known == choice)?;
        Some(Arc::clone(model))
    }

    /// What was noticed about model files, one sentence each; given once.
    pub fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }
}

fn make(choice: &ModelChoice, notes: &mut Vec<String>) -> Result<ObjectModel, Error> {
    match choice {
        ModelChoice::Generated { category, instance } => {
            ObjectModel::generated(category, *instance)
        }
        ModelChoice::File(path) => model_file::open(path, notes),
    }
}

/// Names of the generated categories.
pub fn category_names() -> Vec<&'static str> {
    household::categories()
        .iter()
        .map(|category| category.name)
        .collect()
}
