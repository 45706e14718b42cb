//! Decoder of STL files.

use super::{MAX_TRIANGLES, MAX_VERTICES, Mesh};
use crate::ModelError;
use crate::NEUTRAL_GREY;
use file_access::excerpt;
use point_cloud::Point;
use std::collections::HashMap;

/// Size of the header of a binary file with the number of triangles, bytes.
const HEADER_BYTES: usize = 84;

/// Size of a triangle of a binary file: normal, three corners, attribute; bytes.
const TRIANGLE_BYTES: usize = 50;

/// Decodes an STL file from its bytes, binary or text.
///
/// A file is binary when its size is that of the triangles in its header:
/// headers of binary files may begin with "solid", too.
///
/// *Allocation*: the vertices and triangles, and a table of the vertices; less
/// than 16 bytes for each byte of the file.
///
/// # Errors
/// When the bytes are not an STL file; says where and why.
pub fn read(bytes: &[u8]) -> Result<Mesh, ModelError> {
    let is_text = bytes.trim_ascii_start().starts_with(b"solid");
    let Some((header, triangles)) = bytes.split_at_checked(HEADER_BYTES) else {
        return if is_text {
            read_text(bytes)
        } else {
            Err(ModelError::NotStl)
        };
    };
    let announced = header.last_chunk().map_or(0, |n| u32::from_le_bytes(*n));
    let (records, rest) = triangles.as_chunks::<TRIANGLE_BYTES>();
    let is_whole = records.len() == announced as usize && rest.is_empty();
    if is_text && !is_whole {
        return read_text(bytes);
    }
    if records.len() < announced as usize {
        return Err(ModelError::Truncated {
            announced,
            present: records.len(),
        });
    }
    if is_whole {
        read_binary(records)
    } else {
        Err(ModelError::TrailingData)
    }
}

fn read_binary(records: &[[u8; TRIANGLE_BYTES]]) -> Result<Mesh, ModelError> {
    let mut soup = WeldedSoup::default();
    for (triangle, record) in records.iter().enumerate() {
        let (numbers, _attribute) = record.as_chunks::<4>();
        // The first three numbers are the normal.
        let mut coordinates = [0.0; 9];
        for (coordinate, number) in coordinates.iter_mut().zip(&numbers[3..]) {
            *coordinate = f32::from_le_bytes(*number);
        }
        if !coordinates.iter().all(|value| value.is_finite()) {
            return Err(ModelError::NotFinite { triangle });
        }
        let (corners, _) = coordinates.as_chunks::<3>();
        soup.push_triangle([corners[0], corners[1], corners[2]])?;
    }
    Ok(soup.mesh)
}

fn read_text(bytes: &[u8]) -> Result<Mesh, ModelError> {
    let mut soup = WeldedSoup::default();
    let mut corners = Vec::with_capacity(3);
    let mut is_open = false;
    for (index, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let wrong = |problem: String| ModelError::Line {
            format: "STL",
            line: index + 1,
            problem,
        };
        let line = line.trim_ascii();
        let end = line.iter().position(u8::is_ascii_whitespace);
        let (keyword, rest) = line.split_at(end.unwrap_or(line.len()));
        match keyword.to_ascii_lowercase().as_slice() {
            b"solid" => is_open = true,
            b"endsolid" if corners.is_empty() => is_open = false,
            b"" | b"facet" | b"outer" | b"endfacet" if corners.is_empty() => {}
            b"vertex" if is_open && corners.len() < 3 => {
                corners.push(position(rest).map_err(wrong)?);
            }
            b"endloop" => {
                let triangle = <[[f32; 3]; 3]>::try_from(corners.as_slice())
                    .map_err(|_| wrong("a facet has three vertices".to_owned()))?;
                soup.push_triangle(triangle)?;
                corners.clear();
            }
            b"" => {}
            other => {
                let word = excerpt(&String::from_utf8_lossy(other));
                return Err(wrong(format!("\"{word}\" is not expected here")));
            }
        }
    }
    if is_open {
        Err(ModelError::EndOfText)
    } else {
        Ok(soup.mesh)
    }
}

/// Parses the three coordinates of a vertex.
fn position(text: &[u8]) -> Result<[f32; 3], String> {
    let text = std::str::from_utf8(text).map_err(|_| "it is not UTF-8 text".to_owned())?;
    let mut position = [0.0; 3];
    let mut words = text.split_ascii_whitespace();
    for coordinate in &mut position {
        let word = words.next().unwrap_or_default();
        *coordinate = match word.parse() {
            Ok(value) if f32::is_finite(value) => value,
            _ => return Err(format!("\"{}\" is not a finite number", excerpt(word))),
        };
    }
    match words.next() {
        None => Ok(position),
        Some(_) => Err("a vertex has three numbers".to_owned()),
    }
}

/// Triangle soup whose equal corners are welded.
#[derive(Default)]
struct WeldedSoup {
    mesh: Mesh,
    known: HashMap<[u32; 3], u32>,
}

impl WeldedSoup {
    fn push_triangle(&mut self, corners: [[f32; 3]; 3]) -> Result<(), ModelError> {
        if self.mesh.triangles.len() == MAX_TRIANGLES {
            return Err(ModelError::TooLarge("STL"));
        }
        let Self { mesh, known } = self;
        let triangle = corners.map(|[x, y, z]| {
            // Adding zero makes negative zero positive.
            let key = [x, y, z].map(|value| (value + 0.0).to_bits());
            *known.entry(key).or_insert_with(|| {
                let color = NEUTRAL_GREY;
                mesh.vertices.push(Point { x, y, z, color });
                mesh.vertices.len() as u32 - 1
            })
        });
        mesh.triangles.push(triangle);
        if mesh.vertices.len() > MAX_VERTICES {
            return Err(ModelError::TooLarge("STL"));
        }
        Ok(())
    }
}
