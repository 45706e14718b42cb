//! Triangles of a COLLADA geometry.

use super::MAX_TRIANGLES;
use super::appearance::color;
use super::document::{Document, child, children, numbers, wrong};
use crate::ModelError;
use point_cloud::Rgba;
use roxmltree::Node;

/// Greatest number of inputs of a primitive.
const MAX_INPUTS: usize = 32;

/// Triangles of a geometry, in its own frame.
pub(super) struct Geometry<'a> {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) triangles: Vec<Triangle<'a>>,
    /// Number of strips and fans, which are not read.
    pub(super) n_skipped: usize,
}

/// Triangle of a geometry.
pub(super) struct Triangle<'a> {
    /// Numbers of its positions.
    pub(super) corners: [u32; 3],
    /// Texture coordinates, finite.
    pub(super) uv: Option<[[f32; 2]; 3]>,
    /// Colours of its corners.
    pub(super) colors: Option<[Rgba; 3]>,
    /// Name to which a scene binds a material.
    pub(super) material: &'a str,
}

/// Numbers of a source, several for each index.
struct Source {
    values: Vec<f32>,
    stride: usize,
    offset: usize,
}

impl Source {
    /// Source to which an input refers; `None` if there is none.
    fn of_input<'a>(
        document: &Document<'a>,
        input: Node<'a, 'a>,
    ) -> Result<Option<Self>, ModelError> {
        let Some(source) = document.target(input, "source", "source") else {
            return Ok(None);
        };
        let Some(array) = child(source, "float_array") else {
            return Ok(None);
        };
        let accessor = child(source, "technique_common").and_then(|t| child(t, "accessor"));
        let number = |name: &str, usual: usize| {
            let text = accessor.and_then(|accessor| accessor.attribute(name));
            text.map_or(Some(usual), |text| text.trim().parse().ok())
        };
        let (Some(stride), Some(offset)) = (number("stride", 1), number("offset", 0)) else {
            return Err(wrong(source, "its stride or offset is no count".to_owned()));
        };
        Ok(Some(Self {
            values: numbers(array)?,
            stride,
            offset,
        }))
    }

    /// First `N` numbers of an index.
    fn get<const N: usize>(&self, index: u32) -> Option<[f32; N]> {
        let start = self.stride.checked_mul(index as usize)?;
        let start = start.checked_add(self.offset)?;
        self.values.get(start..)?.first_chunk().copied()
    }
}

/// Inputs of a primitive: sources and their places among the indices.
#[derive(Default)]
struct Inputs {
    /// Number of indices of one corner.
    n: usize,
    vertex: Option<usize>,
    uv: Option<(usize, Source)>,
    colors: Option<(usize, Source)>,
}

impl Inputs {
    fn read<'a>(document: &Document<'a>, primitive: Node<'a, 'a>) -> Result<Self, ModelError> {
        let mut inputs = Self::default();
        for input in children(primitive, "input") {
            let offset = input.attribute("offset").unwrap_or("0").trim().parse();
            let offset = offset.ok().filter(|offset| *offset < MAX_INPUTS);
            let offset = offset.ok_or_else(|| {
                wrong(input, format!("its offset is no count below {MAX_INPUTS}"))
            })?;
            inputs.n = inputs.n.max(offset + 1);
            let semantic = input.attribute("semantic").unwrap_or_default();
            if semantic == "VERTEX" {
                inputs.vertex = Some(offset);
                let vertices = document.target(input, "source", "vertices");
                for input in vertices.into_iter().flat_map(|v| children(v, "input")) {
                    inputs.add(document, input, offset)?;
                }
            } else {
                inputs.add(document, input, offset)?;
            }
        }
        Ok(inputs)
    }

    /// Adds the first texture coordinates and colours.
    fn add<'a>(
        &mut self,
        document: &Document<'a>,
        input: Node<'a, 'a>,
        offset: usize,
    ) -> Result<(), ModelError> {
        let place = match input.attribute("semantic") {
            Some("TEXCOORD") => &mut self.uv,
            Some("COLOR") => &mut self.colors,
            _ => return Ok(()),
        };
        if place.is_none() {
            *place = Source::of_input(document, input)?.map(|source| (offset, source));
        }
        Ok(())
    }

    /// Three numbers of all corners of a triangle, or none.
    fn of_corners<const N: usize>(
        input: Option<&(usize, Source)>,
        corners: [&[u32]; 3],
    ) -> Option<[[f32; N]; 3]> {
        let (offset, source) = input?;
        let [a, b, c] = corners.map(|corner| source.get(*corner.get(*offset)?));
        let all = [a?, b?, c?];
        let is_finite = all.as_flattened().iter().all(|value| value.is_finite());
        is_finite.then_some(all)
    }
}

impl<'a> Geometry<'a> {
    /// Reads the primitives of a geometry.
    pub(super) fn read(
        document: &Document<'a>,
        geometry: Node<'a, 'a>,
    ) -> Result<Self, ModelError> {
        let mut read = Self {
            positions: Vec::new(),
            triangles: Vec::new(),
            n_skipped: 0,
        };
        let Some(mesh) = child(geometry, "mesh") else {
            return Ok(read);
        };
        let position_input = child(mesh, "vertices").and_then(|vertices| {
            let mut inputs = children(vertices, "input");
            inputs.find(|input| input.attribute("semantic") == Some("POSITION"))
        });
        if let Some(input) = position_input
            && let Some(source) = Source::of_input(document, input)?
        {
            let n_values = source.values.len().saturating_sub(source.offset);
            // The last position may have no padding behind it.
            let n = (n_values + source.stride.saturating_sub(3)).checked_div(source.stride);
            let positions =
                (0..n.unwrap_or(0).min(MAX_TRIANGLES) as u32).map_while(|i| source.get(i));
            read.positions = positions.collect();
            if !read.positions.as_flattened().iter().all(|x| x.is_finite()) {
                return Err(wrong(input, "a coordinate is not finite".to_owned()));
            }
        }
        for primitive in mesh.children().filter(Node::is_element) {
            match primitive.tag_name().name() {
                "triangles" | "polylist" | "polygons" => {
                    read.push_primitive(document, primitive)?;
                }
                "tristrips" | "trifans" => read.n_skipped += 1,
                _ => {}
            }
        }
        Ok(read)
    }

    fn push_primitive(
        &mut self,
        document: &Document<'a>,
        primitive: Node<'a, 'a>,
    ) -> Result<(), ModelError> {
        let inputs = Inputs::read(document, primitive)?;
        let Some(vertex) = inputs.vertex else {
            return Err(wrong(primitive, "it has no input VERTEX".to_owned()));
        };
        let material = primitive.attribute("material").unwrap_or_default();
        let vcount = child(primitive, "vcount").map(numbers::<u32>).transpose()?;
        for list in children(primitive, "p") {
            let indices: Vec<u32> = numbers(list)?;
            let mut corners = indices.chunks_exact(inputs.n);
            let counts: &mut dyn Iterator<Item = usize> = match primitive.tag_name().name() {
                "triangles" => &mut std::iter::repeat_n(3, corners.len() / 3),
                "polylist" => &mut vcount.iter().flatten().map(|n| *n as usize),
                _ => &mut std::iter::once(corners.len()),
            };
            for n_corners in counts {
                if n_corners > corners.len() {
                    return Err(wrong(list, "it ends before its last polygon".to_owned()));
                }
                let polygon: Vec<&[u32]> = corners.by_ref().take(n_corners).collect();
                for pair in polygon.get(1..).unwrap_or_default().windows(2) {
                    let corners = [polygon[0], pair[0], pair[1]];
                    let triangle = self.triangle(&inputs, vertex, corners, material);
                    let triangle = triangle.map_err(|problem| wrong(list, problem))?;
                    self.triangles.push(triangle);
                    if self.triangles.len() > MAX_TRIANGLES {
                        return Err(ModelError::SceneTooLarge);
                    }
                }
            }
        }
        Ok(())
    }

    fn triangle(
        &self,
        inputs: &Inputs,
        vertex: usize,
        corners: [&[u32]; 3],
        material: &'a str,
    ) -> Result<Triangle<'a>, String> {
        let positions = corners.map(|corner| corner[vertex]);
        let n_positions = self.positions.len();
        if let Some(missing) = positions.iter().find(|i| **i as usize >= n_positions) {
            return Err(format!("there is no vertex {missing}"));
        }
        let colors: Option<[[f32; 3]; 3]> = Inputs::of_corners(inputs.colors.as_ref(), corners);
        Ok(Triangle {
            corners: positions,
            uv: Inputs::of_corners(inputs.uv.as_ref(), corners),
            colors: colors.map(|colors| colors.map(|[r, g, b]| color(r, g, b))),
            material,
        })
    }
}
