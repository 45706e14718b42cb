//! Cached library of object models.

use crate::error::Error;
use crate::model_choice::{ModelChoice, ModelSource};
use crate::model_import::ModelImport;
use crate::object_model::ObjectModel;
use crate::{arrangement, model_file};
use std::path::PathBuf;
use std::sync::Arc;

/// Categories that only crowded tables and scene files use, so that the other kinds draw the same
/// models from a seed as without them.
const CLUTTER_CATEGORIES: [&str; 4] = ["carton", "magazine", "cookie-tin", "open-box"];

/// Library of the models of a scene and those that a person could bring.
#[derive(Debug, Clone)]
pub struct ModelLibrary {
    source: ModelSource,
    /// Model files of the library's folder.
    files: Arc<[PathBuf]>,
    import: ModelImport,
    cache: Vec<(ModelChoice, Arc<ObjectModel>)>,
    notes: Vec<String>,
}

impl ModelLibrary {
    /// Library of the generated household objects.
    pub fn generated() -> Self {
        Self {
            source: ModelSource::Generated,
            files: Arc::new([]),
            import: ModelImport::default(),
            cache: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Opens the library of a model source.
    ///
    /// # Errors
    /// [`Error::Unreadable`] for a folder that cannot be read or has no models.
    pub fn open(source: &ModelSource) -> Result<Self, Error> {
        let mut library = Self::generated();
        if let ModelSource::Folder(folder) = source {
            library.files = model_file::list(folder)?.into();
            library.source = source.clone();
            library.notes.extend(model_file::unread_note(folder)?);
        }
        Ok(library)
    }

    /// Library that imports its files with these settings.
    #[must_use]
    pub fn with_import(mut self, import: ModelImport) -> Self {
        self.import = import;
        self
    }

    /// Source of the models.
    pub fn source(&self) -> &ModelSource {
        &self.source
    }

    /// All models: `n_instances` of each generated category, which depend on the seed, or every
    /// file of a folder.
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

    /// Chooses `n_models` at random, each category or file once before any is repeated.
    pub fn choose(&self, n_models: usize, seed: u64) -> Vec<ModelChoice> {
        match self.source {
            ModelSource::Generated => arrangement::choose(&drawn_category_names(), n_models, seed),
            ModelSource::Folder(_) => arrangement::choose_files(&self.files, n_models, seed),
        }
    }

    /// Loads a model and caches it.
    ///
    /// # Errors
    /// [`Error::UnknownCategory`], or an error of an unusable file.
    pub fn load(&mut self, choice: &ModelChoice) -> Result<Arc<ObjectModel>, Error> {
        if let Some(model) = self.cached(choice) {
            return Ok(model);
        }
        let model = Arc::new(load_model(choice, self.import, &mut self.notes)?);
        self.cache.push((choice.clone(), Arc::clone(&model)));
        Ok(model)
    }

    /// Loads a model, from the cache if it is there, without adding it to the cache.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub(crate) fn load_uncached(&self, choice: &ModelChoice) -> Result<Arc<ObjectModel>, Error> {
        match self.cached(choice) {
            Some(model) => Ok(model),
            None => load_model(choice, self.import, &mut Vec::new()).map(Arc::new),
        }
    }

    fn cached(&self, choice: &ModelChoice) -> Option<Arc<ObjectModel>> {
        let (_, model) = self.cache.iter().find(|(known, _)| known == choice)?;
        Some(Arc::clone(model))
    }

    /// Takes the accumulated notes about model files, one sentence each.
    pub fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }
}

fn load_model(
    choice: &ModelChoice,
    import: ModelImport,
    notes: &mut Vec<String>,
) -> Result<ObjectModel, Error> {
    match choice {
        ModelChoice::Generated { category, instance } => {
            ObjectModel::generated(category, *instance)
        }
        ModelChoice::File(path) => model_file::open(path, import, notes),
    }
}

/// Names of the categories of randomly chosen models.
fn drawn_category_names() -> Vec<&'static str> {
    let mut names = category_names();
    names.retain(|name| !CLUTTER_CATEGORIES.contains(name));
    names
}

/// Names of the generated categories.
pub fn category_names() -> Vec<&'static str> {
    household::categories()
        .iter()
        .map(|category| category.name)
        .collect()
}
