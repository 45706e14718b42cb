//! Judge of grasps by MuJoCo: another physics engine, in a process of its own, decides what a grasp
//! does.

use arm_kinematics::GripperModel;
use geometry::RigidTransform;
use serde::Deserialize;
use serde_json::{Value, json};
use service::{Failure, exit_code};
use simulated_world::World;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Mutex;

/// Program of the judge, from the folder of the project.
const PROGRAM: &str = "tests/peers/mujoco-grasps/run";
/// Exit code with which the judge says that it cannot be had here.
const SKIPPED: i32 = 4;
/// Density of all objects, kg/m³.
const DENSITY_KG_M3: f64 = 300.0;

/// Grasp as the judge is asked about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct JudgedGrasp {
    pub(super) world_from_tool: RigidTransform,
    pub(super) opening_m: f64,
    pub(super) approach_m: f64,
    /// Friction coefficient of the pads.
    pub(super) friction: f64,
}

/// Answer of the judge.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct Verdict {
    /// True if the object was lifted, shaken and still held.
    pub(super) held: bool,
    /// Reason of a failure.
    pub(super) reason: String,
}

/// Processes of the judge, one for each trial that runs at a time.
#[derive(Debug, Default)]
pub(super) struct MujocoJudge {
    idle: Mutex<Vec<JudgeProcess>>,
}

#[derive(Debug)]
struct JudgeProcess {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

impl MujocoJudge {
    /// Asks about a grasp of an object of a world.
    ///
    /// # Errors
    /// When the judge cannot be started, which is told with the exit code 4, or does not answer.
    pub(super) fn judge(
        &self,
        world: &World,
        object: u16,
        gripper: &GripperModel,
        grasp: &JudgedGrasp,
    ) -> Result<Verdict, Failure> {
        let mut process = match self.idle.lock().ok().and_then(|mut idle| idle.pop()) {
            Some(process) => process,
            None => JudgeProcess::start()?,
        };
        process.ask(&world_document(world, gripper, grasp.friction))?;
        let answer = process.ask(&json!({"grasp": {
            "pose": pose(&grasp.world_from_tool),
            "opening_m": grasp.opening_m,
            "approach_m": grasp.approach_m,
            "target": object,
        }}))?;
        if let Ok(mut idle) = self.idle.lock() {
            idle.push(process);
        }
        serde_json::from_value(answer).map_err(Failure::general)
    }
}

impl JudgeProcess {
    fn start() -> Result<Self, Failure> {
        if !Path::new(PROGRAM).is_file() {
            return Err(Failure::usage(format!(
                "the judge {PROGRAM} is not there; run this in the folder of the project's sources"
            )));
        }
        let mut command = Command::new(PROGRAM);
        command
            .arg("--serve")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        let mut child = command
            .spawn()
            .map_err(|error| Failure::general(format!("{PROGRAM} cannot be started: {error}")))?;
        let pipes = child.stdin.take().zip(child.stdout.take());
        let (to, from) = pipes.ok_or_else(|| Failure::general("the judge has no pipes"))?;
        let from = BufReader::new(from);
        Ok(Self { child, to, from })
    }

    /// Answer to a document.
    fn ask(&mut self, document: &Value) -> Result<Value, Failure> {
        let mut line = String::new();
        let asked = writeln!(self.to, "{document}").and_then(|()| self.to.flush());
        let answered = asked.and_then(|()| self.from.read_line(&mut line));
        if answered.is_err() || line.is_empty() {
            let status = self.child.wait().map_err(Failure::general)?;
            if status.code() == Some(SKIPPED) {
                let sentence = "the judge by MuJoCo cannot be had here; see the line before";
                return Err(Failure::new(exit_code::REFUSED, sentence));
            }
            return Err(Failure::general(format!(
                "the judge {PROGRAM} ended: {status}"
            )));
        }
        let answer: Value = serde_json::from_str(&line).map_err(Failure::general)?;
        match answer.get("error").and_then(Value::as_str) {
            Some(error) => Err(Failure::general(format!(
                "the judge could not judge: {error}"
            ))),
            None => Ok(answer),
        }
    }
}

impl Drop for JudgeProcess {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn world_document(world: &World, gripper: &GripperModel, friction: f64) -> Value {
    let objects: Vec<Value> = world
        .objects()
        .iter()
        .map(|object| {
            let parts = object.model.convex_parts.iter();
            let parts: Vec<Vec<[f32; 3]>> = parts
                .map(|part| part.points.iter().map(|point| (*point).into()).collect())
                .collect();
            json!({
                "id": object.id,
                "parts": parts,
                "pose": pose(&object.world_from_object),
                "density_kg_m3": DENSITY_KG_M3,
                "friction": object.model.friction,
            })
        })
        .collect();
    json!({"world": {
        "table_m": world.scene().table.height_m,
        "objects": objects,
        "gripper": {
            "max_opening_m": gripper.max_opening_m,
            "pad_length_m": gripper.pad_length_m,
            "pad_width_m": gripper.pad_width_m,
            "pad_thickness_m": gripper.pad_thickness_m,
            "finger_thickness_m": gripper.finger_thickness_m,
            "palm_m": gripper.palm_m,
            "opening_speed_m_s": gripper.opening_speed_m_s,
            "closing_force_n": gripper.closing_force_n,
            "pad_friction": friction,
        },
    }})
}

/// Pose as x, y, z and the quaternion x, y, z, w.
fn pose(pose: &RigidTransform) -> [f64; 7] {
    let (t, r) = (&pose.translation, &pose.rotation.coords);
    [t.x, t.y, t.z, r.x, r.y, r.z, r.w]
}
