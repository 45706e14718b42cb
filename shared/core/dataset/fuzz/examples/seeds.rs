//! Seed corpus for the fuzzer: small valid files of each format.

use dataset::{pcd, ply};
use geometry::RigidTransform;
use point_cloud::{Point, Rgba};
use std::error::Error;
use std::path::{Path, PathBuf};

#[path = "../../src/rgbd_sequence/test_flat_jpeg.rs"]
mod test_flat_jpeg;

/// COLLADA document with a square that nodes place.
const SQUARE: &str = include_str!("../../src/dae/test_square.dae");

fn main() -> Result<(), Box<dyn Error>> {
    let corpus = std::env::args_os()
        .nth(1)
        .map_or_else(|| "corpus".into(), PathBuf::from);
    for target in [
        "pcd",
        "ply",
        "obj",
        "stl",
        "dae",
        "rgbd_sequence",
        "fakenect_index",
        "washington",
    ] {
        std::fs::create_dir_all(corpus.join(target))?;
    }
    let points: Vec<Point> = (0..12_u8)
        .map(|idx| Point {
            x: 0.25,
            y: f32::from(idx),
            z: 1.5,
            color: Rgba::opaque(idx, 2, 3),
        })
        .collect();
    write_clouds(&corpus.join("pcd"), &points)?;
    write_meshes(&corpus.join("ply"), &points)?;
    let index = "a-1290000000.000000-7.dump\nd-1290000000.033000-9.pgm\nr-1290000000.05-9.ppm\n";
    std::fs::write(corpus.join("fakenect_index/recorded"), index)?;
    let model = "mtllib a.mtl\nv 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1\nvt 0 0\nusemtl a\n\
        f 1/1 2//1 -1\nusemtl b\nf 1 2 \\\n3 2\n\0newmtl a\nKd 1 0 0\nmap_Kd -s 1 1 a.png\nnewmtl b\nKd 0.5\n";
    std::fs::write(corpus.join("obj/triangles"), model)?;
    write_triangles(&corpus.join("stl"))?;
    std::fs::write(corpus.join("dae/square"), SQUARE)?;
    write_matrices(&corpus.join("rgbd_sequence"))?;
    write_images(&corpus.join("rgbd_sequence"))?;
    write_views(&corpus.join("washington"), &points)
}

/// Writes a labelled cloud in each PCD encoding.
fn write_clouds(folder: &Path, points: &[Point]) -> Result<(), Box<dyn Error>> {
    use pcd::Encoding::{Ascii, Binary, BinaryCompressed};
    let labels: Vec<u32> = (0..points.len() as u32).collect();
    let viewpoint = RigidTransform::translation(1.0, 2.0, 3.0);
    for (name, encoding) in [
        ("ascii", Ascii),
        ("binary", Binary),
        ("packed", BinaryCompressed),
    ] {
        let labels = Some(&labels[..]);
        let view = pcd::PcdView {
            points,
            labels,
            width: 4,
            height: 3,
            viewpoint,
        };
        std::fs::write(folder.join(name), pcd::write(view, encoding)?)?;
    }
    Ok(())
}

/// Writes a mesh in each PLY encoding.
fn write_meshes(folder: &Path, vertices: &[Point]) -> Result<(), Box<dyn Error>> {
    use ply::Encoding::{Ascii, BinaryBigEndian, BinaryLittleEndian};
    let view = ply::MeshView {
        vertices,
        triangles: &[[0, 1, 2], [3, 4, 11]],
    };
    for (name, encoding) in [
        ("ascii", Ascii),
        ("little", BinaryLittleEndian),
        ("big", BinaryBigEndian),
    ] {
        std::fs::write(folder.join(name), ply::write(view, encoding)?)?;
    }
    Ok(())
}

/// Writes one triangle as binary and as text STL.
fn write_triangles(folder: &Path) -> Result<(), Box<dyn Error>> {
    let mut binary = vec![0; 134];
    binary[80] = 1;
    binary[100..104].copy_from_slice(&1.5_f32.to_le_bytes());
    std::fs::write(folder.join("binary"), binary)?;
    let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
        vertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    Ok(std::fs::write(folder.join("text"), text)?)
}

/// Writes poses, intrinsics and gravity as text; the first byte selects the parser.
fn write_matrices(folder: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::write(
        folder.join("pose"),
        b"\x020 -1 0 1\n1 0 0 2\n0 0 1 3\n0 0 0 1\n",
    )?;
    std::fs::write(
        folder.join("intrinsics"),
        b"\x03585 0 320\n0 585 240\n0 0 1\n",
    )?;
    std::fs::write(folder.join("gravity"), b"\x040 0.6 0.8\n")?;
    let json = b"\x06{\"width\": 16, \"fx\": 16.0, \"fy\": 16, \"cx\": 7.5, \"cy\": 3, \"depth_scale\": 0.1}";
    std::fs::write(folder.join("intrinsics_json"), json)?;
    let json = b"\x06{\"intrinsic_matrix\": [16, 0, 0, 0, 16, 0, 7.5, 3.5, 1]}";
    std::fs::write(folder.join("intrinsics_matrix_json"), json)?;
    Ok(())
}

/// Writes depth, mask and colour images; the first byte selects the decoder.
fn write_images(folder: &Path) -> Result<(), Box<dyn Error>> {
    use png::{BitDepth, ColorType};
    let grey = |kind| image(kind, ColorType::Grayscale, BitDepth::Sixteen, 256);
    std::fs::write(folder.join("depth"), grey(0)?)?;
    std::fs::write(folder.join("mask"), grey(5)?)?;
    let rgb = image(1, ColorType::Rgb, BitDepth::Eight, 384)?;
    std::fs::write(folder.join("color_png"), rgb)?;
    let mut color = vec![1];
    color.extend(test_flat_jpeg::encode(
        2,
        1,
        &[[100, 128, 128], [76, 85, 255]],
    ));
    std::fs::write(folder.join("color"), color)?;
    Ok(())
}

/// Writes the files of a Washington view; the first byte selects the parser.
fn write_views(folder: &Path, points: &[Point]) -> Result<(), Box<dyn Error>> {
    use png::{BitDepth, ColorType};
    let grey = |kind, depth, n_bytes| image(kind, ColorType::Grayscale, depth, n_bytes);
    let rgb = image(0, ColorType::Rgb, BitDepth::Eight, 384)?;
    let view = pcd::PcdView {
        points,
        labels: None,
        width: points.len(),
        height: 1,
        viewpoint: RigidTransform::identity(),
    };
    let cloud = [b"\x04", &pcd::write(view, pcd::Encoding::Ascii)?[..]].concat();
    for (name, content) in [
        ("color", rgb),
        ("depth", grey(1, BitDepth::Sixteen, 256)?),
        ("mask", grey(2, BitDepth::Eight, 128)?),
        ("mask_of_bits", grey(2, BitDepth::One, 16)?),
        ("location", b"\x03272,183\n".to_vec()),
        ("cloud", cloud),
        ("name", b"\x05cell_phone_1_2_100".to_vec()),
    ] {
        std::fs::write(folder.join(name), content)?;
    }
    Ok(())
}

/// PNG image of 16 x 8 pixels after the byte that selects the decoder.
fn image(
    kind: u8,
    color: png::ColorType,
    depth: png::BitDepth,
    n_bytes: usize,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut file = vec![kind];
    let mut encoder = png::Encoder::new(&mut file, 16, 8);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let bytes: Vec<u8> = (0..n_bytes).map(|value| value as u8).collect();
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(file)
}
