//! Decoder of OBJ files.

use super::lines::{Line, lines};
use super::materials::{Materials, byte};
use super::vertex_colors::{MaterialRun, assign_vertex_colors};
use super::{MAX_TRIANGLES, MAX_VERTICES, Mesh};
use crate::ModelError;
use crate::NEUTRAL_GREY;
use crate::textured_mesh::{FaceTexture, TexturedMesh};
use file_access::excerpt;
use point_cloud::{Point, Rgba};

/// Number of the texture coordinates of a corner that has none.
const NO_COORDINATES: u32 = u32::MAX;

/// Decodes an OBJ file from its bytes, with the colours of the given materials, without textures.
///
/// *Allocation*: the vertices and triangles; less than 64 bytes for each byte
/// of the file.
///
/// # Errors
/// When there is no vertex, or a line is wrong; says which and why.
pub fn read(bytes: &[u8], materials: &Materials) -> Result<Mesh, ModelError> {
    Ok(read_textured(bytes, materials)?.mesh)
}

/// Decodes an OBJ file as [`read`], with the places of its faces in the textures.
pub(super) fn read_textured(
    bytes: &[u8],
    materials: &Materials,
) -> Result<TexturedMesh, ModelError> {
    let mut reader = Reader::default();
    reader.runs.push(MaterialRun {
        first_triangle: 0,
        color: NEUTRAL_GREY,
        texture: None,
    });
    for line in lines(bytes) {
        match line.keyword {
            b"v" => reader.push_vertex(&line)?,
            b"vt" => reader.push_coordinates(&line)?,
            b"f" => reader.push_face(&line)?,
            b"usemtl" => {
                let material = line.text()?;
                reader.runs.push(MaterialRun {
                    first_triangle: reader.mesh.triangles.len(),
                    color: materials.color(material).unwrap_or(NEUTRAL_GREY),
                    texture: materials.texture(material),
                });
            }
            _ => {}
        }
    }
    reader.finish()
}

/// Corner of a face: numbers of its vertex and of its texture coordinates.
#[derive(Clone, Copy)]
struct Corner {
    vertex: u32,
    coordinates: u32,
}

#[derive(Default)]
struct Reader {
    mesh: Mesh,
    has_own_color: Vec<bool>,
    runs: Vec<MaterialRun>,
    /// Texture coordinates; NaN for those of a line that is wrong.
    coordinates: Vec<[f32; 2]>,
    /// Numbers of the texture coordinates of each triangle's corners.
    corner_coordinates: Vec<[u32; 3]>,
    /// Highest vertex index of a face, and its line.
    highest: Option<(u32, usize)>,
}

impl Reader {
    fn push_vertex(&mut self, line: &Line<'_>) -> Result<(), ModelError> {
        if self.mesh.vertices.len() == MAX_VERTICES {
            return Err(ModelError::TooLarge("OBJ"));
        }
        // x y z, x y z w, x y z r g b or x y z r g b a.
        let mut numbers = [0.0; 7];
        let n_numbers = line.numbers(&mut numbers)?;
        let [x, y, z, rgb @ .., _] = numbers;
        let color = match n_numbers {
            3 | 4 => None,
            6 | 7 if rgb.iter().all(|value| (0.0..=1.0).contains(value)) => {
                let [red, green, blue] = rgb.map(byte);
                Some(Rgba::opaque(red, green, blue))
            }
            6 | 7 => return Err(line.error("a colour goes from 0 to 1".to_owned())),
            _ => return Err(line.error("a vertex is x y z, also with w or r g b".to_owned())),
        };
        self.has_own_color.push(color.is_some());
        let color = color.unwrap_or(NEUTRAL_GREY);
        self.mesh.vertices.push(Point { x, y, z, color });
        Ok(())
    }

    /// Reads texture coordinates. Some programs write "nan" where a face has no texture, and only
    /// the texture needs them.
    fn push_coordinates(&mut self, line: &Line<'_>) -> Result<(), ModelError> {
        if self.coordinates.len() == MAX_VERTICES {
            return Err(ModelError::TooLarge("OBJ"));
        }
        let mut numbers = [0.0; 3];
        let coordinates = match line.numbers(&mut numbers) {
            Ok(1..) => [numbers[0], numbers[1]],
            _ => [f32::NAN; 2],
        };
        self.coordinates.push(coordinates);
        Ok(())
    }

    /// Splits a polygon into a triangle fan around its first vertex.
    fn push_face(&mut self, line: &Line<'_>) -> Result<(), ModelError> {
        let mut words = line.words()?;
        let too_few = || line.error("a face needs at least three corners".to_owned());
        let mut corner = || match words.next() {
            Some(word) => self.corner(word, line).map(Some),
            None => Ok(None),
        };
        let (Some(first), Some(mut previous), Some(mut current)) =
            (corner()?, corner()?, corner()?)
        else {
            return Err(too_few());
        };
        loop {
            if self.mesh.triangles.len() == MAX_TRIANGLES {
                return Err(ModelError::TooLarge("OBJ"));
            }
            let corners: [Corner; 3] = [first, previous, current];
            let triangle = corners.map(|corner| corner.vertex);
            let highest = triangle.into_iter().max().unwrap_or_default();
            if self.highest.is_none_or(|(index, _)| index < highest) {
                self.highest = Some((highest, line.number));
            }
            self.mesh.triangles.push(triangle);
            let coordinates = corners.map(|corner| corner.coordinates);
            self.corner_coordinates.push(coordinates);
            previous = current;
            let Some(word) = words.next() else {
                return Ok(());
            };
            current = self.corner(word, line)?;
        }
    }

    /// Corner `v`, `v/vt`, `v//vn` or `v/vt/vn`. It may refer to a later vertex.
    fn corner(&self, word: &str, line: &Line<'_>) -> Result<Corner, ModelError> {
        let n_vertices = self.mesh.vertices.len() as i64;
        let mut numbers = word.split('/');
        let number = numbers.next().unwrap_or_default();
        let index = match number.parse::<i64>() {
            Ok(number @ 1..) => number - 1,
            Ok(number) if number < 0 => n_vertices.saturating_add(number),
            _ => {
                let problem = format!("\"{}\" is not a corner of a face", excerpt(word));
                return Err(line.error(problem));
            }
        };
        let known = u32::try_from(index).ok();
        let vertex = known
            .filter(|&index| (index as usize) < MAX_VERTICES)
            .ok_or_else(|| line.error(format!("there is no vertex {number}")))?;
        let n_coordinates = self.coordinates.len() as i64;
        let coordinates = match numbers.next().unwrap_or_default().parse::<i64>() {
            Ok(number @ 1..) => Some(number - 1),
            Ok(number) if number < 0 => Some(n_coordinates.saturating_add(number)),
            _ => None,
        };
        let coordinates = coordinates.and_then(|index| u32::try_from(index).ok());
        Ok(Corner {
            vertex,
            coordinates: coordinates.unwrap_or(NO_COORDINATES),
        })
    }

    /// Place of each triangle in the texture of its material.
    fn face_textures(&self) -> Vec<Option<FaceTexture>> {
        if self.runs.iter().all(|run| run.texture.is_none()) {
            return Vec::new();
        }
        let mut faces = Vec::with_capacity(self.corner_coordinates.len());
        let ends = self.runs.iter().skip(1).map(|run| run.first_triangle);
        let at = |number: u32| {
            let uv = self.coordinates.get(number as usize).copied()?;
            uv.iter().all(|x| x.is_finite()).then_some(uv)
        };
        for (run, end) in self.runs.iter().zip(ends.chain([usize::MAX])) {
            let end = end.min(self.corner_coordinates.len());
            let corners = self.corner_coordinates[run.first_triangle..end].iter();
            faces.extend(corners.map(|&[a, b, c]| {
                let texture = run.texture?;
                let uv = [at(a)?, at(b)?, at(c)?];
                Some(FaceTexture { texture, uv })
            }));
        }
        faces
    }

    fn finish(mut self) -> Result<TexturedMesh, ModelError> {
        let n_vertices = self.mesh.vertices.len();
        if n_vertices == 0 {
            return Err(ModelError::NoVertices);
        }
        if let Some((index, line)) = self.highest
            && index as usize >= n_vertices
        {
            let problem = format!("there is no vertex {}", index + 1);
            return Err(ModelError::Line {
                format: "OBJ",
                line,
                problem,
            });
        }
        assign_vertex_colors(&mut self.mesh, &self.has_own_color, &self.runs)?;
        Ok(TexturedMesh {
            faces: self.face_textures(),
            mesh: self.mesh,
        })
    }
}
