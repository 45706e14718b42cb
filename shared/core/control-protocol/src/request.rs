//! Table of all requests: the command, the type of its reply, the owner that answers it, and the
//! least role that may send it.
//!
//! A row makes a function that returns the request; whoever sends it gets the reply in its own
//! type. Owner and role of a [`Command`] are read from the same row, so that a command without a
//! row does not compile.

use crate::{
    ArmCommand, ArmLease, ArmMotion, ArmReport, ChangesPage, Command, DepthNoiseReport,
    DocumentName, DocumentPage, DocumentReport, DocumentVersionReport, FactFilter, FindQuery,
    FindReport, HistoryReport, ImportCompletion, JobCommand, JobKind, JobReport, Labelling,
    LearningReport, MemoryAnswer, MemoryQuery, MemoryStats, MutationId, PageRequest,
    QuestionsReport, RecordedStep, Refusal, RefusalKind, ReloadReport, Reply, Revision,
    SnapshotCursor, SnapshotPage, StoredView, TaskCommand, TaskOrder, TaskOutcome, TaskReport,
    UserRole, ViewId, ViewReport, WorldCommand, WorldReply,
};
use process_registry::ProcessKind;
use scene_document::{
    CategoryDocument, EventsDocument, FactsDocument, HealthDocument, ObjectDocument, SceneDocument,
    TaskDocument, TasksDocument, WorldDocument,
};
use serde_bytes::ByteBuf;

/// Request with the type of its reply.
#[derive(Debug, Clone)]
pub struct TypedRequest<T> {
    command: Command,
    value: fn(Reply) -> Result<T, Box<Reply>>,
}

impl<T> TypedRequest<T> {
    /// Command of the request, to be sent.
    pub fn command(&self) -> &Command {
        &self.command
    }

    /// Value of a received reply.
    ///
    /// # Errors
    /// The refusal of the request. A reply to another command is one, too: the two ends do not
    /// speak the same protocol.
    pub fn read(&self, reply: Reply) -> Result<T, Refusal> {
        if let Reply::Refused(refusal) = reply {
            return Err(refusal);
        }
        (self.value)(reply).map_err(|other| {
            let sentence = format!(
                "the daemon answered something else: {other:?}; use the tabula of its version"
            );
            Refusal::new(RefusalKind::Internal, sentence)
        })
    }
}

/// Access to a command: who answers it, and who may send it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CommandAccess {
    /// Process that answers the command.
    pub owner: ProcessKind,
    /// Least role that may send the command.
    pub role: UserRole,
}

macro_rules! requests {
    ($($owner:ident, $role:ident: $(#[$doc:meta])* $name:ident($($arg:ident: $type:ty),*) -> $value_type:ty
        = [$($command:tt)+] => [$reply:pat => $value:expr];)+) => {
        $($(#[$doc])*
        pub fn $name($($arg: $type),*) -> TypedRequest<$value_type> {
            TypedRequest {
                command: $($command)+,
                value: |reply| match reply {
                    $reply => Ok($value),
                    other => Err(Box::new(other)),
                },
            }
        })+

        impl Command {
            /// Owner of the command, and the least role that may send it.
            #[allow(unused_variables, reason = "the rows name the fields of their commands")]
            pub fn access(&self) -> CommandAccess {
                match self {
                    $($($command)+ => CommandAccess { owner: ProcessKind::$owner, role: UserRole::$role },)+
                    Command::ReadAfter { command, .. } => command.access(),
                }
            }
        }

        /// All rows: the command as it is written here, its owner and its role.
        pub const ROWS: &[(&str, CommandAccess)] = &[
            $((
                stringify!($($command)+),
                CommandAccess { owner: ProcessKind::$owner, role: UserRole::$role },
            )),+
        ];
    };
}

requests! {
    PERCEPTION, Reader:
    /// Lists all tracked objects.
    objects() -> SceneDocument = [Command::Objects] => [Reply::Objects(scene) => *scene];

    PERCEPTION, Reader:
    /// Reports one tracked object.
    ask(track_id: u64) -> ObjectDocument
        = [Command::Ask { track_id }] => [Reply::Object(object) => *object];

    PERCEPTION, Reader:
    /// Asks about the object whose name would teach most.
    question() -> QuestionsReport
        = [Command::Question] => [Reply::Question(question) => question];

    MEMORY, Reader:
    /// Finds objects by words.
    find(query: FindQuery) -> FindReport
        = [Command::Find(query)] => [Reply::Found(report) => *report];

    GATEWAY, Reader:
    /// Reports the health of all processes.
    health() -> Vec<HealthDocument>
        = [Command::Health] => [Reply::Health(reports) => reports];

    PERCEPTION, Reader:
    /// Reports the depth noise measured on the table.
    depth_noise() -> DepthNoiseReport
        = [Command::DepthNoise] => [Reply::DepthNoise(report) => report];

    GATEWAY, Administrator:
    /// Lets all processes read the configuration again.
    reload_configuration() -> Vec<ReloadReport>
        = [Command::ReloadConfiguration] => [Reply::Reloaded(reports) => reports];

    MEMORY, Teacher:
    /// Labels a track that has no other label.
    teach(labelling: Labelling) -> LearningReport
        = [Command::Teach(labelling)] => [Reply::Learned(report) => report];

    MEMORY, Teacher:
    /// Labels a track, replacing any label it has.
    correct(labelling: Labelling) -> LearningReport
        = [Command::Correct(labelling)] => [Reply::Learned(report) => report];

    MEMORY, Teacher:
    /// Forgets a category; its views are kept without a label.
    forget(id: MutationId, author: String, category: String) -> LearningReport
        = [Command::Forget { id, author, category }] => [Reply::Learned(report) => report];

    MEMORY, Teacher:
    /// Revises the perceptual memory other than by teaching.
    revise(revision: Revision) -> LearningReport
        = [Command::Revise(revision)] => [Reply::Learned(report) => report];

    MEMORY, Reader:
    /// Lists the learned categories.
    categories() -> Vec<CategoryDocument>
        = [Command::Categories] => [Reply::Categories(categories) => categories];

    MEMORY, Reader:
    /// Reports sizes and counts of the perceptual memory.
    stats() -> MemoryStats
        = [Command::Memory(MemoryQuery::Stats)]
        => [Reply::Memory(MemoryAnswer::Stats(stats)) => stats];

    MEMORY, Reader:
    /// Reads one page of stored views, ordered by id, and the last view of it if there are more.
    views(category: Option<String>, track_id: Option<u64>, after: Option<ViewId>)
        -> (Vec<ViewReport>, Option<ViewId>)
        = [Command::Memory(MemoryQuery::Views { category, track_id, after })]
        => [Reply::Memory(MemoryAnswer::Views { views, next }) => (views, next)];

    MEMORY, Reader:
    /// Reads one page of the history, and the sequence number of its last entry.
    history(from: Option<u64>, max: u32) -> (Vec<HistoryReport>, u64)
        = [Command::Memory(MemoryQuery::History { from, max })]
        => [Reply::Memory(MemoryAnswer::History { entries, last_sequence })
            => (entries, last_sequence)];

    MEMORY, Reader:
    /// Reads one page of the stored documents, and the last document of it if there are more.
    documents(after: Option<DocumentName>) -> (Vec<DocumentReport>, Option<DocumentName>)
        = [Command::Memory(MemoryQuery::Documents { after })]
        => [Reply::Memory(MemoryAnswer::Documents { documents, next }) => (documents, next)];

    MEMORY, Reader:
    /// Reads one page of the content of a document.
    document(page: PageRequest) -> DocumentPage
        = [Command::Memory(MemoryQuery::Document(page))]
        => [Reply::Memory(MemoryAnswer::Document(page)) => page];

    MEMORY, Reader:
    /// Lists the versions of a document that the memory keeps, oldest first.
    document_versions(name: DocumentName) -> Vec<DocumentVersionReport>
        = [Command::Memory(MemoryQuery::DocumentVersions(name))]
        => [Reply::Memory(MemoryAnswer::DocumentVersions(versions)) => versions];

    MEMORY, Teacher:
    /// Starts a verification of the whole store.
    verify() -> JobReport
        = [Command::Job(JobCommand::Begin(JobKind::Verify))] => [Reply::Job(report) => report];

    MEMORY, Administrator:
    /// Starts a repair of the store.
    repair() -> JobReport
        = [Command::Job(JobCommand::Begin(JobKind::Repair))] => [Reply::Job(report) => report];

    MEMORY, Administrator:
    /// Starts the purge of what was forgotten some time ago, and compacts the files.
    compact(forgotten_for_s: u64) -> JobReport
        = [Command::Job(JobCommand::Begin(JobKind::Compact { forgotten_for_s }))]
        => [Reply::Job(report) => report];

    MEMORY, Teacher:
    /// Starts an export of the whole memory.
    export() -> JobReport
        = [Command::Job(JobCommand::Begin(JobKind::Export))] => [Reply::Job(report) => report];

    MEMORY, Administrator:
    /// Starts the upload of an exported file.
    import() -> JobReport
        = [Command::Job(JobCommand::Begin(JobKind::Import))] => [Reply::Job(report) => report];

    MEMORY, Teacher:
    /// Starts the upload of the content of a document.
    upload_document() -> JobReport
        = [Command::Job(JobCommand::Begin(JobKind::Document))] => [Reply::Job(report) => report];

    MEMORY, Reader:
    /// Reports the progress of a job.
    job(job: u64) -> JobReport
        = [Command::Job(JobCommand::Ask { job })] => [Reply::Job(report) => report];

    MEMORY, Teacher:
    /// Reads the next bytes of an export; none when none are ready yet.
    read_job(job: u64, offset: u64) -> Vec<u8>
        = [Command::Job(JobCommand::Read { job, offset })]
        => [Reply::JobBytes { bytes } => bytes];

    MEMORY, Teacher:
    /// Writes the next bytes of an import or of a document. A job is followed by whoever began it:
    /// so bytes of an import are written by administrators alone.
    write_job(job: u64, offset: u64, bytes: Vec<u8>) -> JobReport
        = [Command::Job(JobCommand::Write { job, offset, bytes })]
        => [Reply::Job(report) => report];

    MEMORY, Administrator:
    /// Completes an import whose bytes are all written.
    complete_import(completion: ImportCompletion) -> JobReport
        = [Command::Job(JobCommand::Import(completion))]
        => [Reply::Job(report) => report];

    ARM, Reader:
    /// Reports the state of the arm.
    arm() -> ArmReport
        = [Command::Arm(ArmCommand::State)] => [Reply::Arm(report) => report];

    ARM, Teacher:
    /// Begins or renews a lease of the arm.
    hold_arm(lease: ArmLease) -> ArmReport
        = [Command::Arm(ArmCommand::Hold(lease))] => [Reply::Arm(report) => report];

    ARM, Teacher:
    /// Ends a lease of the arm.
    release_arm(lease: u64) -> ArmReport
        = [Command::Arm(ArmCommand::Release { lease })] => [Reply::Arm(report) => report];

    ARM, Teacher:
    /// Begins or renews a lease, and moves the arm.
    move_arm(lease: ArmLease, motion: ArmMotion) -> ArmReport
        = [Command::Arm(ArmCommand::Move { lease, motion })] => [Reply::Arm(report) => report];

    EXECUTIVE, Reader:
    /// Reports the running task, or the last one.
    task_state() -> TaskReport
        = [Command::Task(TaskCommand::State)] => [Reply::Task(report) => *report];

    EXECUTIVE, Reader:
    /// Tells what a task would do with the table as it is.
    preview_task(order: TaskOrder) -> TaskReport
        = [Command::Task(TaskCommand::Preview(order))] => [Reply::Task(report) => *report];

    EXECUTIVE, Teacher:
    /// Starts a task.
    order_task(id: MutationId, author: String, order: TaskOrder) -> TaskReport
        = [Command::Task(TaskCommand::Start { id, author, order })]
        => [Reply::Task(report) => *report];

    EXECUTIVE, Teacher:
    /// Lets a task wait.
    pause_task(task_id: u64) -> TaskReport
        = [Command::Task(TaskCommand::Pause { task_id })] => [Reply::Task(report) => *report];

    EXECUTIVE, Teacher:
    /// Lets a task go on.
    resume_task(task_id: u64) -> TaskReport
        = [Command::Task(TaskCommand::Resume { task_id })] => [Reply::Task(report) => *report];

    EXECUTIVE, Teacher:
    /// Cancels a task.
    cancel_task(task_id: u64) -> TaskReport
        = [Command::Task(TaskCommand::Cancel { task_id })] => [Reply::Task(report) => *report];

    ARM, Reader:
    /// Stops the arm immediately; open to everybody.
    stop_arm() -> ArmReport
        = [Command::Arm(ArmCommand::Stop)] => [Reply::Arm(report) => report];

    MEMORY, Reader:
    /// Reports the present objects and the robot.
    world() -> WorldDocument
        = [Command::World(WorldCommand::Now)]
        => [Reply::World(WorldReply::Now(world)) => *world];

    MEMORY, Reader:
    /// Reads one page of facts, newest first.
    facts(filter: FactFilter) -> FactsDocument
        = [Command::World(WorldCommand::Facts(filter))]
        => [Reply::World(WorldReply::Facts(facts)) => facts];

    MEMORY, Reader:
    /// Reads the events after a sequence number, oldest first, or waits for the next one.
    events(since: u64, wait_ms: u64) -> EventsDocument
        = [Command::World(WorldCommand::Events { since, wait_ms })]
        => [Reply::World(WorldReply::Events(events)) => events];

    MEMORY, Reader:
    /// Reads one page of tasks, newest first.
    tasks(before: Option<u64>, limit: u32) -> TasksDocument
        = [Command::World(WorldCommand::Tasks { before, limit })]
        => [Reply::World(WorldReply::Tasks(tasks)) => tasks];

    MEMORY, Reader:
    /// Reads one task with all its steps and their plans.
    task(task_id: u64) -> TaskDocument
        = [Command::World(WorldCommand::Task { task_id })]
        => [Reply::World(WorldReply::Task(task)) => *task];

    MEMORY, Teacher:
    /// Records the start of a task.
    start_task(id: MutationId, kind: String, parameters: String, author: String) -> TaskDocument
        = [Command::World(WorldCommand::StartTask { id, kind, parameters, author })]
        => [Reply::World(WorldReply::Task(task)) => *task];

    MEMORY, Teacher:
    /// Records the end of a task.
    end_task(id: MutationId, task_id: u64, outcome: TaskOutcome, reason: String) -> TaskDocument
        = [Command::World(WorldCommand::EndTask { id, task_id, outcome, reason })]
        => [Reply::World(WorldReply::Task(task)) => *task];

    MEMORY, Teacher:
    /// Records a step of a running task, or another content of its newest step.
    record_step(task_id: u64, step: RecordedStep) -> TaskDocument
        = [Command::World(WorldCommand::RecordStep { task_id, step })]
        => [Reply::World(WorldReply::Task(task)) => *task];

    MEMORY, Teacher:
    /// Leases a block of track-ids that are never issued again; returns the first of them.
    lease_track_ids(count: u32) -> u64
        = [Command::LeaseTrackIds { count }] => [Reply::TrackIds { first } => first];

    MEMORY, Teacher:
    /// Stores key views durably.
    store_views(id: MutationId, views: Vec<StoredView>) -> ()
        = [Command::StoreViews { id, views }] => [Reply::Stored => ()];

    MEMORY, Administrator:
    /// Reads one page of all labelled views.
    snapshot(after: Option<SnapshotCursor>) -> SnapshotPage
        = [Command::Snapshot { after }] => [Reply::Snapshot(page) => page];

    MEMORY, Administrator:
    /// Reads the stored clouds of the first of the views, as many as fit.
    clouds(ids: Vec<ViewId>) -> Vec<ByteBuf>
        = [Command::Clouds { ids }] => [Reply::Clouds(clouds) => clouds];

    MEMORY, Administrator:
    /// Reads the changes of learned views since a sequence number of the history.
    changes(store_id: u128, since: u64) -> ChangesPage
        = [Command::Changes { store_id, since }] => [Reply::Changes(page) => page];
}
