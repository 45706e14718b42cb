//! Process life cycle: set-up, signals, shutdown, exit code.

use crate::health_reporter::HealthReporter;
use crate::home::set_private_umask;
use crate::reload::{ConfigPlace, Reloader};
use crate::service_manager::{clear_readiness_marker, has_been_ready};
use crate::shutdown::on_signals;
use crate::{
    Configuration, Context, Failure, HealthCounters, Home, LiveConfig, ProcessArguments, Shutdown,
    guest_places, start_log,
};
use channel::{Domain, Role, RunFolder};
use message::ProcessKind;
use rustix::process::{
    Resource, Rlimit, Signal, getppid, getrlimit, set_parent_process_death_signal, setrlimit,
};
use std::future::Future;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

/// Time limit of the tasks that are left when the process has stopped; then it ends without them.
const STOP_TIME: Duration = Duration::from_secs(4);

/// Purpose for which a process checks its configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Check only: the process ends then.
    Check,
    /// Start of the process.
    Start,
    /// Reload by the running process.
    Reload,
}

/// Runs a process from its arguments to its exit code: log, configuration, domain,
/// health, signals, and in between `body`, which returns when `context.shutdown` is
/// requested, or with a failure.
///
/// `check` turns the configuration into the process's own; with `--check-config` nothing else
/// happens. It is called again at each reload, at SIGHUP, and its result replaces the live
/// configuration that `body` has.
pub fn run<C, F>(
    process: ProcessKind,
    arguments: &ProcessArguments,
    mut check: impl FnMut(&Configuration, Purpose) -> Result<C, Failure> + Send + 'static,
    body: impl FnOnce(Context, LiveConfig<C>) -> F,
) -> ExitCode
where
    C: Send + Sync + 'static,
    F: Future<Output = Result<(), Failure>> + Send + 'static,
{
    start_log();
    let common = &arguments.common;
    if arguments
        .follow_parent
        .is_some_and(|parent| !stop_with_parent(parent))
    {
        return ExitCode::SUCCESS;
    }
    let home = common.home();
    let purpose = if arguments.check_config {
        Purpose::Check
    } else {
        Purpose::Start
    };
    let configured = Configuration::find(common.config.as_deref(), home.path())
        .map_err(Failure::from)
        .and_then(|found| Ok((check(&found, purpose)?, found)));
    let outcome = match configured {
        Ok(_) if arguments.check_config => Ok(()),
        Ok((config, found)) => {
            let check = move |found: &Configuration| check(found, Purpose::Reload);
            live(process, arguments, home, (found, config, check), body)
        }
        Err(failure) if arguments.check_config => {
            print_refusal(process, &failure);
            return ExitCode::from(failure.code);
        }
        Err(failure) => Err(failure),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let failure = failure.after_readiness(has_been_ready());
            tracing::error!("{failure}");
            ExitCode::from(failure.code)
        }
    }
}

/// Prints why a configuration is refused; `tabula` reads the sentence behind the program's name.
#[expect(clippy::print_stderr, reason = "a check has an answer, and no log")]
fn print_refusal(process: ProcessKind, failure: &Failure) {
    eprintln!("{}: {failure}", process.program());
}

fn live<C, F>(
    process: ProcessKind,
    arguments: &ProcessArguments,
    home: Home,
    started: (
        Configuration,
        C,
        impl FnMut(&Configuration) -> Result<C, Failure> + Send + 'static,
    ),
    body: impl FnOnce(Context, LiveConfig<C>) -> F,
) -> Result<(), Failure>
where
    C: Send + Sync + 'static,
    F: Future<Output = Result<(), Failure>> + Send + 'static,
{
    set_private_umask();
    raise_descriptor_limit();
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .thread_name(process.word())
        .enable_all()
        .build()
        .map_err(|error| Failure::general(format!("could not start the runtime: {error}")))?;
    let outcome = runtime.block_on(async {
        let program = process.program();
        let common = &arguments.common;
        let domain = Domain::join_with(
            &common.domain,
            &RunFolder::of_user(),
            Role::Only(&program),
            guest_places(&started.0)?,
        )?;
        tracing::info!(
            "{program} {} started: domain {}, data {}, configuration {}",
            env!("CARGO_PKG_VERSION"),
            domain.name(),
            home.path().display(),
            started.0.origin(),
        );
        let (trigger, shutdown) = Shutdown::new();
        on_signals(trigger.clone())
            .map_err(|error| Failure::general(format!("could not listen for signals: {error}")))?;
        let health = Arc::new(HealthCounters::default());
        let place = ConfigPlace {
            given: common.config.clone(),
            home: home.path().to_owned(),
        };
        let parent = arguments.follow_parent;
        let (reloader, live) =
            Reloader::new(&domain, process, place, parent, started, health.clone())?;
        let reloader = tokio::spawn(reloader.run(trigger.clone(), shutdown.clone()));
        let reporter = HealthReporter::new(&domain, process, health.clone())?;
        let reporter = tokio::spawn(reporter.run(shutdown.clone()));
        // On a reactor thread, which is the first to see new messages; this thread
        // would have to be woken by it.
        let context = Context {
            process,
            domain,
            home,
            shutdown,
            health,
        };
        let outcome = tokio::spawn(body(context, live)).await;
        let outcome = outcome.unwrap_or_else(|lost| std::panic::resume_unwind(lost.into_panic()));
        if trigger.is_requested() {
            clear_readiness_marker();
        }
        trigger.request();
        let _ = tokio::join!(reporter, reloader);
        tracing::info!("{program} stopped");
        outcome
    });
    runtime.shutdown_timeout(STOP_TIME);
    outcome
}

/// Requests a stop of this process when its parent ends in any way (parent-death
/// signal). `false` when the parent has ended already.
pub fn stop_with_parent(parent: u32) -> bool {
    if let Err(error) = set_parent_process_death_signal(Some(Signal::TERM)) {
        tracing::warn!("this process will not notice the end of its parent: {error}");
    }
    getppid().is_some_and(|pid| pid.as_raw_nonzero().get().cast_unsigned() == parent)
}

/// Raises the soft limit of open files: each service with its ports holds about seven
/// descriptors, which the usual limit of 1024 does not fit.
fn raise_descriptor_limit() {
    let limit = getrlimit(Resource::Nofile);
    let wanted = Rlimit {
        current: limit.maximum,
        maximum: limit.maximum,
    };
    if setrlimit(Resource::Nofile, wanted).is_err() {
        tracing::warn!(
            "could not raise the limit of open files; `tabula doctor` says if it is enough"
        );
    }
}
