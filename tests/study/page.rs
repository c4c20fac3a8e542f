//! What is true of every study's page and errors.
use crate::front_door::Outcome;

/// Insists on one line of error with that exit code and gives the line.
pub(crate) fn refused(outcome: Outcome, code: i32) -> String {
    assert_eq!(outcome.code, Some(code), "{}", outcome.stderr);
    assert!(
        outcome.stderr.lines().count() == 1 && outcome.stderr.starts_with("error: "),
        "{}",
        outcome.stderr
    );
    outcome.stderr
}

/// What stands between two marks, after the first of each.
fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
    let start = text.find(from).unwrap_or_else(|| panic!("no {from}")) + from.len();
    let length = text[start..].find(to).unwrap_or_else(|| panic!("no {to} after {from}"));
    &text[start..start + length]
}

/// Insists on every figure with its verdict and something to see, the report's first; on a page that needs nothing else.
/// What counts as something to see is one of `shows`.
pub(crate) fn check_page(
    page: &str,
    numbers: std::ops::RangeInclusive<u32>,
    last_of_report: u32,
    shows: &[&str],
) {
    for number in numbers {
        let figure = between(page, &format!("<section class=\"figure\" id=\"fig-{number}\""), "</section>");
        assert!(figure.contains(&format!("Fig. {number}: ")), "{number}");
        let verdict = figure.rsplit("class=\"verdict ").next().unwrap();
        let (answer, because) = verdict.split_once("</span>").unwrap();
        assert!(
            ["holds", "holds partly", "does not hold", "cannot be told", "no claim"]
                .iter()
                .any(|a| answer.ends_with(&format!(">{a}"))),
            "{number}: {answer}"
        );
        assert!(because.trim_end_matches("</p>").trim().len() > 10, "{number}: {because}");
        let shown = shows.iter().any(|what| figure.contains(what));
        assert!(shown, "figure {number} shows nothing");
    }
    let report_ends = page.find(&format!("id=\"fig-{}\"", last_of_report + 1)).unwrap();
    assert!(page.find("Further figures").unwrap() < report_ends);
    let without_names = page.replace("http://www.w3.org/2000/svg", "");
    for resource in ["http:", "https:", "<link", "<script", "@import"] {
        assert!(!without_names.contains(resource), "{resource}");
    }
}
