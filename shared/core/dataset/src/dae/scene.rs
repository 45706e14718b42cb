//! Visual scene of a COLLADA document: geometries placed by its nodes.

use super::MAX_TRIANGLES;
use super::appearance::{Appearance, Appearances};
use super::document::{Document, child, children, numbers, wrong};
use super::geometry::{Geometry, Triangle};
use crate::ModelError;
use crate::textured_mesh::{FaceTexture, TexturedMesh};
use nalgebra::{Matrix4, Point3, Rotation3, Translation3, Unit, Vector3};
use point_cloud::{Point, Rgba};
use roxmltree::{Node, NodeId};
use std::collections::HashMap;

/// Greatest depth of nodes in nodes.
const MAX_DEPTH: usize = 64;

/// Greatest number of nodes of a scene, each counted as often as it is placed.
const MAX_NODES: usize = 1 << 16;

/// Reads all geometries that the visual scene places; those of a document without a scene are
/// taken as they are.
///
/// # Errors
/// When there is no triangle or an element is wrong.
pub(super) fn read(
    document: &Document<'_>,
    appearances: &mut Appearances,
    notes: &mut Vec<String>,
) -> Result<TexturedMesh, ModelError> {
    let mut scene = ScenePlacer {
        document,
        appearances,
        geometries: HashMap::new(),
        placed: TexturedMesh::default(),
        n_nodes: 0,
        n_skipped: 0,
    };
    let root = document.root;
    let instance = child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
    let visual_scene = instance
        .and_then(|instance| document.target(instance, "url", "visual_scene"))
        .or_else(|| child(child(root, "library_visual_scenes")?, "visual_scene"));
    if let Some(visual_scene) = visual_scene {
        for node in children(visual_scene, "node") {
            scene.place_node(node, &Matrix4::identity(), 0)?;
        }
    } else {
        for library in children(root, "library_geometries") {
            for geometry in children(library, "geometry") {
                scene.place_geometry(geometry, None, &Matrix4::identity())?;
            }
        }
    }
    if scene.n_skipped > 0 {
        notes.push(format!(
            "{} strips, fans or moving parts of it are left out; export it as triangles without \
             a skeleton",
            scene.n_skipped
        ));
    }
    if scene.placed.mesh.triangles.is_empty() {
        return Err(ModelError::NoTriangles);
    }
    Ok(scene.placed)
}

struct ScenePlacer<'a, 'b> {
    document: &'b Document<'a>,
    appearances: &'b mut Appearances,
    geometries: HashMap<NodeId, Geometry<'a>>,
    placed: TexturedMesh,
    n_nodes: usize,
    n_skipped: usize,
}

impl<'a> ScenePlacer<'a, '_> {
    fn place_node(
        &mut self,
        node: Node<'a, 'a>,
        scene_from_parent: &Matrix4<f64>,
        depth: usize,
    ) -> Result<(), ModelError> {
        self.n_nodes += 1;
        if depth > MAX_DEPTH || self.n_nodes > MAX_NODES {
            let problem = format!(
                "there are more than {MAX_DEPTH} nodes in one another or {MAX_NODES} in all"
            );
            return Err(wrong(node, problem));
        }
        let mut scene_from_node = *scene_from_parent;
        for element in node.children().filter(Node::is_element) {
            if let Some(transform) = transform(element)? {
                scene_from_node *= transform;
            }
        }
        for element in node.children().filter(Node::is_element) {
            match element.tag_name().name() {
                "node" => self.place_node(element, &scene_from_node, depth + 1)?,
                "instance_node" => {
                    if let Some(node) = self.document.target(element, "url", "node") {
                        self.place_node(node, &scene_from_node, depth + 1)?;
                    }
                }
                "instance_geometry" => {
                    if let Some(geometry) = self.document.target(element, "url", "geometry") {
                        self.place_geometry(geometry, Some(element), &scene_from_node)?;
                    }
                }
                "instance_controller" => self.n_skipped += 1,
                _ => {}
            }
        }
        Ok(())
    }

    fn place_geometry(
        &mut self,
        geometry: Node<'a, 'a>,
        instance: Option<Node<'a, 'a>>,
        scene_from_geometry: &Matrix4<f64>,
    ) -> Result<(), ModelError> {
        let id = geometry.id();
        if !self.geometries.contains_key(&id) {
            let read = Geometry::read(self.document, geometry)?;
            self.n_skipped += read.n_skipped;
            self.geometries.insert(id, read);
        }
        let mut appearances: HashMap<&str, Appearance> = HashMap::new();
        let bound = instance
            .and_then(|instance| child(child(instance, "bind_material")?, "technique_common"));
        for binding in bound
            .into_iter()
            .flat_map(|b| children(b, "instance_material"))
        {
            let material = self.document.target(binding, "target", "material");
            if let (Some(symbol), Some(material)) = (binding.attribute("symbol"), material) {
                let appearance = self.appearances.of_material(self.document, material);
                appearances.insert(symbol, appearance);
            }
        }
        let Some(read) = self.geometries.get(&id) else {
            return Ok(());
        };
        for triangle in &read.triangles {
            // A name without a binding is that of the material itself in some files.
            appearances.entry(triangle.material).or_insert_with(|| {
                let material = self.document.element("material", triangle.material);
                material.map_or(Appearance::PLAIN, |material| {
                    self.appearances.of_material(self.document, material)
                })
            });
        }
        Placement {
            placed: &mut self.placed,
            vertices: HashMap::new(),
            scene_from_geometry,
            is_mirrored: scene_from_geometry.determinant() < 0.0,
        }
        .push_all(read, &appearances)
        .map_err(|error| {
            error.unwrap_or_else(|| {
                wrong(geometry, "its place in the scene is not finite".to_owned())
            })
        })
    }
}

/// Placement of one geometry in the scene.
struct Placement<'b> {
    placed: &'b mut TexturedMesh,
    /// Vertices in the scene by position and colour.
    vertices: HashMap<(u32, u32), u32>,
    scene_from_geometry: &'b Matrix4<f64>,
    is_mirrored: bool,
}

impl Placement<'_> {
    /// Adds the triangles. Without an error value, a position is not finite.
    fn push_all(
        mut self,
        geometry: &Geometry<'_>,
        appearances: &HashMap<&str, Appearance>,
    ) -> Result<(), Option<ModelError>> {
        for triangle in &geometry.triangles {
            let appearance = appearances.get(triangle.material);
            let appearance = appearance.copied().unwrap_or(Appearance::PLAIN);
            self.push(&geometry.positions, triangle, appearance)?;
        }
        Ok(())
    }

    fn push(
        &mut self,
        positions: &[[f32; 3]],
        triangle: &Triangle<'_>,
        appearance: Appearance,
    ) -> Result<(), Option<ModelError>> {
        let colors = triangle.colors.unwrap_or([appearance.color; 3]);
        let mut corners = [0; 3];
        for ((corner, position), color) in corners.iter_mut().zip(triangle.corners).zip(colors) {
            *corner = self.vertex(positions, position, color).ok_or(None)?;
        }
        let mut uv = triangle.uv;
        if self.is_mirrored {
            corners.swap(1, 2);
            if let Some(uv) = &mut uv {
                uv.swap(1, 2);
            }
        }
        let TexturedMesh { mesh, faces } = &mut *self.placed;
        mesh.triangles.push(corners);
        faces.push(
            appearance
                .texture
                .zip(uv)
                .map(|(texture, uv)| FaceTexture { texture, uv }),
        );
        if mesh.triangles.len().max(mesh.vertices.len()) > MAX_TRIANGLES {
            return Err(Some(ModelError::SceneTooLarge));
        }
        Ok(())
    }

    fn vertex(&mut self, positions: &[[f32; 3]], position: u32, color: Rgba) -> Option<u32> {
        if let Some(known) = self.vertices.get(&(position, color.0)) {
            return Some(*known);
        }
        let at = Point3::from(*positions.get(position as usize)?).cast::<f64>();
        let at = self.scene_from_geometry.transform_point(&at);
        let (x, y, z) = (at.x as f32, at.y as f32, at.z as f32);
        let point = Some(Point { x, y, z, color }).filter(Point::is_finite)?;
        let vertices = &mut self.placed.mesh.vertices;
        vertices.push(point);
        let idx = vertices.len() as u32 - 1;
        self.vertices.insert((position, color.0), idx);
        Some(idx)
    }
}

/// Transform of an element of a node, if it is one.
fn transform(element: Node<'_, '_>) -> Result<Option<Matrix4<f64>>, ModelError> {
    let name = element.tag_name().name();
    if !matches!(name, "matrix" | "translate" | "rotate" | "scale") {
        return Ok(None);
    }
    let values: Vec<f64> = numbers(element)?;
    if !values.iter().all(|value| value.is_finite()) {
        return Err(wrong(element, "a number is not finite".to_owned()));
    }
    let found = match (name, &values[..]) {
        ("matrix", values) if values.len() == 16 => Matrix4::from_row_slice(values),
        ("translate", &[x, y, z]) => Translation3::new(x, y, z).to_homogeneous(),
        ("rotate", &[x, y, z, degrees]) => {
            let axis = Unit::try_new(Vector3::new(x, y, z), 0.0);
            axis.map_or_else(Matrix4::identity, |axis| {
                Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous()
            })
        }
        ("scale", &[x, y, z]) => Matrix4::new_nonuniform_scaling(&Vector3::new(x, y, z)),
        _ => {
            return Err(wrong(
                element,
                format!("it cannot have {} numbers", values.len()),
            ));
        }
    };
    Ok(Some(found))
}
