//! Decoder of PLY files.

use crate::NEUTRAL_GREY;
use crate::error::Error;
use crate::header::{Element, Header, PropertyKind};
use crate::value_reader::{BinaryValueReader, TextValueReader, ValueError, ValueReader};
use crate::{Encoding, MAX_TRIANGLES, MAX_VERTICES, Mesh};
use file_access::{ByteOrder, NumberType, as_u32, excerpt};
use point_cloud::{Point, Rgba};

/// Decodes a PLY file from its bytes.
///
/// *Allocation*: the vertices and triangles, never more of them than the bytes
/// can describe.
///
/// # Errors
/// When the bytes are not a PLY file this module reads; says where and why.
pub fn read(bytes: &[u8]) -> Result<Mesh, Error> {
    let header = Header::parse(bytes)?;
    let data = &bytes[header.data_offset..];
    let order = match header.encoding {
        Encoding::BinaryLittleEndian => ByteOrder::Little,
        Encoding::BinaryBigEndian => ByteOrder::Big,
        Encoding::Ascii => {
            let text = std::str::from_utf8(data)
                .map_err(|_| Error::Elements("its numbers should be text and are not"))?;
            return read_elements(&header, TextValueReader::new(text));
        }
    };
    read_elements(&header, BinaryValueReader { rest: data, order })
}

fn read_elements(header: &Header<'_>, mut values: impl ValueReader) -> Result<Mesh, Error> {
    let vertex = header
        .elements
        .iter()
        .find(|element| element.name == "vertex");
    let vertex = vertex.ok_or(Error::Elements("the element \"vertex\" is missing"))?;
    let columns = VertexColumns::find(vertex)?;
    if vertex.n_rows > MAX_VERTICES {
        return Err(Error::TooLarge);
    }
    let mut mesh = Mesh::default();
    for element in header
        .elements
        .iter()
        .filter(|element| !element.properties.is_empty())
    {
        if !values.can_hold_rows(element) {
            return Err(Error::Truncated {
                element: excerpt(element.name),
            });
        }
        match element.name {
            "vertex" => read_vertices(element, &columns, &mut values, &mut mesh.vertices)?,
            "face" => read_faces(element, vertex.n_rows, &mut values, &mut mesh.triangles)?,
            _ => skip_rows(element, &mut values)?,
        }
    }
    if values.at_end() {
        Ok(mesh)
    } else {
        Err(Error::TrailingData)
    }
}

/// Column indices of a vertex's coordinates and colour.
struct VertexColumns {
    xyz: [usize; 3],
    rgb: Option<[usize; 3]>,
}

impl VertexColumns {
    fn find(vertex: &Element<'_>) -> Result<Self, Error> {
        let position = |wanted: &str| vertex.properties.iter().position(|p| p.name == wanted);
        let has = |idx: usize, allowed: &[NumberType]| match vertex.properties[idx].kind {
            PropertyKind::Number(number) => allowed.contains(&number),
            PropertyKind::List { .. } => false,
        };
        let (Some(x), Some(y), Some(z)) = (position("x"), position("y"), position("z")) else {
            return Err(Error::Elements("a vertex needs the properties x, y and z"));
        };
        if ![x, y, z]
            .iter()
            .all(|&idx| has(idx, &[NumberType::F32, NumberType::F64]))
        {
            return Err(Error::Elements("x, y and z must be float or double"));
        }
        let rgb = match (position("red"), position("green"), position("blue")) {
            (Some(red), Some(green), Some(blue)) => Some([red, green, blue]),
            (None, None, None) => None,
            _ => return Err(Error::Elements("a colour needs red, green and blue")),
        };
        if rgb.is_some_and(|rgb| !rgb.iter().all(|&idx| has(idx, &[NumberType::U8]))) {
            return Err(Error::Elements("red, green and blue must be uchar"));
        }
        Ok(Self {
            xyz: [x, y, z],
            rgb,
        })
    }

    fn point(&self, row: &[f64]) -> Option<Point> {
        let [x, y, z] = self.xyz.map(|idx| row[idx] as f32);
        let color = self.rgb.map_or(NEUTRAL_GREY, |rgb| {
            let [red, green, blue] = rgb.map(|idx| row[idx] as u8);
            Rgba::opaque(red, green, blue)
        });
        Some(Point { x, y, z, color }).filter(Point::is_finite)
    }
}

fn read_vertices(
    element: &Element<'_>,
    columns: &VertexColumns,
    values: &mut impl ValueReader,
    vertices: &mut Vec<Point>,
) -> Result<(), Error> {
    vertices.reserve_exact(element.n_rows);
    let mut row = vec![0.0; element.properties.len()];
    for_each_row(element, values, |values| {
        for (property, value) in element.properties.iter().zip(&mut row) {
            match property.kind {
                PropertyKind::Number(number) => *value = values.next(number)?,
                PropertyKind::List { count, item } => skip_list(values, count, item)?,
            }
        }
        let point = columns.point(&row);
        vertices.push(point.ok_or(ValueError::Wrong("a coordinate is not finite".to_owned()))?);
        Ok(())
    })
}

fn read_faces(
    element: &Element<'_>,
    n_vertices: usize,
    values: &mut impl ValueReader,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), Error> {
    let is_polygon = |name: &str| matches!(name, "vertex_indices" | "vertex_index");
    let mut polygons = element
        .properties
        .iter()
        .filter(|property| is_polygon(property.name));
    let (Some(PropertyKind::List { .. }), None) =
        (polygons.next().map(|p| p.kind), polygons.next())
    else {
        return Err(Error::Elements(
            "a face needs one list vertex_indices or vertex_index",
        ));
    };
    for_each_row(element, values, |values| {
        for property in &element.properties {
            match property.kind {
                PropertyKind::Number(number) => {
                    values.next(number)?;
                }
                PropertyKind::List { count, item } if is_polygon(property.name) => {
                    read_polygon(values, [count, item], n_vertices, triangles)?;
                }
                PropertyKind::List { count, item } => skip_list(values, count, item)?,
            }
        }
        Ok(())
    })
}

/// Splits a polygon into a triangle fan around its first vertex.
fn read_polygon(
    values: &mut impl ValueReader,
    [count, item]: [NumberType; 2],
    n_vertices: usize,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), ValueError> {
    let n_corners = list_length(values, count)?;
    if n_corners < 3 {
        return Err(ValueError::Wrong(
            "a polygon needs at least three vertices".to_owned(),
        ));
    }
    let mut corner = || {
        let value = values.next(item)?;
        let known = as_u32(value).filter(|&index| (index as usize) < n_vertices);
        known.ok_or_else(|| ValueError::Wrong(format!("there is no vertex {value}")))
    };
    let (first, mut previous) = (corner()?, corner()?);
    for _ in 2..n_corners {
        let current = corner()?;
        if triangles.len() == MAX_TRIANGLES {
            return Err(ValueError::Wrong(format!(
                "there are more than {MAX_TRIANGLES} triangles"
            )));
        }
        triangles.push([first, previous, current]);
        previous = current;
    }
    Ok(())
}

fn skip_rows(element: &Element<'_>, values: &mut impl ValueReader) -> Result<(), Error> {
    for_each_row(element, values, |values| {
        for property in &element.properties {
            match property.kind {
                PropertyKind::Number(number) => {
                    values.next(number)?;
                }
                PropertyKind::List { count, item } => skip_list(values, count, item)?,
            }
        }
        Ok(())
    })
}

fn skip_list(
    values: &mut impl ValueReader,
    count: NumberType,
    item: NumberType,
) -> Result<(), ValueError> {
    for _ in 0..list_length(values, count)? {
        values.next(item)?;
    }
    Ok(())
}

fn list_length(values: &mut impl ValueReader, count: NumberType) -> Result<u32, ValueError> {
    let value = values.next(count)?;
    as_u32(value).ok_or_else(|| ValueError::Wrong(format!("a list cannot have {value} entries")))
}

/// Reads all rows of an element; an error names the row.
fn for_each_row<V: ValueReader>(
    element: &Element<'_>,
    values: &mut V,
    mut read_row: impl FnMut(&mut V) -> Result<(), ValueError>,
) -> Result<(), Error> {
    for row in 0..element.n_rows {
        values
            .begin_row()
            .and_then(|()| read_row(values))
            .and_then(|()| values.end_row())
            .map_err(|error| match error {
                ValueError::EndOfFile => Error::Truncated {
                    element: excerpt(element.name),
                },
                ValueError::Wrong(problem) => Error::Row {
                    element: excerpt(element.name),
                    row,
                    problem,
                },
            })?;
    }
    Ok(())
}
