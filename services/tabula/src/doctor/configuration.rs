//! Check of the configuration by `tabula doctor`: the files, and the last reload of each process.

use super::{Finding, Severity};
use control_protocol::ReloadReport;
use service::{CommonArguments, Configuration, last_reloads};

/// Finding about the configuration files and the running processes.
pub(super) fn finding(common: &CommonArguments) -> Finding {
    const NAME: &str = "configuration";
    match Configuration::find(common.config.as_deref(), common.home().path()) {
        Err(error) => Finding::new(NAME, Severity::Failure, error.to_string()),
        Ok(found) => match trouble(&last_reloads(&common.domain)) {
            Some(sentence) => Finding::new(NAME, Severity::Warning, sentence),
            None => Finding::new(NAME, Severity::Ok, found.origin()),
        },
    }
}

/// Sentence about processes that do not work with the newest configuration they have read.
fn trouble(reports: &[ReloadReport]) -> Option<String> {
    let refused = reports
        .iter()
        .filter_map(|report| Some((report, report.refused.as_ref()?)))
        .map(|(report, sentence)| format!("{} has refused a reload: {sentence}", report.process));
    let waiting = reports.iter().flat_map(|report| {
        report
            .needs_restart
            .iter()
            .map(|change| format!("{} needs a restart for {change}", report.process))
    });
    let sentences: Vec<String> = refused.chain(waiting).collect();
    (!sentences.is_empty()).then(|| sentences.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_protocol::KeyChange;

    #[test]
    fn trouble_names_refusals_and_keys_that_wait_for_a_restart() {
        let quiet = ReloadReport {
            process: "memory".into(),
            ..ReloadReport::default()
        };
        assert_eq!(trouble(std::slice::from_ref(&quiet)), None);
        let refusing = ReloadReport {
            refused: Some("it is wrong".into()),
            ..quiet.clone()
        };
        let waiting = ReloadReport {
            process: "perception".into(),
            needs_restart: vec![KeyChange {
                key: "perception.workers".into(),
                from: "2".into(),
                to: "3".into(),
            }],
            ..quiet
        };
        assert_eq!(
            trouble(&[waiting, refusing]).unwrap(),
            "memory has refused a reload: it is wrong; perception needs a restart for \
             perception.workers 2 -> 3"
        );
    }
}
