//! Integration tests: real processes, real shared memory, each test in a domain
//! of its own, cleaned up afterwards. A test ends only processes it has started.
#![cfg(test)]

/// A daemon of a test's own.
mod daemon;
/// Folders of real data.
mod real_data;
/// Every message of a topic, recorded.
mod recorder;

/// Input that is refused with a sentence, while the daemon goes on.
mod bad_input;
/// A folder of labelled views is learned.
mod batch_learning;
/// Documents, the choice of the daemon, other accounts, the doctor.
mod command_line;
/// A recording played through the real libfreenect.
mod fakenect;
/// Processes that are killed, stopped, or can not start.
mod faults;
/// Where the milliseconds go: the measuring program.
mod latency;
/// Crates name only crates of lower layers; foreign libraries have owners.
mod language;
mod layering;
/// Runs in lockstep repeat each other to the bit.
mod lockstep;
/// The memory is looked into, taken care of, given to another robot.
mod memory_care;
/// The memory is killed while people teach.
mod memory_kill;
/// Panics of one object's actor: the others lose nothing, too many end the process.
mod panics;
/// Answers include every change that was acknowledged before the question.
mod read_your_writes;
/// Real scenes: known again after a restart, steady while the camera moves.
mod real_scenes;
/// The simulated table: truth, arm, person, recordings.
mod simulation;
/// Start, see, teach, restart, recognise, stop.
mod skeleton;
/// Many tracks at once.
mod stress;
/// The working memory: facts, events, tasks, kept through a kill.
mod world_memory;
/// The cloud is written once, and nobody allocates a frame's worth.
mod zero_copy;
