//! What was used and what was left out on loading.

use std::collections::HashMap;

use serde::Serialize;

/// The most lines of a list of the report.
const MOST_LINES: usize = 32;

/// The most warnings that differ in numbers and quoted names only.
const MOST_OF_A_KIND: usize = 4;

/// The most characters of a line.
const LONGEST_LINE: usize = 400;

/// A scene of a file that may have several.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct SceneEntry {
    /// What it is called in the file, which may be anything.
    pub name: Option<String>,
    /// True if it is shown when nobody asks for another.
    pub is_default: bool,
    /// True if it was loaded.
    pub is_shown: bool,
}

/// What the user should be told about a scene that was loaded.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct LoadReport {
    /// Every scene of a glTF model, in the order of their numbers; empty for other files.
    pub scenes: Vec<SceneEntry>,
    /// What of a model the scene shows, such as `3 meshes with 70 triangles`.
    pub used: Vec<String>,
    /// What a model has and the scene does not show, once each, such as `KHR_materials_sheen (2 materials)`.
    pub ignored: Vec<String>,
    /// One line per file of which something was left out because it is damaged, such as
    /// `bunny.obj: dropped 3 of 69451 triangles (2 bad index, 1 zero area)`.
    pub dropped: Vec<String>,
    /// One line each: a missing material file and the like.
    pub warnings: Vec<String>,
}

impl LoadReport {
    /// What the scene does not show, in one line; `None` if it shows everything.
    pub fn ignored_line(&self) -> Option<String> {
        (!self.ignored.is_empty()).then(|| format!("ignored: {}", self.ignored.join(", ")))
    }

    /// The same, short enough to be read, whatever the files were: the first few lines of a kind, and how many more
    /// there are.
    pub(crate) fn readable(mut self) -> Self {
        for lines in [&mut self.used, &mut self.ignored] {
            *lines = first_few(std::mem::take(lines), MOST_LINES);
        }
        for lines in [&mut self.dropped, &mut self.warnings] {
            *lines = first_few(std::mem::take(lines), MOST_OF_A_KIND);
        }
        self
    }
}

fn first_few(lines: Vec<String>, most_of_a_kind: usize) -> Vec<String> {
    let count = lines.len();
    let mut seen: HashMap<String, usize> = HashMap::new();
    let mut kept: Vec<String> = Vec::new();
    for line in lines {
        let of_its_kind = seen.entry(kind(&line)).or_insert(0);
        *of_its_kind += 1;
        if *of_its_kind <= most_of_a_kind && kept.len() < MOST_LINES {
            kept.push(shortened(line));
        }
    }
    if kept.len() < count {
        kept.push(format!("and {} more", count - kept.len()));
    }
    kept
}

/// A line without its numbers and quoted names.
fn kind(line: &str) -> String {
    let mut is_quoted = false;
    let unquoted = line.chars().filter(|&letter| {
        is_quoted ^= letter == '"';
        !is_quoted && !letter.is_ascii_digit()
    });
    unquoted.take(LONGEST_LINE).collect()
}

fn shortened(line: String) -> String {
    match line.char_indices().nth(LONGEST_LINE) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_lines_of_a_kind_the_first_few_stay() {
        let mut lines: Vec<_> = (0..100_000).map(|n| format!("a.mtl:{n}: \"b{n} c\" is no good")).collect();
        lines.push("another matter".to_owned());
        let few = first_few(lines, MOST_OF_A_KIND);
        assert_eq!(few.len(), MOST_OF_A_KIND + 2);
        assert_eq!(few[0], "a.mtl:0: \"b0 c\" is no good");
        assert_eq!(few[MOST_OF_A_KIND..], ["another matter", "and 99996 more"]);
        let letters = |n: usize| char::from(b'a' + (n % 26) as u8).to_string().repeat(n / 26 + 1);
        assert_eq!(first_few((0..1000).map(letters).collect(), MOST_OF_A_KIND).len(), MOST_LINES + 1);
    }

    #[test]
    fn few_lines_stay_as_they_are_unless_endless() {
        let lines = vec!["3 meshes".to_owned(), "7 meshes".to_owned(), "normals".to_owned()];
        assert_eq!(first_few(lines.clone(), MOST_OF_A_KIND), lines);
        assert_eq!(first_few(vec!["ü".repeat(9_000)], MOST_LINES)[0].chars().count(), LONGEST_LINE + 1);
    }
}
