//! Integration tests: real processes and shared memory, each test in its own domain. A
//! test ends only processes that it has started.
#![cfg(test)]

/// Test sandbox with a daemon.
mod daemon;
/// Recorder of all messages of a topic.
mod recorder;

/// Conformance of drivers of an arm.
mod arm_conformance;
mod arm_stop;
/// Invalid input is refused with a sentence.
mod bad_input;
/// Batch learning of a folder of labelled views.
mod batch_learning;
/// Raw images of the camera.
mod camera_images;
/// Chaos test: faults drawn at random, and recovery from each.
mod chaos;
/// Command line: documents, choice of the daemon, other accounts, the doctor.
mod command_line;
/// Options of every command: used, or refused.
mod common_options;
/// Layers of the configuration, its commands, and its reload.
mod configuration;
/// Demonstrations of the robot, which repeat to the byte.
mod demonstrations;
/// Links of the documents, in the repository and in the package.
mod document_links;
/// Commands in the documents: they exist, with their options.
mod documented_commands;
/// Documents in pages, and models of objects.
mod documents;
/// Upgrade from an earlier version.
mod earlier_versions;
/// Recordings played through the real libfreenect.
mod fakenect;
/// Processes that are killed, stopped, or cannot start.
mod faults;
/// One writer of the files that users name.
mod file_writers;
/// A disk without room.
mod full_disk;
mod gateway;
/// Planned grasps.
mod grasping;
/// Hostile clients of the control socket.
mod hostile_clients;
/// Language rules of headlines and type names.
mod language;
/// Latency measurement, budgets, sweep and soak.
mod latency;
/// Crates name only crates of lower layers; foreign libraries have owners.
mod layering;
/// Liveness of sensor and scene: age, staleness, outages in place, backed shared memory.
mod liveness;
/// Bitwise determinism of lockstep runs.
mod lockstep;
/// Memory maintenance: history, export, import, verification, repair.
mod memory_care;
/// Durability of the memory under random kills.
mod memory_kill;
/// Object models that grow beside a running daemon.
mod model_building;
/// Judge of grasps by MuJoCo.
mod mujoco_judge;
/// Names of categories: normal form, invisible characters, look-alikes.
mod names;
/// Sentences that say what to do next: candidates, swapped arguments, nearest names.
mod next_steps;
/// Labels of the objects that a change of the memory is not about.
mod other_labels;
/// Panics of one object's actor: supervision and restart limit.
mod panics;
/// Read-your-writes consistency of answers.
mod read_your_writes;
/// Session of the README, as it is written.
mod readme_session;
/// Real scenes: recognition after a restart, static tracks under a moving camera.
mod real_scenes;
/// Recordings of a running daemon.
mod recordings;
/// Registered colour and depth images of any size.
mod registered_images;
/// Replay of recordings in lockstep.
mod replay;
/// Accounts and roles of users.
mod roles;
/// Notifications to systemd.
mod service_notifications;
/// Simulated table: ground truth, arm, person, recordings.
mod simulation;
/// Walking skeleton: start, teach, restart, recognise, stop.
mod skeleton;
/// Standard output: failed writes, closed pipes.
mod standard_output;
/// Two hundred tracks at once.
mod stress;
/// Supervision of processes: hangs, endless restarts, expected processes.
mod supervision;

/// Faults of tasks, in lockstep.
mod task_faults;
mod tasks;
/// Undo and redo through all kinds of changes.
mod undo;
/// systemd units: accepted, hardened, restarted for ever.
mod units;
/// Next best views beside a running daemon.
mod view_planning;
/// Working memory: facts, events and tasks survive a kill.
mod world_memory;
/// Zero-copy transport: the cloud is written once.
mod zero_copy;
