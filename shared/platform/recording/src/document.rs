//! JSON documents with their schema: each type is defined once, with the description of every
//! field, and the schema in the file is derived from it.

use crate::Number;
use serde::Serialize;
use serde_json::{Map, Value, json};

/// Recorded message as a JSON document.
pub trait Document: Serialize {
    /// Name of the document's schema.
    const NAME: &'static str;

    /// JSON schema of the document.
    fn schema() -> Value;
}

/// Type of a document's field.
pub(crate) trait FieldType {
    /// JSON schema of the type, without a description.
    fn field_schema() -> Value;
}

macro_rules! field_types {
    ($($field:ty: $type:tt),*) => {$(
        impl FieldType for $field {
            fn field_schema() -> Value {
                json!({ "type": $type })
            }
        }
    )*};
}

field_types!(
    u32: "integer",
    u64: "integer",
    f32: ["number", "null"],
    f64: ["number", "null"],
    Number: ["number", "string"],
    bool: "boolean",
    String: "string"
);

impl<T: FieldType> FieldType for Vec<T> {
    fn field_schema() -> Value {
        json!({ "type": "array", "items": T::field_schema() })
    }
}

impl<T: FieldType, const N: usize> FieldType for [T; N] {
    fn field_schema() -> Value {
        json!({ "type": "array", "items": T::field_schema(), "minItems": N, "maxItems": N })
    }
}

/// JSON schema of an object with these fields: name, description and schema of each.
pub(crate) fn object_schema(title: &str, description: &str, fields: &[FieldSchema]) -> Value {
    let property = |field: &FieldSchema| {
        let mut schema = field.schema.clone();
        if let Value::Object(schema) = &mut schema {
            schema.insert("description".into(), field.description.trim().into());
        }
        (field.name.to_owned(), schema)
    };
    let properties: Map<String, Value> = fields.iter().map(property).collect();
    let required: Vec<&str> = fields.iter().map(|field| field.name).collect();
    json!({
        "title": title,
        "description": description.trim(),
        "type": "object",
        "properties": properties,
        "required": required,
    })
}

/// Name, description and JSON schema of a field.
pub(crate) struct FieldSchema {
    pub(crate) name: &'static str,
    pub(crate) description: &'static str,
    pub(crate) schema: Value,
}

/// Defines a document: a struct with one line of description for each field, its serialisation
/// and its schema. JSON has no NaN, so that a number of type `f32` or `f64` that is none becomes
/// `null`.
macro_rules! document {
    (
        #[doc = $doc:literal]
        $document:ident = $name:literal {
            $(#[doc = $field_doc:literal] $field:ident: $field_type:ty,)*
        }
    ) => {
        #[doc = $doc]
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
        pub struct $document {
            $(#[doc = $field_doc] pub $field: $field_type,)*
        }

        impl $crate::document::Document for $document {
            const NAME: &'static str = $name;

            fn schema() -> serde_json::Value {
                let fields = [$($crate::document::FieldSchema {
                    name: stringify!($field),
                    description: $field_doc,
                    schema: <$field_type as $crate::document::FieldType>::field_schema(),
                }),*];
                $crate::document::object_schema($name, $doc, &fields)
            }
        }

        impl $crate::document::FieldType for $document {
            fn field_schema() -> serde_json::Value {
                <Self as $crate::document::Document>::schema()
            }
        }
    };
}

pub(crate) use document;

#[cfg(test)]
mod tests {
    #![expect(unreachable_pub, reason = "the macro defines public types")]

    use super::*;

    document! {
        /// Thing of a test.
        Thing = "tabula.Thing" {
            /// Size, metres.
            size_m: [f64; 2],
            /// Names of the thing.
            names: Vec<String>,
        }
    }

    #[test]
    fn schema_describes_each_field() {
        let schema = Thing::schema();
        assert_eq!(schema["title"], "tabula.Thing");
        assert_eq!(
            schema["properties"]["size_m"]["description"],
            "Size, metres."
        );
        assert_eq!(schema["properties"]["size_m"]["maxItems"], 2);
        assert_eq!(schema["properties"]["names"]["items"]["type"], "string");
        assert_eq!(schema["required"], json!(["size_m", "names"]));
    }
}
