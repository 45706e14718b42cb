//! Decoder of OBJ files.

use super::lines::{Line, lines};
use super::materials::{Materials, byte};
use super::vertex_colors::{MaterialRun, assign_vertex_colors};
use super::{Error, MAX_TRIANGLES, MAX_VERTICES, Mesh};
use crate::NEUTRAL_GREY;
use crate::number_type::excerpt;
use point_cloud::{Point, Rgba};

/// Decodes an OBJ file from its bytes, with the colours of the given materials.
///
/// *Allocation*: the vertices and triangles; less than 64 bytes for each byte
/// of the file.
///
/// # Errors
/// When there is no vertex, or a line is wrong; says which and why.
pub fn read(bytes: &[u8], materials: &Materials) -> Result<Mesh, Error> {
    let mut reader = Reader::default();
    reader.runs.push(MaterialRun {
        first_triangle: 0,
        color: NEUTRAL_GREY,
    });
    for line in lines(bytes) {
        match line.keyword {
            b"v" => reader.push_vertex(&line)?,
            b"f" => reader.push_face(&line)?,
            b"usemtl" => reader.runs.push(MaterialRun {
                first_triangle: reader.mesh.triangles.len(),
                color: materials.color(line.text()?).unwrap_or(NEUTRAL_GREY),
            }),
            _ => {}
        }
    }
    reader.finish()
}

#[derive(Default)]
struct Reader {
    mesh: Mesh,
    has_own_color: Vec<bool>,
    runs: Vec<MaterialRun>,
    /// Highest vertex index of a face, and its line.
    highest: Option<(u32, usize)>,
}

impl Reader {
    fn push_vertex(&mut self, line: &Line<'_>) -> Result<(), Error> {
        if self.mesh.vertices.len() == MAX_VERTICES {
            return Err(Error::TooLarge);
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

    /// Splits a polygon into a triangle fan around its first vertex.
    fn push_face(&mut self, line: &Line<'_>) -> Result<(), Error> {
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
                return Err(Error::TooLarge);
            }
            let triangle = [first, previous, current];
            let highest = triangle.into_iter().max().unwrap_or_default();
            if self.highest.is_none_or(|(index, _)| index < highest) {
                self.highest = Some((highest, line.number));
            }
            self.mesh.triangles.push(triangle);
            previous = current;
            let Some(word) = words.next() else {
                return Ok(());
            };
            current = self.corner(word, line)?;
        }
    }

    /// Vertex index of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`. It may refer to a later vertex.
    fn corner(&self, word: &str, line: &Line<'_>) -> Result<u32, Error> {
        let n_vertices = self.mesh.vertices.len() as i64;
        let number = word.split_once('/').map_or(word, |(number, _)| number);
        let index = match number.parse::<i64>() {
            Ok(number @ 1..) => number - 1,
            Ok(number) if number < 0 => n_vertices.saturating_add(number),
            _ => {
                let problem = format!("\"{}\" is not a corner of a face", excerpt(word));
                return Err(line.error(problem));
            }
        };
        let known = u32::try_from(index).ok();
        known
            .filter(|&index| (index as usize) < MAX_VERTICES)
            .ok_or_else(|| line.error(format!("there is no vertex {number}")))
    }

    fn finish(mut self) -> Result<Mesh, Error> {
        let n_vertices = self.mesh.vertices.len();
        if n_vertices == 0 {
            return Err(Error::NoVertices);
        }
        if let Some((index, line)) = self.highest
            && index as usize >= n_vertices
        {
            let problem = format!("there is no vertex {}", index + 1);
            return Err(Error::Line { line, problem });
        }
        assign_vertex_colors(&mut self.mesh, &self.has_own_color, &self.runs)?;
        Ok(self.mesh)
    }
}
