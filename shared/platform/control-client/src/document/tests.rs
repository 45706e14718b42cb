use super::*;
use control_protocol::{JobCommand, JobKind, MemoryAnswer, MemoryQuery, Refusal};

/// Memory with one document, whose content other clients replace and whose pages may be cut.
struct FakeMemory {
    contents: Vec<Vec<u8>>,
    /// Number of pages after which the next content takes the place of the first one.
    pages_of_a_version: usize,
    n_pages: usize,
    page_bytes: usize,
}

impl FakeMemory {
    fn with(contents: Vec<Vec<u8>>, pages_of_a_version: usize) -> Self {
        Self {
            contents,
            pages_of_a_version,
            n_pages: 0,
            page_bytes: 10,
        }
    }

    fn answer(&mut self, command: Command) -> Reply {
        let Command::Memory(MemoryQuery::Document(request)) = command else {
            panic!("{command:?}")
        };
        if self.n_pages == self.pages_of_a_version && self.contents.len() > 1 {
            self.contents.remove(0);
            self.n_pages = 0;
        }
        self.n_pages += 1;
        let content = &self.contents[0];
        let digest = ContentDigest::of(content);
        if request.digest.is_some_and(|wanted| wanted != digest) {
            let refusal = Refusal::new(RefusalKind::Conflict, "it was replaced");
            return Reply::Refused(refusal);
        }
        let rest = &content[request.offset as usize..];
        Reply::Memory(MemoryAnswer::Document(DocumentPage {
            document: DocumentReport {
                document: request.document,
                media_type: "text/plain".into(),
                bytes: content.len() as u64,
                digest,
                author: "anna".into(),
                decided_ns: 1,
                sequence: 1,
            },
            offset: request.offset,
            content: rest[..rest.len().min(self.page_bytes)].to_vec(),
        }))
    }

    fn read(&mut self) -> Result<StoredDocument, Failure> {
        read_document(&name(), |command| Ok(self.answer(command)))
    }
}

fn name() -> DocumentName {
    DocumentName {
        kind: DocumentKind::ObjectModel,
        name: "mug".into(),
    }
}

#[test]
fn document_is_read_page_by_page() {
    for n_bytes in [0, 1, 9, 10, 11, 20, 95] {
        let content: Vec<u8> = (0..n_bytes).collect();
        let mut memory = FakeMemory::with(vec![content.clone()], 1);
        let document = memory.read().unwrap();
        assert_eq!(document.content, content);
        assert_eq!(document.report.media_type, "text/plain");
    }
}

#[test]
fn replaced_document_is_read_again_and_never_mixed() {
    let (old, new) = (vec![1; 35], vec![2; 35]);
    for pages in 1..=3 {
        let mut memory = FakeMemory::with(vec![old.clone(), new.clone()], pages);
        assert_eq!(memory.read().unwrap().content, new, "{pages}");
    }
}

#[test]
fn document_that_is_always_replaced_is_refused() {
    let contents = (0..50).map(|version| vec![version; 35]).collect();
    let failure = FakeMemory::with(contents, 1).read().unwrap_err();
    assert_eq!(failure.code, exit_code::REFUSED);
    assert!(failure.sentence.contains("replaced"), "{failure}");
}

#[test]
fn reading_ends_when_the_memory_gives_no_more_bytes() {
    let mut memory = FakeMemory::with(vec![vec![1; 35]], 1);
    memory.page_bytes = 0;
    let failure = memory.read().unwrap_err();
    assert!(failure.sentence.contains("0 bytes of 35"), "{failure}");
}

/// Memory that takes uploads, and answers changes as it is told.
#[derive(Default)]
struct FakeUploads {
    uploads: Vec<Vec<u8>>,
    /// Id of the upload and of the change of each attempt.
    changes: Vec<(u64, MutationId)>,
}

impl FakeUploads {
    fn answer(
        &mut self,
        command: Command,
        changed: impl FnOnce() -> Result<Reply, CallError>,
    ) -> Result<Reply, CallError> {
        let job = match command {
            Command::Job(JobCommand::Begin(JobKind::Document)) => {
                self.uploads.push(Vec::new());
                self.uploads.len() as u64 - 1
            }
            Command::Job(JobCommand::Write { job, offset, bytes }) => {
                let upload = &mut self.uploads[job as usize];
                assert_eq!(offset as usize, upload.len());
                assert!(bytes.len() <= DOCUMENT_PAGE_BYTES);
                upload.extend(bytes);
                job
            }
            Command::Revise(Revision {
                id,
                change: RevisionChange::PutDocument { upload, digest, .. },
                ..
            }) => {
                self.changes.push((upload, id));
                assert_eq!(ContentDigest::of(&self.uploads[upload as usize]), digest);
                return changed();
            }
            other => panic!("{other:?}"),
        };
        Ok(Reply::Job(JobReport {
            job,
            done: 0,
            total: 0,
            outcome: None,
        }))
    }
}

#[test]
fn repeated_storing_names_the_same_upload_until_that_is_lost() {
    let content = vec![7; 2 * DOCUMENT_PAGE_BYTES + 5];
    let name = name();
    let new = NewDocument {
        document: &name,
        media_type: "text/plain",
        content: &content,
    };
    let mut memory = FakeUploads::default();
    let mut upload = None;
    let id = MutationId(9);
    let mut attempt = |answers: Vec<Result<Reply, CallError>>| {
        let mut answers = answers.into_iter();
        let call = |command| memory.answer(command, || answers.next().unwrap());
        let reply = try_put_document(id, "anna", new, &mut upload, call);
        (reply, memory.uploads.len(), memory.changes.clone())
    };
    let lost_answer = || Err(CallError::NotThere { process: "memory" });
    let (reply, n_uploads, _) = attempt(vec![lost_answer()]);
    assert!(reply.is_err() && n_uploads == 1);
    let (reply, n_uploads, changes) = attempt(vec![lost_answer()]);
    assert!(reply.is_err() && n_uploads == 1, "it is not uploaded again");
    assert_eq!(changes, [(0, id), (0, id)]);

    let refused = |kind| Ok(Reply::Refused(Refusal::new(kind, "there is no job 0")));
    let report = LearningReport {
        category: "plan".into(),
        ..LearningReport::default()
    };
    let stored = Ok(Reply::Learned(report.clone()));
    let (reply, n_uploads, changes) = attempt(vec![refused(RefusalKind::NotFound), stored]);
    assert_eq!(reply.unwrap(), report);
    assert_eq!(n_uploads, 2, "the lost upload is replaced");
    assert_eq!(changes.last(), Some(&(1, id)));
}

#[test]
fn refusal_of_a_first_attempt_is_the_reply() {
    let name = name();
    let new = NewDocument {
        document: &name,
        media_type: "text/plain",
        content: b"",
    };
    let refusal = Refusal::new(RefusalKind::Invalid, "its name is too long");
    let mut memory = FakeUploads::default();
    let call = |command| memory.answer(command, || Ok(Reply::Refused(refusal.clone())));
    let reply = try_put_document(MutationId(1), "anna", new, &mut None, call);
    assert_eq!(reply.unwrap_err().to_string(), refusal.to_string());
    assert_eq!(memory.changes.len(), 1);
}
