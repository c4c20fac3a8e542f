//! What may not be written.

use std::path::Path;

use crate::{complaints, sources};

/// Not in any file: a test that never runs, a comment where the layout tables must do the work.
const NOWHERE: [&str; 2] = [concat!("#[ign", "ore"), concat!("keep in ", "sync")];
/// Not in the code of a crate, outside its tests: panics and unfinished work.
const NOT_IN_CODE: [&str; 4] =
    [concat!(".unw", "rap()"), concat!("to", "do!"), concat!("unimpl", "emented!"), concat!("db", "g!(")];

fn forbidden_words(path: &Path, text: &str) -> Vec<String> {
    let lower = text.to_lowercase();
    let anywhere = NOWHERE.into_iter().filter(|word| lower.contains(word)).map(str::to_owned);
    let code = if is_crate_code(path) { without_tests(text) } else { Vec::new() };
    let said = |(number, line): &(usize, &str)| {
        let is_comment = line.trim_start().starts_with("//");
        let word = NOT_IN_CODE.into_iter().find(|word| line.contains(word) && !is_comment);
        word.map(|word| format!("line {number}: {word}"))
    };
    anywhere.chain(code.iter().filter_map(said)).collect()
}

/// Is this a file of `crates/*/src` that is not all tests?
fn is_crate_code(path: &Path) -> bool {
    let parts: Vec<_> = path.components().map(|part| part.as_os_str().to_string_lossy()).collect();
    parts.len() > 3
        && parts[0] == "crates"
        && parts[2] == "src"
        && !parts.iter().any(|part| part.starts_with("tests"))
}

/// The numbered lines of a file without the modules that are marked `#[cfg(test)]` and end with a brace at the margin.
fn without_tests(text: &str) -> Vec<(usize, &str)> {
    let mut kept = Vec::new();
    let mut in_tests = false;
    for (index, line) in text.lines().enumerate() {
        in_tests |= line.starts_with("#[cfg(test)]");
        if !in_tests {
            kept.push((index + 1, line));
        }
        let ends_module =
            line == "}" || (line.starts_with("mod ") || line.starts_with("use ")) && line.ends_with(';');
        in_tests &= !ends_module;
    }
    kept
}

#[test]
fn nothing_forbidden_is_written() {
    assert_eq!(complaints(&sources(), forbidden_words), Vec::<String>::new());
}

#[test]
fn forbidden_words_are_found() {
    let code = Path::new("crates/luxel_x/src/a.rs");
    let [unwrap, todo, unimplemented, dbg] = NOT_IN_CODE;
    for word in [unwrap, todo, unimplemented, dbg] {
        assert_eq!(
            forbidden_words(code, &format!("fn f() {{\n    a{word};\n}}\n")),
            [format!("line 2: {word}")]
        );
    }
    let after_tests = format!("#[cfg(test)]\nmod tests {{\n    a{unwrap};\n}}\nfn f() {{ a{unwrap} }}\n");
    assert_eq!(forbidden_words(code, &after_tests), [format!("line 5: {unwrap}")]);
    let after_declaration = format!("#[cfg(test)]\nmod tests;\na{unwrap}\n");
    assert_eq!(forbidden_words(code, &after_declaration).len(), 1);
    assert_eq!(forbidden_words(Path::new("crates/luxel_x/tests/a.rs"), unwrap).len(), 0);
    assert_eq!(forbidden_words(code, &format!("/// a{unwrap}\n")).len(), 0);
    for word in NOWHERE {
        assert_eq!(forbidden_words(Path::new("tests/a.rs"), &format!("// {}", word.to_uppercase())).len(), 1);
    }
}
