//! Encoder (writer) of PLY files.

use crate::error::Error;
use crate::{Encoding, MAX_TRIANGLES, MAX_VERTICES, MeshView};
use point_cloud::Point;

/// Encodes a PLY file of version 1.0 with the vertex properties `x y z red green blue` and,
/// with triangles, faces. Decoding gives the same mesh in every encoding, except for alpha
/// values.
///
/// # Errors
/// When a coordinate is not finite, a triangle names a vertex that is not
/// there, or the mesh exceeds the reading limits.
pub fn write(mesh: MeshView<'_>, encoding: Encoding) -> Result<Vec<u8>, Error> {
    check(mesh)?;
    let mut file = header(mesh, encoding).into_bytes();
    for vertex in mesh.vertices {
        let (xyz, [red, green, blue]) = ([vertex.x, vertex.y, vertex.z], vertex.color.rgb());
        match encoding {
            Encoding::Ascii => {
                let [x, y, z] = xyz;
                file.extend(format!("{x} {y} {z} {red} {green} {blue}\n").into_bytes());
            }
            Encoding::BinaryLittleEndian => file.extend(xyz.map(f32::to_le_bytes).as_flattened()),
            Encoding::BinaryBigEndian => file.extend(xyz.map(f32::to_be_bytes).as_flattened()),
        }
        if encoding != Encoding::Ascii {
            file.extend([red, green, blue]);
        }
    }
    for triangle in mesh.triangles {
        write_triangle(*triangle, encoding, &mut file);
    }
    Ok(file)
}

fn check(mesh: MeshView<'_>) -> Result<(), Error> {
    if mesh.vertices.len() > MAX_VERTICES || mesh.triangles.len() > MAX_TRIANGLES {
        return Err(Error::TooLarge);
    }
    if !mesh.vertices.iter().all(Point::is_finite) {
        return Err(Error::Elements("a coordinate is not finite"));
    }
    let is_there = |&index: &u32| (index as usize) < mesh.vertices.len();
    if !mesh.triangles.as_flattened().iter().all(is_there) {
        return Err(Error::Elements(
            "a triangle names a vertex that is not there",
        ));
    }
    Ok(())
}

fn header(mesh: MeshView<'_>, encoding: Encoding) -> String {
    let encoding = match encoding {
        Encoding::Ascii => "ascii",
        Encoding::BinaryLittleEndian => "binary_little_endian",
        Encoding::BinaryBigEndian => "binary_big_endian",
    };
    let faces = match mesh.triangles.len() {
        0 => String::new(),
        n => format!("element face {n}\nproperty list uchar int vertex_indices\n"),
    };
    format!(
        "ply\nformat {encoding} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
         {faces}end_header\n",
        mesh.vertices.len()
    )
}

fn write_triangle(triangle: [u32; 3], encoding: Encoding, file: &mut Vec<u8>) {
    let [a, b, c] = triangle;
    match encoding {
        Encoding::Ascii => file.extend(format!("3 {a} {b} {c}\n").into_bytes()),
        Encoding::BinaryLittleEndian => {
            file.push(3);
            file.extend(triangle.map(u32::to_le_bytes).as_flattened());
        }
        Encoding::BinaryBigEndian => {
            file.push(3);
            file.extend(triangle.map(u32::to_be_bytes).as_flattened());
        }
    }
}
