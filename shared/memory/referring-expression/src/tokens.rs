//! Tokenizer: words of a query in lower case and British spelling.

/// Word of a query.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct SpokenWord {
    /// Word as it was written.
    pub(crate) text: String,
    /// Word in lower case and British spelling.
    pub(crate) word: String,
    /// True if a hyphen joins the word to the one before.
    pub(crate) is_joined: bool,
}

/// Consecutive tokens, by position in the query.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct WordSpan {
    /// First token.
    pub(crate) start: usize,
    /// First token after the last.
    pub(crate) end: usize,
}

impl WordSpan {
    /// Tokens of the span joined by spaces, as they were written.
    pub(crate) fn text(self, tokens: &[SpokenWord]) -> String {
        let words: Vec<_> = self.of(tokens).iter().map(|t| t.text.as_str()).collect();
        words.join(" ")
    }

    /// Tokens of the span.
    pub(crate) fn of(self, tokens: &[SpokenWord]) -> &[SpokenWord] {
        tokens.get(self.start..self.end).unwrap_or_default()
    }

    pub(crate) fn contains(self, position: usize) -> bool {
        (self.start..self.end).contains(&position)
    }

    pub(crate) fn positions(self) -> std::ops::Range<usize> {
        self.start..self.end
    }

    pub(crate) fn is_empty(self) -> bool {
        self.start >= self.end
    }
}

/// American spellings and typographic variants with their British form.
const SPELLINGS: [(&str, &str); 14] = [
    ("gray", "grey"),
    ("grayish", "greyish"),
    ("color", "colour"),
    ("colors", "colours"),
    ("colored", "coloured"),
    ("colorful", "colourful"),
    ("multicolored", "multicoloured"),
    ("multicolor", "multicoloured"),
    ("multicolour", "multicoloured"),
    ("center", "centre"),
    ("labeled", "labelled"),
    ("unlabeled", "unlabelled"),
    ("nearby", "near"),
    ("besides", "beside"),
];

/// Units that may follow a number without a space.
const ATTACHED_UNITS: [&str; 4] = ["mm", "cm", "cms", "m"];

/// Words of a text. Hyphens and punctuation separate; an apostrophe and a decimal point do not.
pub(crate) fn tokenize(text: &str) -> Vec<SpokenWord> {
    let text = unicode_text::nfc(text);
    let characters: Vec<char> = text.chars().map(plain_apostrophe).collect();
    let mut tokens = Vec::new();
    let mut start = 0;
    for position in 0..=characters.len() {
        if position < characters.len() && is_inside_word(&characters, position) {
            continue;
        }
        if start < position {
            let n_before = tokens.len();
            push_word(&characters[start..position], &mut tokens);
            tokens[n_before].is_joined = follows_hyphen(&characters, start);
        }
        start = position + 1;
    }
    tokens
}

fn follows_hyphen(characters: &[char], start: usize) -> bool {
    let at = |n_back: usize| Some(characters[start.checked_sub(n_back)?]);
    at(1) == Some('-') && at(2).is_some_and(char::is_alphanumeric)
}

fn plain_apostrophe(character: char) -> char {
    if character == '\u{2019}' {
        '\''
    } else {
        character
    }
}

fn is_inside_word(characters: &[char], position: usize) -> bool {
    let is_at = |position: Option<usize>, test: fn(char) -> bool| {
        let character = position.and_then(|position| characters.get(position));
        character.is_some_and(|character| test(*character))
    };
    let joins = |test: fn(char) -> bool| {
        is_at(position.checked_sub(1), test) && is_at(Some(position + 1), test)
    };
    match characters[position] {
        '\'' => joins(char::is_alphanumeric),
        '.' => joins(|character| character.is_ascii_digit()),
        character => character.is_alphanumeric(),
    }
}

/// Adds a word; a number with an attached unit becomes two tokens.
fn push_word(characters: &[char], tokens: &mut Vec<SpokenWord>) {
    let is_digit = |character: &char| character.is_ascii_digit() || *character == '.';
    let n_digits = characters.iter().take_while(|c| is_digit(c)).count();
    let (number, rest) = characters.split_at(n_digits);
    let unit: String = rest.iter().collect::<String>().to_lowercase();
    if n_digits > 0 && ATTACHED_UNITS.contains(&unit.as_str()) {
        tokens.push(token(number));
        tokens.push(token(rest));
    } else {
        tokens.push(token(characters));
    }
}

fn token(characters: &[char]) -> SpokenWord {
    let text: String = characters.iter().collect();
    let lower = text.to_lowercase();
    let british = SPELLINGS.iter().find(|(from, _)| *from == lower);
    let word = british.map_or(lower, |(_, to)| (*to).to_owned());
    SpokenWord {
        text,
        word,
        is_joined: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        tokenize(text).into_iter().map(|token| token.word).collect()
    }

    #[test]
    fn tokens_split_at_hyphens_and_punctuation() {
        assert_eq!(words("The gray, BIG mug?"), ["the", "grey", "big", "mug"]);
        assert_eq!(words("non-red cereal-box"), ["non", "red", "cereal", "box"]);
        assert_eq!(words("'Where\u{2019}s' it..."), ["where's", "it"]);
    }

    #[test]
    fn tokens_know_the_hyphen_before_them() {
        let joined: Vec<bool> = tokenize("green tea-box - -x 5cm-long")
            .iter()
            .map(|token| token.is_joined)
            .collect();
        assert_eq!(joined, [false, false, true, false, false, false, true]);
    }

    #[test]
    fn tokens_split_a_number_from_its_unit() {
        assert_eq!(words("2.5cm, 20 cm. 3rd"), ["2.5", "cm", "20", "cm", "3rd"]);
    }

    #[test]
    fn tokens_of_symbols_only_are_none() {
        assert!(words("?! -- \u{1f600}").is_empty());
    }
}
