//! The house's one direction, enforced: a room imports only from rooms above it.
//!
//! Reads the `crate::` paths of every file in `src/`. Also: the renderer must ship without the
//! bake half and without the file format, and nothing prints but `main.rs`.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms from the top to the bottom of the house; rooms in one row may not see each other.
const HOUSE: [&[&str]; 14] = [
    // The vocabulary is open to all, and its own parts to each other.
    &["error", "tolerance", "model"],
    &["ingest"],
    &["analyse"],
    &["fit"],
    &["sample"],
    &["bake"],
    &["format"],
    &["render"],
    &["measure", "export"],
    &["report"],
    &["deliver"],
    &["sweep"],
    &["verify"],
    &["cli", "main"],
];

/// The bake half: what turns an input into an asset.
const BAKE_HALF: [&str; 5] = ["ingest", "analyse", "sample", "fit", "bake"];

/// Rooms that see even less than those above them: the vocabulary and the rooms named.
const NARROW: [(&str, &[&str]); 2] = [("render", &[]), ("export", &["format"])];

/// Names that `lib.rs` exports again.
const EXPORTED: [(&str, &str); 2] = [("Error", "error"), ("Result", "error")];

fn height(room: &str) -> Option<usize> {
    HOUSE.iter().position(|row| row.contains(&room))
}

/// What is wrong with `from` importing `to`.
fn fault(from: &str, to: &str) -> Option<String> {
    let (Some(here), Some(there)) = (height(from), height(to)) else {
        return Some(format!("`{from}` or `{to}` is not a room of the house"));
    };
    if from == to || there == 0 && here == 0 {
        return None;
    }
    if there >= here {
        return Some(format!("`{from}` imports `{to}`, which lies below or beside it"));
    }
    let narrow = NARROW.iter().find(|(room, _)| *room == from);
    let hidden = there > 0 && narrow.is_some_and(|(_, seen)| !seen.contains(&to));
    hidden.then(|| format!("`{from}` must not import `{to}`"))
}

/// The text without comments; strings with `//` in them lose their end, which harms nothing.
fn code(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

/// The first segments of all `crate::` paths, groups taken apart.
fn imports(code: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (at, _) in code.match_indices("crate::") {
        // `$crate::` and `some_crate::` are other things.
        if code[..at].chars().next_back().is_some_and(|c| c.is_alphanumeric() || c == '_' || c == '$') {
            continue;
        }
        let rest = &code[at + "crate::".len()..];
        if let Some(group) = rest.strip_prefix('{') {
            found.extend(heads(group));
        } else {
            found.insert(name(rest));
        }
    }
    found
}

fn name(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// The first segment of each entry of a group that was opened just before.
fn heads(group: &str) -> Vec<String> {
    let (mut depth, mut entry, mut found) = (0, true, Vec::new());
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => entry = true,
            c if entry && depth == 0 && !c.is_whitespace() => {
                found.push(name(&group[at..]));
                entry = false;
            }
            _ => {}
        }
    }
    found
}

fn files(directory: &Path, into: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files(&path, into);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            into.push(path);
        }
    }
}

/// Every file of `src/` but `lib.rs`, with its room and its code.
fn sources() -> Vec<(PathBuf, String, String)> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    files(&src, &mut paths);
    let with_code = paths.into_iter().map(|path| {
        let inside = path.strip_prefix(&src).unwrap();
        let room = inside.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs").to_owned();
        let text = code(&fs::read_to_string(&path).unwrap());
        (inside.to_owned(), room, text)
    });
    with_code.filter(|(_, room, _)| room != "lib").collect()
}

#[test]
fn every_room_imports_only_from_above() {
    let mut faults = Vec::new();
    for (path, room, text) in sources() {
        for import in imports(&text) {
            let exported = EXPORTED.iter().find(|(name, _)| *name == import);
            let target = exported.map_or(import.as_str(), |(_, room)| room);
            faults.extend(fault(&room, target).map(|fault| format!("{}: {fault}", path.display())));
        }
    }
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

/// Where items that are compiled for tests only begin in a text, each with its first line.
fn test_items(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.match_indices("#[cfg(test)]").map(|(at, mark)| {
        // Other attributes may stand between.
        let mut lines = text[at + mark.len()..].lines().map(str::trim);
        (at, lines.find(|line| !line.is_empty() && !line.starts_with("#[")).unwrap_or(""))
    })
}

/// The text up to the module of tests in it; files of tests may be declared anywhere before.
fn shipped(text: &str) -> &str {
    let module = test_items(text).find(|(_, item)| item.contains("mod ") && item.ends_with('{'));
    module.map_or(text, |(at, _)| &text[..at])
}

/// Files that are compiled for tests only: `#[cfg(test)] mod name;`.
fn test_files(sources: &[(PathBuf, String, String)]) -> BTreeSet<PathBuf> {
    let mut found = BTreeSet::new();
    for (path, _, text) in sources {
        let modules = test_items(text).filter_map(|(_, item)| item.strip_prefix("mod ").map(name));
        found.extend(modules.map(|module| path.with_file_name(format!("{module}.rs"))));
    }
    found
}

/// Where code that ships, not tests, of the rooms asked for holds one of the words.
fn shipped_with(words: &[&str], is_asked: impl Fn(&str) -> bool) -> Vec<String> {
    let sources = sources();
    let tests = test_files(&sources);
    let mut found = Vec::new();
    for (path, _, text) in sources.iter().filter(|(path, room, _)| is_asked(room) && !tests.contains(path)) {
        let here = words.iter().filter(|word| shipped(text).contains(**word));
        found.extend(here.map(|word| format!("{}: {word}", path.display())));
    }
    found
}

#[test]
fn nothing_prints_but_main() {
    // Tests may say what they left out.
    let words = ["println!", "eprintln!", "print!(", "eprint!(", "dbg!"];
    let faults = shipped_with(&words, |room| room != "main");
    assert!(faults.is_empty(), "only main.rs prints\n{}\n", faults.join("\n"));
}

/// Functions of std, and of glam by way of it, that every platform rounds in its own way.
const OF_THE_PLATFORM: [&str; 20] = [
    ".sin()",
    ".cos()",
    ".tan()",
    ".sin_cos()",
    ".asin()",
    ".acos()",
    ".atan()",
    ".atan2(",
    ".hypot(",
    ".cbrt()",
    ".exp()",
    ".ln()",
    ".log2()",
    ".log10()",
    ".powf(",
    "::from_angle(",
    "::from_rotation_",
    "::from_axis_angle(",
    ".angle_to(",
    ".angle_between(",
];

#[test]
fn what_reaches_a_file_is_not_rounded_by_the_platform() {
    let faults = shipped_with(&OF_THE_PLATFORM, |room| {
        BAKE_HALF.contains(&room) || ["model", "format"].contains(&room)
    });
    assert!(faults.is_empty(), "`libm` gives the same bits everywhere\n{}\n", faults.join("\n"));
}

#[test]
fn every_directory_is_a_room() {
    let rooms: BTreeSet<String> = sources().into_iter().map(|(_, room, _)| room).collect();
    let unknown: Vec<&String> = rooms.iter().filter(|room| height(room).is_none()).collect();
    assert!(unknown.is_empty(), "not in the house: {unknown:?}");
    assert!(rooms.len() > 10, "the walk found only {rooms:?}");
}

#[test]
fn what_follows_the_declaration_of_a_file_of_tests_is_shipped() {
    let text =
        "#[cfg(test)]\nmod tests;\nfn a() {}\n#[cfg(test)]\n#[allow(x)]\npub(super) mod inner {\nfn b() {}";
    assert!(shipped(text).contains("fn a()") && !shipped(text).contains("fn b()"));
}

#[test]
fn planted_faults_are_found() {
    let planted = "use crate::{bake::{self, Options}, render::Camera};\nlet x = crate::Error::Usage;\n\
                   // use crate::verify;\nmacro!($crate::deliver);";
    let found = imports(&code(planted));
    assert_eq!(found, ["Error", "bake", "render"].map(str::to_owned).into_iter().collect());
    for (from, to) in [
        ("fit", "bake"),
        ("render", "format"),
        ("error", "ingest"),
        ("measure", "export"),
        ("export", "render"),
    ] {
        assert!(fault(from, to).is_some(), "{from} must not see {to}");
    }
    for room in BAKE_HALF {
        assert!(fault("render", room).is_some(), "render must not see {room}");
    }
    for (from, to) in
        [("bake", "fit"), ("verify", "render"), ("render", "model"), ("export", "format"), ("fit", "fit")]
    {
        assert_eq!(fault(from, to), None, "{from} may see {to}");
    }
    assert!(fault("nowhere", "error").is_some() && fault("bake", "nowhere").is_some());
}
