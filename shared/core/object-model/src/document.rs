//! Encoding of object models: CBOR (RFC 8949), a list of the version and a map.
//!
//! | key | content |
//! |---|---|
//! | `positions_m`, `normals` | bytes: x, y, z of each vertex as 32-bit floating-point numbers, little-endian |
//! | `colors` | bytes: red, green, blue of each vertex |
//! | `triangles` | bytes: three vertex indices of each triangle as 32-bit integers, little-endian |
//! | `views` | list of maps: `translation_m`, `rotation_xyzw` (object from camera), `captured_ns`, `n_points`, `new_surface_share` |
//! | `refused` | list of maps: `captured_ns`, `reason` |
//! | `is_closed_loop` | boolean |
//! | `n_directions` | 42 or 162, the directions of the sphere |
//! | `unseen` | bytes: x, y, z of each unseen direction, as positions |

use crate::direction_sphere::DirectionSphere;
use crate::error::Error;
use crate::model::{ModelMesh, ModelView, ObjectModel, RefusedView};
use crate::unseen_directions::UnseenDirections;
use geometry::RigidTransform;
use nalgebra::{Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use point_cloud::Vertex;
use serde::{Deserialize, Serialize};
use serde_bytes::ByteBuf;

/// Media type of an encoded object model.
pub const MEDIA_TYPE: &str = "application/vnd.tabula.object-model";

/// Version of the encoding.
pub const VERSION: u64 = 1;

/// First byte of a CBOR list of two items.
const LIST_OF_TWO: u8 = 0x82;
/// Distance within which a stored direction is one of the sphere's. Chosen: more than rounding,
/// far less than the distance of two of them, 0.26.
const DIRECTION_TOLERANCE: f32 = 1e-3;

#[derive(Serialize, Deserialize)]
struct ModelBody {
    positions_m: ByteBuf,
    normals: ByteBuf,
    colors: ByteBuf,
    triangles: ByteBuf,
    views: Vec<ViewBody>,
    refused: Vec<RefusedBody>,
    is_closed_loop: bool,
    n_directions: u32,
    unseen: ByteBuf,
}

#[derive(Serialize, Deserialize)]
struct ViewBody {
    translation_m: [f64; 3],
    rotation_xyzw: [f64; 4],
    captured_ns: u64,
    n_points: u32,
    new_surface_share: f32,
}

#[derive(Serialize, Deserialize)]
struct RefusedBody {
    captured_ns: u64,
    reason: String,
}

impl ObjectModel {
    /// Encodes the model.
    ///
    /// # Errors
    /// [`Error::Invalid`] when it has values that no model may have.
    pub fn to_bytes(&self) -> Result<Vec<u8>, Error> {
        self.check()?;
        let vertices = || self.mesh.vertices.iter();
        let floats = |vector: [f32; 3]| vector.map(f32::to_le_bytes);
        let unseen = self.unseen.directions().into_iter();
        let body = ModelBody {
            positions_m: joined(vertices().map(|vertex| floats(vertex.position.into()))),
            normals: joined(vertices().map(|vertex| floats(vertex.normal.into()))),
            colors: joined(vertices().map(|vertex| vertex.color.map(|value| [value]))),
            triangles: joined(
                self.mesh
                    .triangles
                    .iter()
                    .map(|corners| corners.map(u32::to_le_bytes)),
            ),
            views: self.views.iter().map(ViewBody::of).collect(),
            refused: self.refused.iter().map(RefusedBody::of).collect(),
            is_closed_loop: self.is_closed_loop,
            n_directions: self.unseen.sphere().n_directions() as u32,
            unseen: joined(unseen.map(|direction| floats(direction.into()))),
        };
        let mut bytes = Vec::new();
        let written = ciborium::into_writer(&(VERSION, body), &mut bytes);
        written.map_err(|_| Error::Invalid("it cannot be encoded".to_owned()))?;
        Ok(bytes)
    }

    /// Decodes a model and validates all of it.
    ///
    /// # Errors
    /// When the bytes are no model, are of another version, are cut or damaged, or have values that
    /// no model may have.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        let [LIST_OF_TWO, rest @ ..] = bytes else {
            return Err(Error::NotAModel);
        };
        let mut rest = rest;
        let version = ciborium::from_reader(&mut rest).map_err(|_| Error::NotAModel)?;
        if version != VERSION {
            return Err(Error::Version { found: version });
        }
        let body: ModelBody = ciborium::from_reader(&mut rest).map_err(|error| damaged(&error))?;
        if !rest.is_empty() {
            return Err(Error::Damaged("something follows its end"));
        }
        let model = Self {
            mesh: body.mesh()?,
            unseen: body.unseen()?,
            is_closed_loop: body.is_closed_loop,
            views: body.views.iter().map(ViewBody::view).collect(),
            refused: body.refused.into_iter().map(RefusedBody::view).collect(),
        };
        model.check()?;
        Ok(model)
    }
}

/// Error of the decoder without its own text, which may quote the bytes.
fn damaged(error: &ciborium::de::Error<std::io::Error>) -> Error {
    Error::Damaged(match error {
        ciborium::de::Error::Io(_) => "it ends too early",
        ciborium::de::Error::Syntax(_) => "it is no CBOR",
        ciborium::de::Error::Semantic(..) => "a part of it is missing, or of another type",
        ciborium::de::Error::RecursionLimitExceeded => "its parts are nested too deeply",
    })
}

fn joined<const N: usize>(items: impl Iterator<Item = [[u8; N]; 3]>) -> ByteBuf {
    ByteBuf::from(
        items
            .flat_map(|item| item.into_iter().flatten())
            .collect::<Vec<u8>>(),
    )
}

/// Triples of items of `N` bytes.
fn triples<'a, const N: usize, T>(
    bytes: &'a [u8],
    what: &'static str,
    value: impl Fn([u8; N]) -> T + Copy + 'a,
) -> Result<impl ExactSizeIterator<Item = [T; 3]> + 'a, Error> {
    let (items, rest) = bytes.as_chunks::<N>();
    let (triples, rest_of_items) = items.as_chunks::<3>();
    if rest.is_empty() && rest_of_items.is_empty() {
        return Ok(triples.iter().map(move |triple| triple.map(value)));
    }
    Err(Error::Damaged(what))
}

impl ModelBody {
    fn mesh(&self) -> Result<ModelMesh, Error> {
        const CUT: &str = "a vertex or triangle of it is cut";
        let positions = triples(&self.positions_m, CUT, f32::from_le_bytes)?;
        let normals = triples(&self.normals, CUT, f32::from_le_bytes)?;
        let colors = triples(&self.colors, CUT, |[value]: [u8; 1]| value)?;
        if positions.len() != normals.len() || positions.len() != colors.len() {
            return Err(Error::Damaged(
                "its positions, normals and colours are not of the same number",
            ));
        }
        let vertices = positions.zip(normals).zip(colors);
        Ok(ModelMesh {
            vertices: vertices
                .map(|((position, normal), color)| Vertex {
                    position: Point3::from(position),
                    normal: Vector3::from(normal),
                    color,
                })
                .collect(),
            triangles: triples(&self.triangles, CUT, u32::from_le_bytes)?.collect(),
        })
    }

    fn unseen(&self) -> Result<UnseenDirections, Error> {
        let sphere = DirectionSphere::with_directions(self.n_directions as usize);
        let sphere = sphere.ok_or_else(|| {
            let n_directions = self.n_directions;
            Error::Invalid(format!(
                "its sphere has {n_directions} directions, not 42 or 162"
            ))
        })?;
        let stored = triples(&self.unseen, "a direction of it is cut", f32::from_le_bytes)?;
        let n_stored = stored.len();
        if n_stored > sphere.n_directions() {
            return Err(Error::Invalid(
                "it lacks more directions than there are".into(),
            ));
        }
        let stored: Vec<_> = stored.map(Vector3::from).collect();
        let unseen = UnseenDirections::of(sphere, |direction| {
            let mut stored = stored.iter();
            stored.any(|stored| (stored - direction).norm() < DIRECTION_TOLERANCE)
        });
        // A direction that is not the sphere's, or is named twice, is one too many.
        if unseen.n_unseen() == n_stored {
            return Ok(unseen);
        }
        Err(Error::Invalid(
            "a direction that it lacks is not one of its sphere, or is named twice".into(),
        ))
    }
}

impl ViewBody {
    fn of(view: &ModelView) -> Self {
        let RigidTransform {
            rotation,
            translation,
        } = view.object_from_camera;
        Self {
            translation_m: translation.vector.into(),
            rotation_xyzw: rotation.coords.into(),
            captured_ns: view.captured_ns,
            n_points: view.n_points,
            new_surface_share: view.new_surface_share,
        }
    }

    /// The view as it was stored; its rotation is checked afterwards.
    fn view(&self) -> ModelView {
        let rotation = Quaternion::from(self.rotation_xyzw);
        ModelView {
            object_from_camera: RigidTransform::from_parts(
                Translation3::from(self.translation_m),
                UnitQuaternion::new_unchecked(rotation),
            ),
            captured_ns: self.captured_ns,
            n_points: self.n_points,
            new_surface_share: self.new_surface_share,
        }
    }
}

impl RefusedBody {
    fn of(view: &RefusedView) -> Self {
        Self {
            captured_ns: view.captured_ns,
            reason: view.reason.clone(),
        }
    }

    fn view(self) -> RefusedView {
        RefusedView {
            captured_ns: self.captured_ns,
            reason: self.reason,
        }
    }
}
