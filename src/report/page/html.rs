//! Parts of HTML: escaped text, data for scripts, pictures inside the page.

use serde_json::Value;

/// Largest size of an SVG that is embedded as such, bytes; larger ones are replaced by a PNG.
const MAX_SVG_LENGTH: usize = 400_000;

/// Escapes a text for use in elements and in attributes in double quotes. Control characters, which HTML does not permit,
/// become replacement characters.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\n' | '\t' => escaped.push(character),
            control if control.is_control() => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}

/// Longest line without columns, in characters, that is taken for a heading between rows of a table.
const MAX_HEADING_LENGTH: usize = 60;

/// Writes a report as text. Lines in columns, which have two spaces between their words, and headings between them are not
/// wrapped, since that would destroy the columns.
pub(super) fn write_text(html: &mut String, text: &str) {
    let lines: Vec<&str> = text.lines().collect();
    let has_columns = |line: &&str| line.trim().contains("  ");
    let is_in_columns = |index: usize| {
        let is_in_paragraph = |line: &&&str| !line.trim().is_empty();
        let mut before = lines[..index].iter().rev().take_while(is_in_paragraph);
        let mut after = lines[index + 1..].iter().take_while(is_in_paragraph);
        let line = &lines[index];
        let is_short = !line.trim().is_empty() && line.chars().count() <= MAX_HEADING_LENGTH;
        has_columns(line) || (is_short && before.any(has_columns) && after.any(has_columns))
    };
    html.push_str("<div class=\"words\">");
    let mut start = 0;
    while start < lines.len() {
        let is_table = is_in_columns(start);
        let count =
            (start..lines.len()).take_while(|&index| is_in_columns(index) == is_table).count();
        html.push_str(if is_table { "<pre class=\"columns\" tabindex=\"0\">" } else { "<pre>" });
        // The parser drops one line break at the beginning.
        html.push('\n');
        for line in &lines[start..start + count] {
            html.push_str(&escape(line));
            html.push('\n');
        }
        html.push_str("</pre>");
        start += count;
    }
    html.push_str("</div>\n");
}

/// Formats a value as JSON for a `script` element. Texts in it cannot end the element or begin a comment, since `<`, `>`
/// and `&` are written as escape sequences of JSON.
pub(super) fn format_script_data(value: &Value) -> String {
    value.to_string().replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

/// Creates the element of a picture with the name `stem` from its SVG, or from its PNG if the SVG is large.
pub(in crate::report) fn embed_picture<E>(
    stem: &str,
    svg: &[u8],
    draw_png: impl FnOnce() -> Result<Vec<u8>, E>,
) -> Result<String, E> {
    // Preparation shortens an SVG by less than a third.
    if svg.len() <= MAX_SVG_LENGTH * 3 / 2 {
        let inline = inline_svg(stem, &String::from_utf8_lossy(svg));
        if inline.len() <= MAX_SVG_LENGTH {
            return Ok(inline);
        }
    }
    let data = encode_base64(&draw_png()?);
    Ok(format!("<img alt=\"{}\" src=\"data:image/png;base64,{data}\" />", escape(stem)))
}

/// Prepares an SVG document as an element of a page: without size and name space, with identifiers that begin with `stem`.
/// Quotes in texts are escaped, so that replacements affect attributes only.
fn inline_svg(stem: &str, document: &str) -> String {
    let Some((root, rest)) = document.split_once('>') else { return String::new() };
    let view_box = root.split_once("viewBox=\"").and_then(|(_, own)| own.split_once('"'));
    let view_box = view_box.map_or("", |(own, _)| own);
    let rest = rest
        .replace(" opacity=\"1\"", "")
        .replace(" stroke=\"none\"", "")
        .replace(" id=\"", &format!(" id=\"{stem}-"))
        .replace("url(#", &format!("url(#{stem}-"))
        .replace("href=\"#", &format!("href=\"#{stem}-"));
    format!("<svg role=\"img\" aria-label=\"{}\" viewBox=\"{view_box}\">{rest}", escape(stem))
}

/// Encodes bytes as Base64 with padding (RFC 4648, section 4).
fn encode_base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |index: usize| u32::from(group.get(index).copied().unwrap_or(0));
        let word = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let is_present = digit <= group.len();
            let index = (word >> (18 - 6 * digit)) & 63;
            text.push(if is_present { char::from(ALPHABET[index as usize]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_not_wrapped() {
        let text = "title\n\n  a  b\nrows\n  1  2\nafter";
        let mut html = String::new();
        write_text(&mut html, text);
        let table = "<pre class=\"columns\" tabindex=\"0\">\n  a  b\nrows\n  1  2\n</pre>";
        assert_eq!(
            html,
            format!(
                "<div class=\"words\"><pre>\ntitle\n\n</pre>{table}<pre>\nafter\n</pre></div>\n"
            )
        );
    }

    #[test]
    fn base64_is_that_of_the_standard() {
        // Test vectors of RFC 4648, section 10.
        let expected = ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"];
        for (length, text) in expected.into_iter().enumerate() {
            assert_eq!(encode_base64(&b"foobar"[..length]), text);
        }
    }

    #[test]
    fn texts_cannot_leave_their_element() {
        let text = "</script><b a=\"'&\u{0}";
        assert_eq!(escape(text), "&lt;/script&gt;&lt;b a=&quot;&#39;&amp;\u{fffd}");
        let data = format_script_data(&Value::from(text));
        assert!(!data.contains(['<', '>', '&']));
        assert_eq!(serde_json::from_str::<Value>(&data).unwrap(), text);
    }

    #[test]
    fn identifiers_of_pictures_are_unique() {
        let svg = "<svg width=\"2\" viewBox=\"0 0 4 4\" xmlns=\"http://www.w3.org/2000/svg\">\n\
                   <path id=\"a\" fill=\"url(#a)\" opacity=\"1\"/></svg>";
        let expected = "<svg role=\"img\" aria-label=\"map\" viewBox=\"0 0 4 4\">\n\
                        <path id=\"map-a\" fill=\"url(#map-a)\"/></svg>";
        assert_eq!(inline_svg("map", svg), expected);
    }

    #[test]
    fn large_pictures_are_images() {
        let svg = format!("<svg viewBox=\"0 0 1 1\"><text>{}</text></svg>", "x".repeat(400_000));
        let found: Result<_, ()> = embed_picture("map", svg.as_bytes(), || Ok(b"foobar".to_vec()));
        assert_eq!(found.unwrap(), "<img alt=\"map\" src=\"data:image/png;base64,Zm9vYmFy\" />");
    }
}
