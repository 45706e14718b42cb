//! Graph of a task's state machine as a Mermaid state diagram, enumerated from the machine itself.

use crate::phase::{TaskPhase, TaskSignal};
use crate::state_machine::MachineState;
use std::collections::BTreeMap;

/// Mermaid state diagram of a task that is not cancelled; what a cancellation changes follows as
/// notes. Signals that change nothing have no edge, and a stop, which leads from everywhere to
/// `halt`, has one note.
pub fn mermaid() -> String {
    let mut lines = vec!["stateDiagram-v2".to_owned()];
    lines.push(format!("    [*] --> {}", MachineState::START.phase.word()));
    for phase in TaskPhase::ALL {
        for (next, signals) in edges(*phase) {
            let words: Vec<&str> = signals.iter().map(|signal| signal.word()).collect();
            let label = words.join(", ");
            lines.push(format!("    {} --> {}: {label}", phase.word(), next.word()));
        }
    }
    for phase in TaskPhase::ALL.iter().filter(|phase| phase.is_end()) {
        lines.push(format!("    {} --> [*]", phase.word()));
    }
    lines.push("    note right of halt: a stop leads here from every phase".to_owned());
    lines.push(String::new());
    lines.join("\n")
}

/// Next phases of a phase, with the signals that lead there.
fn edges(phase: TaskPhase) -> BTreeMap<TaskPhase, Vec<TaskSignal>> {
    let state = MachineState {
        phase,
        is_cancelled: false,
    };
    let mut edges = BTreeMap::<TaskPhase, Vec<TaskSignal>>::new();
    for signal in TaskSignal::ALL {
        let next = state.after(*signal).phase;
        if next != phase && *signal != TaskSignal::Stopped {
            edges.entry(next).or_default().push(*signal);
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn graph_has_an_edge_for_each_transition() {
        let text = mermaid();
        for expected in [
            "[*] --> return",
            "choose --> succeeded: nothing_left",
            "carry --> replan: failure",
            "lift --> set_back: failure, cancel",
            "halt --> replan: resumed_with_object",
            "failed --> [*]",
        ] {
            assert!(text.contains(expected), "{expected} is missing in\n{text}");
        }
        let n_edges: usize = TaskPhase::ALL.iter().map(|phase| edges(*phase).len()).sum();
        let n_lines = text
            .lines()
            .filter(|line| line.contains(": ") && line.contains("-->"));
        assert_eq!(n_lines.count(), n_edges);
    }
}
