//! Experiments that run the perception kernels over recorded and simulated data.
//!
//! [`evaluate`] scores detection, tracking and recognition; [`simulate`] writes recordings and
//! single-object views of the simulated table; [`learn_folder`] teaches a folder of labelled views
//! to a running daemon; [`sweep`] measures how sensitive the scores are to a tuned constant;
//! [`training_examples`] writes those from which the models of perception are trained;
//! [`demo`] demonstrates the robot in a daemon of its own;
//! [`age_memory`] makes years of changes to a perceptual memory. The arguments of each experiment
//! are in [`arguments`]; the program `tabula-lab` parses them.
//!
//! Invariants: nothing of a running daemon depends on this crate; the same
//! arguments and seeds give the same documents, durations aside.
//!
//! ```
//! use command_line::Output;
//! use experiments::arguments::SimulateVerb;
//!
//! // Print the generated categories as one JSON document.
//! let output = Output::new(true);
//! assert!(experiments::simulate::run(&SimulateVerb::Categories, &output).is_ok());
//! ```

pub mod age_memory;
pub mod arguments;
pub mod demo;
pub mod evaluate;
pub mod learn_folder;
pub mod simulate;
pub mod sweep;
pub mod training_examples;

mod csv;
mod frame_detector;
mod metric_views;
mod output_files;
mod parallel;
mod timing;
