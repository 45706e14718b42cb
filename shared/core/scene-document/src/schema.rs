//! JSON Schema of the documents, generated from their types.

use crate::{
    CategoryDocument, EventDocument, FactDocument, HealthDocument, ModelDocument, ObjectDocument,
    SceneDocument, TaskDocument, WorldDocument,
};
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::Serialize;

/// Document with a name, under which its schema is known to readers.
pub trait Document: Serialize + JsonSchema {
    /// Name of the schema.
    const NAME: &'static str;
}

macro_rules! documents {
    ($($document:ty: $name:literal),* $(,)?) => {$(
        impl Document for $document {
            const NAME: &'static str = $name;
        }
    )*};
}

documents! {
    CategoryDocument: "tabula.Category",
    EventDocument: "tabula.Event",
    FactDocument: "tabula.Fact",
    HealthDocument: "tabula.Health",
    ModelDocument: "tabula.Model",
    ObjectDocument: "tabula.Object",
    SceneDocument: "tabula.Scene",
    TaskDocument: "tabula.Task",
    WorldDocument: "tabula.World",
}

/// JSON Schema (draft 2020-12) of a document, without references, as many readers need it.
pub fn schema<T: Document>() -> Schema {
    let settings =
        SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<T>();
    schema.insert("title".to_owned(), T::NAME.into());
    schema
}
