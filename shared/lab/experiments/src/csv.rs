//! Writing of CSV lines (RFC 4180).

use std::borrow::Cow;

/// CSV line with a line feed; fields are quoted where needed.
pub(crate) fn line(fields: &[&str]) -> String {
    let fields: Vec<Cow<'_, str>> = fields.iter().map(|field| quoted(field)).collect();
    fields.join(",") + "\n"
}

fn quoted(field: &str) -> Cow<'_, str> {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\"")).into()
    } else {
        field.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separators_in_fields_are_quoted() {
        let fields = ["1", "a,b", "say \"x\"", "", "two\nlines"];
        let expected = "1,\"a,b\",\"say \"\"x\"\"\",,\"two\nlines\"\n";
        assert_eq!(line(&fields), expected);
    }
}
