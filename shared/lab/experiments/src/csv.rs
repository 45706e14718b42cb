//! Tables of comma-separated values.

use std::borrow::Cow;

/// A line of fields, with its end (RFC 4180, with a plain line feed).
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
    fn a_field_can_not_break_its_line() {
        let fields = ["1", "a,b", "say \"x\"", "", "two\nlines"];
        let expected = "1,\"a,b\",\"say \"\"x\"\"\",,\"two\nlines\"\n";
        assert_eq!(line(&fields), expected);
    }
}
