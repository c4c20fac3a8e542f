//! The piece of a shader's text that an error is about.

use std::ops::Range;

/// The line of `source` where `span` (in bytes) begins, with its place and a caret under the span:
/// ```text
///   --> package::fog:5:22
///  5 |     let a = densty(x);
///    |             ^^^^^^
/// ```
/// A span outside the source gives the place's name alone.
pub(crate) fn excerpt(place: &str, source: &str, span: Range<usize>) -> String {
    let (Some(before), Some(marked)) = (source.get(..span.start), source.get(span)) else {
        return format!("  --> {place}");
    };
    let line_number = before.matches('\n').count() + 1;
    let line_start = before.rfind('\n').map_or(0, |at| at + 1);
    let line = source[line_start..].lines().next().unwrap_or_default();
    let column = before[line_start..].chars().count();
    let first_line = marked.lines().next().unwrap_or_default();
    let carets = "^".repeat(first_line.chars().count().max(1));
    let margin = " ".repeat(line_number.to_string().len());
    // Tabs stay tabs, so that the caret lands under its text.
    let indent: String = line.chars().take(column).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
    format!(
        "  --> {place}:{line_number}:{}\n {line_number} | {line}\n {margin} | {indent}{carets}",
        column + 1
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_caret_is_under_the_span() {
        let source = "fn a() {}\n\tlet é = bad(x);\n";
        let start = source.find("bad").unwrap();
        let text = excerpt("package::m", source, start..start + 3);
        assert_eq!(text, "  --> package::m:2:10\n 2 | \tlet é = bad(x);\n   | \t        ^^^");
    }

    #[test]
    fn odd_spans_do_no_harm() {
        assert_eq!(excerpt("p", "abc", 2..9), "  --> p");
        assert_eq!(excerpt("p", "é", 1..2), "  --> p");
        assert_eq!(excerpt("p", "", 0..0), "  --> p:1:1\n 1 | \n   | ^");
        assert_eq!(excerpt("p", "ab\ncd", 1..4), "  --> p:1:2\n 1 | ab\n   |  ^");
    }
}
