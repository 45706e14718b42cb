use super::*;
use crate::{Finding, Reason};
use proptest::prelude::*;

fn read(text: &str) -> Expression {
    text.parse().unwrap_or_else(|error| panic!("{error}"))
}

fn refused(text: &str) -> String {
    text.parse::<Expression>().unwrap_err().to_string()
}

fn findings(truths: [Ternary; Constraint::N]) -> Findings {
    let mut findings = Findings::default();
    for (constraint, truth) in Constraint::ALL.into_iter().zip(truths) {
        let reason = Reason::NotEvaluated;
        findings.set(
            constraint,
            Finding {
                value: truth,
                reason,
            },
        );
    }
    findings
}

/// All assignments of the first six constraints; the others are unknown.
fn assignments() -> impl Iterator<Item = Findings> {
    let truth = |number: usize| [Ternary::False, Ternary::Unknown, Ternary::True][number % 3];
    (0..3_usize.pow(6)).map(move |number| {
        findings(std::array::from_fn(|i| match i {
            0..6 => truth(number / 3_usize.pow(i as u32)),
            _ => Ternary::Unknown,
        }))
    })
}

#[test]
fn papers_rule_parses_from_every_spelling() {
    for text in [
        "paper",
        " Paper ",
        "C_table ∧ C_track ∧ ¬(C_instructor ∨ C_robot ∨ C_edge)",
        "C_table and C_track and not (C_instructor or C_robot or C_edge)",
        "table&track&!(instructor|robot|edge)",
        "TABLE && c_track AND ~ ( Instructor || C_ROBOT oR edge )",
        "  ((C_table) ∧ (C_track)) ∧ (¬((C_instructor ∨ C_robot) ∨ C_edge))\n",
    ] {
        assert_eq!(read(text), Expression::paper(), "{text}");
    }
    assert_eq!(
        Expression::paper().to_string(),
        "C_table ∧ C_track ∧ ¬(C_instructor ∨ C_robot ∨ C_edge)"
    );
}

#[test]
fn default_rule_ignores_the_rim() {
    let default = "C_table ∧ C_track ∧ ¬(C_instructor ∨ C_robot)";
    for text in ["default", "DEFAULT", default] {
        assert_eq!(read(text), Expression::default(), "{text}");
    }
    assert_eq!(Expression::default().to_string(), default);
}

#[test]
fn precedence_is_not_then_and_then_or() {
    assert_eq!(
        read("not table and track or size"),
        read("((not table) and track) or size")
    );
    assert_ne!(read("not (table and track)"), read("not table and track"));
    assert_eq!(
        read("table or (track or size)").to_string(),
        "C_table ∨ (C_track ∨ C_size)"
    );
}

#[test]
fn evaluation_matches_kleenes_logic() {
    use Constraint::{Edge, Instructor, Robot, Table, Track};
    for findings in assignments() {
        let is = |constraint| findings.get(constraint).value;
        let expected = is(Table)
            .and(is(Track))
            .and(is(Instructor).or(is(Robot)).or(is(Edge)).not());
        assert_eq!(Expression::paper().evaluate(&findings), expected);
    }
}

#[test]
fn decisive_constraints_alone_fix_a_false_verdict() {
    let rule = Expression::default();
    for findings in assignments() {
        let truth = rule.evaluate(&findings);
        let decisive = rule.decisive(&findings);
        assert!(!decisive.is_empty());
        // All other constraints may take any value.
        for other in [Ternary::False, Ternary::Unknown, Ternary::True] {
            let mut changed = findings;
            if truth == Ternary::False {
                let first = decisive.iter().next().unwrap();
                for constraint in Constraint::ALL.into_iter().filter(|one| *one != first) {
                    let reason = Reason::NotEvaluated;
                    changed.set(
                        constraint,
                        Finding {
                            value: other,
                            reason,
                        },
                    );
                }
                assert_eq!(rule.evaluate(&changed), truth, "{findings:?} {first:?}");
            }
        }
    }
}

#[test]
fn syntax_error_quotes_the_rule_and_locates_the_fault() {
    for (text, words) in [
        ("", ["is empty", "C_table and C_track"]),
        (" \t ", ["is empty", "C_table"]),
        (
            "C_table and C_unicorn",
            ["character 13", "there are C_table, C_track"],
        ),
        ("C_table and C_egde", ["\"C_egde\"", "C_edge may be meant"]),
        (
            "C_table C_track",
            ["character 9", "needed before \"C_track\""],
        ),
        ("C_table and", ["character 12", "it ends where"]),
        ("and C_table", ["character 1:", "where \"and\" stands"]),
        (
            "C_table and or C_edge",
            ["character 13", "where \"or\" stands"],
        ),
        ("()", ["character 2", "where \")\" stands"]),
        ("not", ["character 4", "it ends where"]),
        ("(C_table", ["character 1:", "not closed"]),
        ("C_table)", ["character 8", "needed before \")\""]),
        ("(C_table C_edge)", ["character 10", "needed before"]),
        ("¬C_table ∧ $", ["character 12", "'$' has no meaning"]),
        ("C_table -- C_edge", ["character 9", "'-' has no meaning"]),
    ] {
        let sentence = refused(text);
        for word in words {
            assert!(sentence.contains(word), "{text:?}: {sentence}");
        }
        let quoted = format!("{text:?}");
        assert!(
            text.trim().is_empty() || sentence.contains(&quoted),
            "{sentence}"
        );
    }
}

#[test]
fn oversized_rules_are_rejected() {
    let deep = format!("{}table{}", "(".repeat(200), ")".repeat(200));
    assert!(refused(&deep).contains("flatter"));
    assert!(refused(&"!".repeat(1024)).contains("flatter"));
    assert!(refused(&"table&".repeat(100)).contains("more than 32 constraints"));
    assert!(refused(&"x".repeat(100_000)).contains("longer than 1024 bytes"));
    assert!(refused(&"x".repeat(100_000)).len() < 400);
    assert!(refused(&"x".repeat(1000)).contains("no constraint"));
    assert!(refused("table and \u{0}\u{1b}[2J").contains("\\0\\u{1b}[2J"));
    let as_deep_as_may_be = format!("{}table{}", "(".repeat(31), ")".repeat(31));
    assert_eq!(read(&as_deep_as_may_be), read("table"));
}

fn ops() -> impl Strategy<Value = Vec<PostfixOp>> {
    let leaf = (0..Constraint::N).prop_map(|i| vec![PostfixOp::Is(Constraint::ALL[i])]);
    leaf.prop_recursive(6, 24, 2, |inner| {
        let joined = |step: PostfixOp| {
            move |(mut left, right): (Vec<PostfixOp>, Vec<PostfixOp>)| {
                left.extend(right);
                left.push(step);
                left
            }
        };
        prop_oneof![
            inner.clone().prop_map(|mut ops| {
                ops.push(PostfixOp::Not);
                ops
            }),
            (inner.clone(), inner.clone()).prop_map(joined(PostfixOp::And)),
            (inner.clone(), inner).prop_map(joined(PostfixOp::Or)),
        ]
    })
}

proptest! {
    #[test]
    fn display_round_trips_through_parsing(ops in ops()) {
        let n_names = ops.iter().filter(|step| matches!(step, PostfixOp::Is(_))).count();
        prop_assume!(n_names <= N_NAMES_MAX);
        let rule = Expression { ops };
        prop_assume!(rule.to_string().len() <= 1024);
        prop_assert_eq!(rule.to_string().parse::<Expression>(), Ok(rule));
    }

    #[test]
    fn parsing_accepts_any_text_without_panic(text in "[a-zA-Z_()&|!∧∨¬~ ]{0,60}|\\PC{0,40}") {
        match text.parse::<Expression>() {
            Ok(rule) => { rule.evaluate(&Findings::default()); }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}
