//! Recursive-descent parser of constraint rules.

use crate::Constraint;
use crate::invalid_expression::{InvalidExpression, SyntaxFault};
use crate::postfix_op::{N_NAMES_MAX, PostfixOp};

/// Greatest length of a rule, bytes.
const N_BYTES_MAX: usize = 1024;

/// Greatest nesting depth of parentheses and "not".
const DEPTH_MAX: usize = 32;

/// Token of a constraint rule.
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
    /// Byte offset of the next token.
    next: usize,
    ops: Vec<PostfixOp>,
    n_names: usize,
}

/// Parse a constraint rule into postfix operations, which leave one value and hold at
/// most [`N_NAMES_MAX`] names.
pub(crate) fn parse(text: &str) -> Result<Vec<PostfixOp>, InvalidExpression> {
    let mut parser = Parser {
        text,
        next: 0,
        ops: Vec::new(),
        n_names: 0,
    };
    if text.len() > N_BYTES_MAX {
        let n_bytes_max = N_BYTES_MAX;
        return Err(parser.error(0, SyntaxFault::TooLong { n_bytes_max }));
    }
    if text.trim().is_empty() {
        return Err(parser.error(0, SyntaxFault::Empty));
    }
    parser.parse_or(0)?;
    match parser.peek()? {
        None => Ok(parser.ops),
        Some((at, _, end)) => {
            Err(parser.error(at, SyntaxFault::OperatorMissing(text[at..end].to_owned())))
        }
    }
}

impl<'a> Parser<'a> {
    fn error(&self, at: usize, fault: SyntaxFault) -> InvalidExpression {
        InvalidExpression::new(self.text, at, fault)
    }

    /// Parse a disjunction: operands joined by "or".
    fn parse_or(&mut self, depth: usize) -> Result<(), InvalidExpression> {
        self.parse_and(depth)?;
        while self.accept(Token::Or)? {
            self.parse_and(depth)?;
            self.ops.push(PostfixOp::Or);
        }
        Ok(())
    }

    /// Parse a conjunction: operands joined by "and".
    fn parse_and(&mut self, depth: usize) -> Result<(), InvalidExpression> {
        self.parse_operand(depth)?;
        while self.accept(Token::And)? {
            self.parse_operand(depth)?;
            self.ops.push(PostfixOp::And);
        }
        Ok(())
    }

    /// Parse an operand: a name, a negation, or a rule in parentheses.
    fn parse_operand(&mut self, depth: usize) -> Result<(), InvalidExpression> {
        let Some((at, token, end)) = self.peek()? else {
            return Err(self.error(self.text.len(), SyntaxFault::OperandMissing(None)));
        };
        if depth >= DEPTH_MAX {
            let depth_max = DEPTH_MAX;
            return Err(self.error(at, SyntaxFault::TooDeep { depth_max }));
        }
        self.next = end;
        match token {
            Token::Name(name) => self.name(at, name),
            Token::Not => {
                self.parse_operand(depth + 1)?;
                self.ops.push(PostfixOp::Not);
                Ok(())
            }
            Token::Open => {
                self.parse_or(depth + 1)?;
                match self.peek()? {
                    Some((_, Token::Close, end)) => {
                        self.next = end;
                        Ok(())
                    }
                    None => Err(self.error(at, SyntaxFault::NotClosed)),
                    Some((at, _, end)) => {
                        let found = self.text[at..end].to_owned();
                        Err(self.error(at, SyntaxFault::OperatorMissing(found)))
                    }
                }
            }
            Token::And | Token::Or | Token::Close => {
                let found = self.text[at..end].to_owned();
                Err(self.error(at, SyntaxFault::OperandMissing(Some(found))))
            }
        }
    }

    fn name(&mut self, at: usize, name: &str) -> Result<(), InvalidExpression> {
        let Some(constraint) = Constraint::from_name(name) else {
            return Err(self.error(at, SyntaxFault::UnknownConstraint(name.to_owned())));
        };
        self.n_names += 1;
        if self.n_names > N_NAMES_MAX {
            let n_max = N_NAMES_MAX;
            return Err(self.error(at, SyntaxFault::TooManyNames { n_max }));
        }
        self.ops.push(PostfixOp::Is(constraint));
        Ok(())
    }

    /// Consume the next token if it is `wanted`.
    fn accept(&mut self, wanted: Token<'_>) -> Result<bool, InvalidExpression> {
        match self.peek()? {
            Some((_, token, end)) if token == wanted => {
                self.next = end;
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    /// Next token with its start and end, byte offsets; `None` at the end of the rule.
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
                "" => return Err(self.error(at, SyntaxFault::StrangeCharacter(first))),
                word => (keyword_or_name(word), word.len()),
            },
        };
        Ok(Some((at, token, at + length)))
    }
}

/// Length of an operator that may be doubled, bytes.
fn doubled(text: &str, twice: &str) -> usize {
    if text.starts_with(twice) { 2 } else { 1 }
}

/// Leading identifier of a text: letters, digits and underscores.
fn word(text: &str) -> &str {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    &text[..text.find(|c| !is_part(c)).unwrap_or(text.len())]
}

fn keyword_or_name(word: &str) -> Token<'_> {
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
