//! Mesh with textures, and their transfer to the colours of its vertices (baking).

use crate::mesh::{MAX_VERTICES, Mesh};
use crate::texture::Texture;
use point_cloud::{Point, Rgba};
use std::collections::{HashMap, HashSet};

/// Greatest number of triangles that subdivision makes. Chosen: that of an imported model.
const TRIANGLES_MAX: usize = 20_000;

/// Edges are not made shorter than this share of the longest side. Chosen.
const FINEST_SHARE: f32 = 1.0 / 128.0;

/// Factor by which edges are allowed to be longer when there are too many triangles. Chosen.
const COARSENING: f32 = 1.2;

/// Edges over fewer pixels of the texture are not divided. Chosen.
const PIXELS_MIN: f32 = 2.0;

/// Mesh some of whose triangles have a texture.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct TexturedMesh {
    /// Mesh with the colours without textures.
    pub(crate) mesh: Mesh,
    /// Texture of each triangle; may be shorter than the triangles.
    pub(crate) faces: Vec<Option<FaceTexture>>,
}

/// Place of a triangle in a texture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FaceTexture {
    /// Number of the texture.
    pub(crate) texture: u32,
    /// Texture coordinates of the corners, finite.
    pub(crate) uv: [[f32; 2]; 3],
}

/// Triangle that is divided.
#[derive(Debug, Clone, Copy)]
struct Piece {
    corners: [u32; 3],
    face: Option<FaceTexture>,
}

impl TexturedMesh {
    /// Mesh whose vertices have the colours of the textures. Triangles that are large and cross
    /// several pixels are divided first, alike on both sides of each edge, as finely as at most
    /// 20 000 triangles allow. Vertices between different colours become several.
    pub(crate) fn baked(self, textures: &[Option<Texture>]) -> Mesh {
        let texture = |face: &FaceTexture| textures.get(face.texture as usize)?.as_ref();
        let faces = self.faces.into_iter().chain(std::iter::repeat(None));
        let triangles = self.mesh.triangles.iter().zip(faces);
        let pieces: Vec<Piece> = triangles
            .map(|(&corners, face)| Piece {
                corners,
                face: face.filter(|face| texture(face).is_some()),
            })
            .collect();
        if pieces.iter().all(|piece| piece.face.is_none()) {
            return self.mesh;
        }
        let (vertices, pieces) = subdivided(self.mesh.vertices, pieces, &texture);
        paint(vertices, &pieces, &texture)
    }
}

/// Divides triangles as finely as the limits allow.
fn subdivided<'a>(
    vertices: Vec<Point>,
    pieces: Vec<Piece>,
    texture: &impl Fn(&FaceTexture) -> Option<&'a Texture>,
) -> (Vec<Point>, Vec<Piece>) {
    let mut longest = 0.0_f32;
    for axis in [|p: &Point| p.x, |p: &Point| p.y, |p: &Point| p.z] {
        let least = vertices.iter().map(axis).fold(f32::INFINITY, f32::min);
        let most = vertices.iter().map(axis).fold(f32::NEG_INFINITY, f32::max);
        longest = longest.max(most - least);
    }
    if pieces.len() >= TRIANGLES_MAX || !longest.is_finite() {
        return (vertices, pieces);
    }
    let mut edge_max = FINEST_SHARE * longest;
    while edge_max < longest {
        let mut division = Division::new(&vertices, &pieces, edge_max);
        if division.run(texture) {
            return (division.vertices, division.pieces);
        }
        edge_max *= COARSENING;
    }
    (vertices, pieces)
}

/// Division of the edges longer than a limit.
struct Division {
    vertices: Vec<Point>,
    pieces: Vec<Piece>,
    /// Number of the position of each vertex: several vertices may have the same.
    places: Vec<u32>,
    n_places: u32,
    edge_max: f32,
    middles: HashMap<[u32; 2], u32>,
    middle_places: HashMap<[u32; 2], u32>,
}

/// Position in the middle of an edge, the same from both ends.
fn middle_of(p: Point, q: Point) -> [f32; 3] {
    [(p.x, q.x), (p.y, q.y), (p.z, q.z)].map(|(a, b)| f32::midpoint(a, b))
}

fn ordered(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl Division {
    fn new(vertices: &[Point], pieces: &[Piece], edge_max: f32) -> Self {
        let mut known = HashMap::new();
        let places = vertices.iter().map(|v| {
            let next = known.len() as u32;
            let key = [v.x, v.y, v.z].map(|x| (x + 0.0).to_bits());
            *known.entry(key).or_insert(next)
        });
        Self {
            places: places.collect(),
            n_places: known.len() as u32,
            vertices: vertices.to_vec(),
            pieces: pieces.to_vec(),
            edge_max,
            middles: HashMap::new(),
            middle_places: HashMap::new(),
        }
    }

    /// Divides until no edge is too long; false if there are too many triangles.
    fn run<'a>(&mut self, texture: &impl Fn(&FaceTexture) -> Option<&'a Texture>) -> bool {
        loop {
            let divided = self.long_edges(texture);
            if divided.is_empty() {
                return true;
            }
            let mut pieces = Vec::with_capacity(2 * self.pieces.len());
            for piece in std::mem::take(&mut self.pieces) {
                self.divide(piece, &divided, &mut pieces);
                if pieces.len() > TRIANGLES_MAX {
                    return false;
                }
            }
            self.pieces = pieces;
        }
    }

    /// Edges to divide, as pairs of positions.
    fn long_edges<'a>(
        &self,
        texture: &impl Fn(&FaceTexture) -> Option<&'a Texture>,
    ) -> HashSet<[u32; 2]> {
        let mut divided = HashSet::new();
        for piece in &self.pieces {
            let Some(face) = piece.face else {
                continue;
            };
            let [width, height] = texture(&face).map_or([0.0; 2], Texture::size);
            for k in 0..3 {
                let next = (k + 1) % 3;
                let [a, b] = [piece.corners[k], piece.corners[next]];
                let [p, q] = [a, b].map(|i| self.vertices[i as usize]);
                let ([u0, v0], [u1, v1]) = (face.uv[k], face.uv[next]);
                let n_pixels = ((u1 - u0) * width).hypot((v1 - v0) * height);
                let length = (q.position() - p.position()).norm() as f32;
                let middle = middle_of(p, q);
                // A middle that is an end cannot be divided further.
                if length > self.edge_max
                    && n_pixels > PIXELS_MIN
                    && middle != [p.x, p.y, p.z]
                    && middle != [q.x, q.y, q.z]
                {
                    divided.insert(ordered(self.places[a as usize], self.places[b as usize]));
                }
            }
        }
        divided
    }

    /// Divides a triangle at the middles of its divided edges.
    fn divide(&mut self, piece: Piece, divided: &HashSet<[u32; 2]>, pieces: &mut Vec<Piece>) {
        let is_divided = |k: usize| {
            let [a, b] = [piece.corners[k], piece.corners[(k + 1) % 3]];
            divided.contains(&ordered(self.places[a as usize], self.places[b as usize]))
        };
        let is_divided = [is_divided(0), is_divided(1), is_divided(2)];
        let n_divided = is_divided.iter().filter(|is| **is).count();
        if n_divided == 0 {
            pieces.push(piece);
            return;
        }
        // Corners 0 to 2, and the middles 3 to 5 of the edges that start there.
        let mut corners = [piece.corners[0]; 6];
        corners[..3].copy_from_slice(&piece.corners);
        let uv = piece.face.map_or([[0.0; 2]; 3], |face| face.uv);
        let mut uvs = [[0.0; 2]; 6];
        uvs[..3].copy_from_slice(&uv);
        for k in (0..3).filter(|&k| is_divided[k]) {
            let next = (k + 1) % 3;
            corners[3 + k] = self.middle(piece.corners[k], piece.corners[next]);
            uvs[3 + k] = [0, 1].map(|i| f32::midpoint(uv[k][i], uv[next][i]));
        }
        let mut push = |triangle: [usize; 3]| {
            let face = piece.face.map(|face| FaceTexture {
                uv: triangle.map(|i| uvs[i]),
                ..face
            });
            let corners = triangle.map(|i| corners[i]);
            pieces.push(Piece { corners, face });
        };
        let rotated = |by: usize, i: usize| {
            if i < 3 {
                (i + by) % 3
            } else {
                3 + (i + by) % 3
            }
        };
        // Numbers of corners when the first edge is divided, or all but the last.
        let first = (0..3).find(|&k| is_divided[k] && (n_divided == 1 || !is_divided[(k + 2) % 3]));
        let triangles: &[[usize; 3]] = match n_divided {
            1 => &[[0, 3, 2], [3, 1, 2]],
            2 => &[[3, 1, 4], [0, 3, 4], [0, 4, 2]],
            _ => &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
        };
        for triangle in triangles {
            push(triangle.map(|i| rotated(first.unwrap_or(0), i)));
        }
    }

    /// Vertex in the middle of an edge.
    fn middle(&mut self, a: u32, b: u32) -> u32 {
        if let Some(known) = self.middles.get(&ordered(a, b)) {
            return *known;
        }
        let [p, q] = [a, b].map(|i| self.vertices[i as usize]);
        let [x, y, z] = middle_of(p, q);
        let ([r0, g0, b0], [r1, g1, b1]) = (p.color.rgb(), q.color.rgb());
        let place = ordered(self.places[a as usize], self.places[b as usize]);
        let place = *self.middle_places.entry(place).or_insert_with(|| {
            self.n_places += 1;
            self.n_places - 1
        });
        self.vertices.push(Point {
            x,
            y,
            z,
            color: Rgba::opaque(
                u8::midpoint(r0, r1),
                u8::midpoint(g0, g1),
                u8::midpoint(b0, b1),
            ),
        });
        self.places.push(place);
        let middle = self.vertices.len() as u32 - 1;
        self.middles.insert(ordered(a, b), middle);
        middle
    }
}

/// Gives the corners the colours of their textures.
fn paint<'a>(
    mut vertices: Vec<Point>,
    pieces: &[Piece],
    texture: &impl Fn(&FaceTexture) -> Option<&'a Texture>,
) -> Mesh {
    // Colour of each vertex at a place of a texture: that of the first triangle there.
    let mut colors: HashMap<(u32, u32, [u32; 2]), Rgba> = HashMap::new();
    let mut copies: HashMap<(u32, u32), u32> = HashMap::new();
    let mut is_used = vec![false; vertices.len()];
    for corner in pieces
        .iter()
        .filter(|p| p.face.is_none())
        .flat_map(|p| p.corners)
    {
        is_used[corner as usize] = true;
    }
    let mut triangles = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let mut corners = piece.corners;
        if let Some((face, image)) = piece.face.and_then(|face| Some((face, texture(&face)?))) {
            let footprint = footprint(&face, image);
            for (corner, uv) in corners.iter_mut().zip(face.uv) {
                let key = (*corner, face.texture, uv.map(f32::to_bits));
                let color = *colors.entry(key).or_insert_with(|| {
                    let [red, green, blue] = image.sample(uv, footprint);
                    Rgba::opaque(red, green, blue)
                });
                let idx = *corner as usize;
                if !is_used[idx] {
                    is_used[idx] = true;
                    vertices[idx].color = color;
                }
                if vertices[idx].color != color && vertices.len() < MAX_VERTICES {
                    *corner = *copies.entry((*corner, color.0)).or_insert_with(|| {
                        let copy = Point {
                            color,
                            ..vertices[idx]
                        };
                        vertices.push(copy);
                        vertices.len() as u32 - 1
                    });
                }
            }
        }
        triangles.push(corners);
    }
    Mesh {
        vertices,
        triangles,
    }
}

/// Side of the square of pixels that a corner of a triangle stands for.
fn footprint(face: &FaceTexture, image: &Texture) -> f32 {
    let [width, height] = image.size();
    let [[u0, v0], [u1, v1], [u2, v2]] = face.uv;
    let doubled_area = ((u1 - u0) * (v2 - v0) - (u2 - u0) * (v1 - v0)).abs();
    (doubled_area * width * height).sqrt() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NEUTRAL_GREY;
    use crate::texture::test_png;
    use png::ColorType;

    /// Cube of side 1 without shared vertices; its first two faces have a texture.
    fn cube(side_uv: f32) -> TexturedMesh {
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let side = |i: usize, axis: usize| (i >> axis & 1) as f32;
        let mut cube = TexturedMesh::default();
        for (n, face) in faces.into_iter().enumerate() {
            let first = cube.mesh.vertices.len() as u32;
            cube.mesh.vertices.extend(face.map(|i| Point {
                x: side(i, 0),
                y: side(i, 1),
                z: side(i, 2),
                color: NEUTRAL_GREY,
            }));
            for [a, b] in [[1, 2], [2, 3]] {
                cube.mesh.triangles.push([first, first + a, first + b]);
                let uv = [0, a, b].map(|i| {
                    [[0.0, 0.0], [side_uv, 0.0], [side_uv; 2], [0.0, side_uv]][i as usize]
                });
                cube.faces
                    .push((n < 2).then_some(FaceTexture { texture: 0, uv }));
            }
        }
        cube
    }

    fn checkers(color_type: ColorType) -> Option<Texture> {
        let samples: Vec<u8> = (0..64 * 64)
            .map(|i| if (i / 8 + i / 512) % 2 == 0 { 0 } else { 255 })
            .collect();
        Texture::decode(&test_png(64, color_type, &samples)).ok()
    }

    #[test]
    fn division_opens_no_gap() {
        let mesh = cube(1.0).baked(&[checkers(ColorType::Grayscale)]);
        assert!(
            (8_000..=TRIANGLES_MAX).contains(&mesh.triangles.len()),
            "{}",
            mesh.triangles.len()
        );
        let mut edges: HashMap<_, i32> = HashMap::new();
        let key = |i: u32| {
            let v = mesh.vertices[i as usize];
            [v.x, v.y, v.z].map(f32::to_bits)
        };
        for [a, b, c] in &mesh.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)].map(|(p, q)| (key(*p), key(*q))) {
                *edges.entry((from.min(to), from.max(to))).or_default() +=
                    if from < to { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|balance| *balance == 0), "closed");
        let n_dark = mesh
            .vertices
            .iter()
            .filter(|v| v.color.rgb()[0] < 64)
            .count();
        assert!(n_dark > 1000, "{n_dark}");
    }

    #[test]
    fn division_leaves_what_lies_in_few_pixels() {
        // As in models whose texture is a palette.
        let mesh = cube(1.0 / 64.0).baked(&[checkers(ColorType::Grayscale)]);
        assert_eq!(mesh.triangles.len(), 12);
    }

    #[test]
    fn faces_without_an_image_stay_as_they_are() {
        let plain = cube(1.0).mesh;
        assert_eq!(cube(1.0).baked(&[None]), plain);
        assert_eq!(cube(1.0).baked(&[]), plain);
        let mut short = cube(1.0);
        short.faces.clear();
        assert_eq!(short.baked(&[checkers(ColorType::Grayscale)]), plain);
    }
}
