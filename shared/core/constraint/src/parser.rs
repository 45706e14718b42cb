//! Reads a rule: recursive descent over its tokens.

use crate::Constraint;
use crate::expression::{Expression, N_NAMES_MAX, Step};
use crate::invalid_expression::{Fault, InvalidExpression};

/// Longest rule, bytes.
const N_BYTES_MAX: usize = 1024;

/// Most parentheses and "not" that are open at a time.
const DEPTH_MAX: usize = 32;

/// One word or sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Token<'a> {
    Name(&'a str),
    And,
    Or,
    Not,
    Open,
    Close,
}

struct Parser<'a> {
    text: &'a str,
    /// Where the next token is looked for, bytes.
    next: usize,
    steps: Vec<Step>,
    n_names: usize,
}

/// Reads a rule.
pub(crate) fn parse(text: &str) -> Result<Expression, InvalidExpression> {
    let mut parser = Parser {
        text,
        next: 0,
        steps: Vec::new(),
        n_names: 0,
    };
    if text.len() > N_BYTES_MAX {
        let n_bytes_max = N_BYTES_MAX;
        return Err(parser.wrong(0, Fault::TooLong { n_bytes_max }));
    }
    if text.trim().is_empty() {
        return Err(parser.wrong(0, Fault::Empty));
    }
    parser.either(0)?;
    match parser.peek()? {
        None => Ok(Expression::from_steps(parser.steps)),
        Some((at, _, end)) => {
            Err(parser.wrong(at, Fault::OperatorMissing(text[at..end].to_owned())))
        }
    }
}

impl<'a> Parser<'a> {
    fn wrong(&self, at: usize, fault: Fault) -> InvalidExpression {
        InvalidExpression::new(self.text, at, fault)
    }

    /// Operands joined by "or".
    fn either(&mut self, depth: usize) -> Result<(), InvalidExpression> {
        self.both(depth)?;
        while self.takes(Token::Or)? {
            self.both(depth)?;
            self.steps.push(Step::Or);
        }
        Ok(())
    }

    /// Operands joined by "and".
    fn both(&mut self, depth: usize) -> Result<(), InvalidExpression> {
        self.operand(depth)?;
        while self.takes(Token::And)? {
            self.operand(depth)?;
            self.steps.push(Step::And);
        }
        Ok(())
    }

    /// A name, its contrary, or a rule in parentheses.
    fn operand(&mut self, depth: usize) -> Result<(), InvalidExpression> {
        let Some((at, token, end)) = self.peek()? else {
            return Err(self.wrong(self.text.len(), Fault::OperandMissing(None)));
        };
        if depth >= DEPTH_MAX {
            let depth_max = DEPTH_MAX;
            return Err(self.wrong(at, Fault::TooDeep { depth_max }));
        }
        self.next = end;
        match token {
            Token::Name(name) => self.name(at, name),
            Token::Not => {
                self.operand(depth + 1)?;
                self.steps.push(Step::Not);
                Ok(())
            }
            Token::Open => {
                self.either(depth + 1)?;
                match self.peek()? {
                    Some((_, Token::Close, end)) => {
                        self.next = end;
                        Ok(())
                    }
                    None => Err(self.wrong(at, Fault::NotClosed)),
                    Some((at, _, end)) => {
                        let found = self.text[at..end].to_owned();
                        Err(self.wrong(at, Fault::OperatorMissing(found)))
                    }
                }
            }
            Token::And | Token::Or | Token::Close => {
                let found = self.text[at..end].to_owned();
                Err(self.wrong(at, Fault::OperandMissing(Some(found))))
            }
        }
    }

    fn name(&mut self, at: usize, name: &str) -> Result<(), InvalidExpression> {
        let Some(constraint) = Constraint::from_name(name) else {
            return Err(self.wrong(at, Fault::UnknownConstraint(name.to_owned())));
        };
        self.n_names += 1;
        if self.n_names > N_NAMES_MAX {
            let n_max = N_NAMES_MAX;
            return Err(self.wrong(at, Fault::TooManyNames { n_max }));
        }
        self.steps.push(Step::Is(constraint));
        Ok(())
    }

    /// Goes behind the next token when it is this one.
    fn takes(&mut self, wanted: Token<'_>) -> Result<bool, InvalidExpression> {
        match self.peek()? {
            Some((_, token, end)) if token == wanted => {
                self.next = end;
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    /// The next token, where it begins and where it ends; `None` at the end.
    fn peek(&self) -> Result<Option<(usize, Token<'a>, usize)>, InvalidExpression> {
        let rest = &self.text[self.next..];
        let trimmed = rest.trim_start();
        let at = self.next + rest.len() - trimmed.len();
        let Some(first) = trimmed.chars().next() else {
            return Ok(None);
        };
        let (token, length) = match first {
            '(' => (Token::Open, 1),
            ')' => (Token::Close, 1),
            '!' | '¬' | '~' => (Token::Not, first.len_utf8()),
            '∧' => (Token::And, first.len_utf8()),
            '∨' => (Token::Or, first.len_utf8()),
            '&' => (Token::And, doubled(trimmed, "&&")),
            '|' => (Token::Or, doubled(trimmed, "||")),
            _ => match word(trimmed) {
                "" => return Err(self.wrong(at, Fault::StrangeCharacter(first))),
                word => (token_of(word), word.len()),
            },
        };
        Ok(Some((at, token, at + length)))
    }
}

/// Length of a sign that may stand twice.
fn doubled(text: &str, twice: &str) -> usize {
    if text.starts_with(twice) { 2 } else { 1 }
}

/// The letters, digits and underscores at the beginning.
fn word(text: &str) -> &str {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    &text[..text.find(|c| !is_part(c)).unwrap_or(text.len())]
}

fn token_of(word: &str) -> Token<'_> {
    if word.eq_ignore_ascii_case("and") {
        Token::And
    } else if word.eq_ignore_ascii_case("or") {
        Token::Or
    } else if word.eq_ignore_ascii_case("not") {
        Token::Not
    } else {
        Token::Name(word)
    }
}
