//! `tabula-lab`: experiments, simulated recordings, and learning from folders of views.

use clap::{Parser, Subcommand};
use command_line::Output;
use experiments::arguments::{
    AgeMemoryArguments, DemoVerb, EvaluateVerb, ExamplesArguments, LearnArguments, SimulateVerb,
    SweepArguments,
};
use service::{CommonArguments, Failure, OptionUse};
use std::process::ExitCode;

/// The laboratory of tabula: experiments with its kernels, simulated recordings,
/// and learning from folders of views.
#[derive(Debug, Parser)]
#[command(name = "tabula-lab", version, propagate_version = true)]
struct LabArguments {
    #[command(flatten)]
    common: CommonArguments,

    /// Print one JSON document instead of text
    #[arg(long, global = true, help_heading = "Common options")]
    json: bool,

    #[command(subcommand)]
    verb: Verb,
}

/// Subcommands of `tabula-lab`.
#[derive(Debug, Subcommand)]
enum Verb {
    /// Learn a folder of labelled views
    Learn(LearnArguments),
    /// Write recordings and views of the simulated table; needs no daemon
    Simulate {
        /// Kind of the simulated output
        #[command(subcommand)]
        verb: SimulateVerb,
    },
    /// Measure how good and how fast the kernels are; needs no daemon
    Evaluate {
        /// Evaluation to perform
        #[command(subcommand)]
        verb: EvaluateVerb,
    },
    /// Demonstrate the robot in simulated scenes, in a daemon of its own
    Demo {
        /// Demonstration to perform
        #[command(subcommand)]
        verb: DemoVerb,
    },
    /// Write the examples from which a model of perception is trained
    Examples(ExamplesArguments),
    /// Measure how sensitive scores are to tuned constants; needs the source tree and cargo
    Sweep(SweepArguments),
    /// Make years of changes to a new perceptual memory in simulated time, and measure its opening
    AgeMemory(AgeMemoryArguments),
}

impl Verb {
    /// Use of the options of every command. An experiment has the built-in settings, so that its
    /// figures are the same everywhere; `sweep` varies them.
    fn option_use(&self) -> OptionUse {
        match self {
            Self::Learn(_) => OptionUse::Daemon,
            Self::Simulate { .. }
            | Self::Evaluate { .. }
            | Self::Demo { .. }
            | Self::Examples(_)
            | Self::Sweep(_)
            | Self::AgeMemory(_) => OptionUse::Nothing,
        }
    }
}

fn main() -> ExitCode {
    let arguments: LabArguments = service::parse_arguments();
    let output = Output::new(arguments.json);
    output.exit_code(execute(&arguments, &output))
}

fn execute(arguments: &LabArguments, output: &Output) -> Result<ExitCode, Failure> {
    arguments.common.check_use(arguments.verb.option_use())?;
    match &arguments.verb {
        Verb::Learn(folder) => experiments::learn_folder::run(&arguments.common, folder, output),
        Verb::Simulate { verb } => experiments::simulate::run(verb, output),
        Verb::Evaluate { verb } => experiments::evaluate::run(verb, output),
        Verb::Demo { verb } => experiments::demo::run(verb, output),
        Verb::Examples(model) => experiments::training_examples::run(model, output),
        Verb::Sweep(sweep) => experiments::sweep::run(sweep, output),
        Verb::AgeMemory(ageing) => experiments::age_memory::run(ageing, output),
    }
}
