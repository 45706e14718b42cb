//! HTML page skeleton, escaping and links.

use std::fmt::Write;

const STYLE: &str = "body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:1400px;\
    padding:0 1em;color:#222}table{border-collapse:collapse;margin:1em 0}\
    caption{text-align:left;font-weight:bold}th,td{padding:.2em .7em;text-align:right;border-bottom:1px solid #ddd;\
    font-variant-numeric:tabular-nums}th:first-child,td:first-child,.text{text-align:left}\
    figure{margin:2em 0}img{width:100%;height:auto;display:block}\
    figcaption{margin-bottom:.4em}h2{margin-top:2em}";

/// HTML page that depends on no other file but its pictures. `title` and `notes` are plain text,
/// the parts of the body HTML.
pub fn html(title: &str, notes: &[String], body: impl IntoIterator<Item = String>) -> String {
    let title = escaped(title);
    let mut parts = vec![format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>{title}</title>\n\
         <style>{STYLE}</style>\n<h1>{title}</h1>"
    )];
    parts.extend(notes.iter().map(|note| format!("<p>{}</p>", escaped(note))));
    parts.extend(body);
    parts.push("</html>\n".to_owned());
    parts.join("\n")
}

/// HTML image that links to its own file. `path` is plain text, relative to the page;
/// `alternative_html` is HTML.
pub fn linked_picture(path: &str, alternative_html: &str) -> String {
    let link = link(path);
    format!(
        "<a href=\"{link}\"><img loading=\"lazy\" src=\"{link}\" alt=\"{alternative_html}\"></a>"
    )
}

/// HTML-escaped text.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            other => escaped.push(other),
        }
    }
    escaped
}

/// Percent-encoded relative URL (RFC 3986) of a plain-text path.
fn link(path: &str) -> String {
    let mut link = String::new();
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-_.~/".contains(&byte) {
            link.push(char::from(byte));
        } else {
            // Writing to a string cannot fail.
            let _ = write!(link, "%{byte:02X}");
        }
    }
    link
}
