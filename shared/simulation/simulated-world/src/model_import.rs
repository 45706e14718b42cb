//! Unit and upward axis of imported models: given, told by the file, or guessed.

use crate::upright_axis::is_y_up;
use dataset::UpAxis;
use mesh::TriangleMesh;
use nalgebra::Vector3;

/// Longest side that an object of unknown unit is expected to have, metres: the unit with which
/// it comes nearest to it is taken. Chosen; household objects have 0.05 to 0.4.
const USUAL_SIDE_M: f32 = 0.2;

/// Longest sides of objects that are surely in metres. Chosen.
const SURE_SIDES_M: std::ops::RangeInclusive<f32> = 0.02..=0.8;

/// Limits of the longest side of an object, metres. Chosen.
const SIDES_M: std::ops::RangeInclusive<f32> = 0.005..=2.0;

/// Tolerance by which the longest side or the diagonal of a model of unit size differs from one
/// or two. Chosen.
const UNIT_SIZE_TOLERANCE: f32 = 0.005;

/// Length unit of a model file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelUnit {
    /// Metre.
    Metre,
    /// Centimetre.
    Centimetre,
    /// Millimetre.
    Millimetre,
    /// Inch.
    Inch,
}

/// Settings for the import of model files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ModelImport {
    /// Unit of all models; `None` for that which the file of each tells, or to guess it from the
    /// size.
    pub unit: Option<ModelUnit>,
    /// Upward axis of all models; `None` for that which the file of each tells, or z, or y when a
    /// model of animation programs clearly stands along it.
    pub up: Option<UpAxis>,
}

/// Frame of a model as far as its file tells it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct FileFrame {
    /// Length of the unit, metres.
    pub(crate) unit_m: Option<f32>,
    /// Upward axis.
    pub(crate) up: Option<UpAxis>,
    /// True for a format of both scans and animation programs.
    pub(crate) may_be_y_up: bool,
}

impl ModelUnit {
    /// Units that are guessed; inches are rare.
    const USUAL: [Self; 3] = [Self::Metre, Self::Centimetre, Self::Millimetre];

    /// Unit that the longest side of an object suggests: that which brings it nearest to the usual
    /// size. `None` where no usual unit gives the size of an object on a table.
    pub fn suggested_by(longest: f32) -> Option<Self> {
        if Self::is_surely_metre(longest) {
            return Some(Self::Metre);
        }
        let badness = |unit: &Self| (longest * unit.metres() / USUAL_SIDE_M).ln().abs();
        let units = Self::USUAL.into_iter();
        units
            .filter(|unit| SIDES_M.contains(&(longest * unit.metres())))
            .min_by(|a, b| badness(a).total_cmp(&badness(b)))
    }

    /// `true` for the longest side of an object that is surely in metres.
    pub fn is_surely_metre(longest: f32) -> bool {
        SURE_SIDES_M.contains(&longest)
    }

    /// Checks that a longest side in this unit is that of an object on a table.
    ///
    /// # Errors
    /// A sentence about "its longest side".
    pub fn check(self, longest: f32) -> Result<(), String> {
        if SIDES_M.contains(&(longest * self.metres())) {
            return Ok(());
        }
        let unit = self.plural();
        Err(format!(
            "its longest side is {longest} {unit}, which no object on a table has (0.005 to 2 m); \
             give it another unit or scale it"
        ))
    }

    /// Length of the unit, metres.
    pub fn metres(self) -> f32 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 0.01,
            Self::Millimetre => 0.001,
            Self::Inch => 0.0254,
        }
    }

    /// Name of the unit in the plural.
    pub fn plural(self) -> &'static str {
        match self {
            Self::Metre => "metres",
            Self::Centimetre => "centimetres",
            Self::Millimetre => "millimetres",
            Self::Inch => "inches",
        }
    }
}

impl ModelImport {
    /// Turns a mesh upright and scales it to metres. Returns sentences about what was guessed.
    ///
    /// # Errors
    /// A sentence when no unit gives the size of an object.
    pub(crate) fn apply(
        self,
        mesh: &mut TriangleMesh,
        frame: FileFrame,
    ) -> Result<Vec<String>, String> {
        let mut sentences = Vec::new();
        let stated = self.up.or(frame.up);
        turn_upright(mesh, stated.unwrap_or(UpAxis::Z));
        if stated.is_none() && frame.may_be_y_up && is_y_up(mesh) {
            turn_upright(mesh, UpAxis::Y);
            sentences.push(
                "it was taken to stand along its y axis, where its base is (give the upward axis \
                 if it is another)"
                    .to_owned(),
            );
        }
        let bounds = mesh.diagnostics().extent;
        let sides = bounds.map_or_else(Vector3::zeros, |bounds| bounds.sides());
        let (scale, sentence) = self.scale(sides, frame.unit_m)?;
        if (scale - 1.0).abs() > f32::EPSILON {
            mesh.scale(scale);
        }
        sentences.extend(sentence);
        Ok(sentences)
    }

    /// Factor to metres of a mesh with these sides, and a sentence if it was guessed. `file_unit_m`
    /// is the unit that the file tells.
    fn scale(
        self,
        sides: Vector3<f32>,
        file_unit_m: Option<f32>,
    ) -> Result<(f32, Option<String>), String> {
        let longest = sides.max();
        if let Some(unit) = self.unit {
            return unit.check(longest).map(|()| (unit.metres(), None));
        }
        if let Some(unit_m) = file_unit_m {
            let side_m = longest * unit_m;
            return if SIDES_M.contains(&side_m) {
                Ok((unit_m, None))
            } else {
                Err(format!(
                    "its longest side is {side_m} m in the unit of its file, which no object on a \
                     table has (0.005 to 2 m); give another unit or scale it"
                ))
            };
        }
        guessed_scale(sides)
    }
}

/// Turns a mesh so that an axis becomes z.
fn turn_upright(mesh: &mut TriangleMesh, up: UpAxis) {
    // Cyclic permutations are rotations.
    let turned = |v: Vector3<f32>| match up {
        UpAxis::X => Vector3::new(v.y, v.z, v.x),
        UpAxis::Y => Vector3::new(v.z, v.x, v.y),
        UpAxis::Z => v,
    };
    for vertex in &mut mesh.vertices {
        vertex.position = turned(vertex.position.coords).into();
        vertex.normal = turned(vertex.normal);
    }
}

/// Factor to metres that the size suggests, and a sentence unless it is sure.
fn guessed_scale(sides: Vector3<f32>) -> Result<(f32, Option<String>), String> {
    let longest = sides.max();
    if is_normalised(sides) {
        let sentence = format!(
            "its longest side is {longest:.3}, as of a model that was scaled to unit size; it \
             was scaled to {USUAL_SIDE_M} m (give the unit if it is another)"
        );
        return Ok((USUAL_SIDE_M / longest, Some(sentence)));
    }
    match ModelUnit::suggested_by(longest) {
        Some(_) if ModelUnit::is_surely_metre(longest) => Ok((1.0, None)),
        Some(unit) => {
            let sentence = format!(
                "its longest side is {longest:.3}; it was taken to be in {} (give the unit if \
                 it is another)",
                unit.plural()
            );
            Ok((unit.metres(), Some(sentence)))
        }
        None => Err(format!(
            "its longest side is {longest}; in metres, centimetres and millimetres alike that \
             is no object on a table (0.005 to 2 m); give its unit or scale it"
        )),
    }
}

/// `true` for sides of a model that a program has scaled to unit size: a longest side, or a
/// diagonal, of one or two.
fn is_normalised(sides: Vector3<f32>) -> bool {
    let is_unit = |length: f32| {
        (length - 1.0).abs() < UNIT_SIZE_TOLERANCE || (length - 2.0).abs() < UNIT_SIZE_TOLERANCE
    };
    is_unit(sides.max()) || is_unit(sides.norm())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Can of 6 x 6 x 12 cm, z up.
    fn can() -> TriangleMesh {
        let outline = [[0.0, -0.06], [0.03, -0.06], [0.03, 0.06], [0.0, 0.06]];
        mesh::lathe(&outline.map(nalgebra::Point2::from), 48).mesh
    }

    fn scale(longest: f32, unit: Option<ModelUnit>) -> Result<(f32, Option<String>), String> {
        let import = ModelImport {
            unit,
            ..ModelImport::default()
        };
        import.scale(Vector3::new(longest, 0.3 * longest, 0.5 * longest), None)
    }

    #[test]
    fn units_are_guessed_from_the_size_and_told() {
        for (longest, side_m, told) in [
            (0.18, 0.18, None),
            (1.3, 1.3, Some("in metres")),
            (42.0, 0.42, Some("centimetres")),
            (180.0, 0.18, Some("millimetres")),
            (900.0, 0.9, Some("millimetres")),
            (1.0, 0.2, Some("unit size")),
            (0.01, 0.01, Some("in metres")),
        ] {
            let (factor, sentence) = scale(longest, None).unwrap();
            assert!(
                (longest * factor - side_m).abs() < 1e-3,
                "{longest}: {factor}"
            );
            match told {
                None => assert_eq!(sentence, None),
                Some(told) => assert!(sentence.unwrap().contains(told), "{longest}"),
            }
        }
        for longest in [1e-4, 9e6] {
            assert!(scale(longest, None).unwrap_err().contains("give its unit"));
        }
    }

    #[test]
    fn a_given_unit_is_obeyed_or_refused() {
        let (factor, sentence) = scale(42.0, Some(ModelUnit::Millimetre)).unwrap();
        assert_eq!((factor, sentence), (0.001, None));
        assert_eq!(scale(10.0, Some(ModelUnit::Inch)).unwrap().0, 0.0254);
        let refused = scale(42.0, Some(ModelUnit::Metre)).unwrap_err();
        assert!(refused.contains("42 metres"), "{refused}");
    }

    #[test]
    fn the_unit_of_a_file_is_obeyed_or_refused_unless_one_is_given() {
        let sides = Vector3::new(20.0, 10.0, 5.0);
        let guessing = ModelImport::default();
        assert_eq!(guessing.scale(sides, Some(0.0254)), Ok((0.0254, None)));
        let refused = guessing.scale(sides, Some(1.0)).unwrap_err();
        assert!(
            refused.contains("20 m in the unit of its file"),
            "{refused}"
        );
        let given = ModelImport {
            unit: Some(ModelUnit::Centimetre),
            up: None,
        };
        assert_eq!(given.scale(sides, Some(1.0)), Ok((0.01, None)));
    }

    #[test]
    fn the_axis_is_given_or_told_or_guessed() {
        // A can along y.
        let mut can = can();
        turn_upright(&mut can, UpAxis::X);
        let height = |up: Option<UpAxis>, frame: FileFrame| {
            let mut mesh = can.clone();
            let import = ModelImport { unit: None, up };
            let notes = import.apply(&mut mesh, frame).unwrap();
            let height = mesh.bounds().unwrap().sides().z;
            ((height - 0.12).abs() < 1e-3, notes.len())
        };
        let told = |up: UpAxis| FileFrame {
            up: Some(up),
            may_be_y_up: true,
            ..FileFrame::default()
        };
        let open = FileFrame {
            may_be_y_up: true,
            ..FileFrame::default()
        };
        assert_eq!(height(None, FileFrame::default()), (false, 0));
        assert_eq!(height(None, open), (true, 1));
        assert_eq!(height(Some(UpAxis::Z), open), (false, 0));
        assert_eq!(height(None, told(UpAxis::Y)), (true, 0));
        assert_eq!(height(None, told(UpAxis::Z)), (false, 0));
        assert_eq!(height(Some(UpAxis::Y), told(UpAxis::Z)), (true, 0));
    }

    #[test]
    fn the_given_axis_points_up() {
        for (up, given) in [
            (UpAxis::X, [3.0, 1.0, 2.0]),
            (UpAxis::Y, [2.0, 3.0, 1.0]),
            (UpAxis::Z, [1.0, 2.0, 3.0]),
        ] {
            let mut mesh = TriangleMesh {
                vertices: vec![mesh::Vertex {
                    position: given.into(),
                    normal: given.into(),
                    color: [0; 3],
                }],
                ..TriangleMesh::default()
            };
            turn_upright(&mut mesh, up);
            assert_eq!(mesh.vertices[0].position, [1.0, 2.0, 3.0].into(), "{up:?}");
        }
    }
}
