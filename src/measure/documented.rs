//! A schema against its document, for tests.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;

use serde::Serialize;
use serde_json::Value;

/// Asserts that a document's tables have a row, which begins "| `key`", for every key of a value
/// and for nothing else, and that it names the schema.
///
/// Keys are paths, such as `file.chunks[].name`; what lies below those named in `elsewhere` has a
/// document of its own.
pub(crate) fn assert_documented(value: impl Serialize, elsewhere: &[&str], document: &str, schema: &str) {
    let mut written = BTreeSet::new();
    paths(&serde_json::to_value(value).unwrap(), "", elsewhere, &mut written);
    let rows = document.lines().filter_map(|line| line.strip_prefix("| `"));
    let documented: BTreeSet<String> =
        rows.filter_map(|row| row.split('`').next()).map(str::to_owned).collect();
    assert_eq!(documented, written);
    assert!(document.contains(schema));
}

/// Every key as a path.
fn paths(value: &Value, at: &str, elsewhere: &[&str], into: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let path = if at.is_empty() { key.clone() } else { format!("{at}.{key}") };
                into.insert(path.clone());
                if !elsewhere.contains(&key.as_str()) {
                    paths(value, &path, elsewhere, into);
                }
            }
        }
        Value::Array(items) => {
            items.iter().for_each(|item| paths(item, &format!("{at}[]"), elsewhere, into));
        }
        _ => {}
    }
}

#[test]
fn a_key_or_a_row_too_many_is_found() {
    let value = serde_json::json!({ "a": [{ "b": 1 }], "c": { "d": 2 } });
    let check = |document: &str| {
        std::panic::catch_unwind(|| assert_documented(&value, &["c"], document, "name/1")).is_ok()
    };
    assert!(check("name/1\n| `a` |\n| `a[].b` | number |\n| `c` |"));
    assert!(!check("name/1\n| `a` |\n| `c` |"), "a key without a row");
    assert!(!check("name/1\n| `a` |\n| `a[].b` | number |\n| `c` |\n| `c.d` |"), "a row without a key");
    assert!(!check("name/2\n| `a` |\n| `a[].b` | number |\n| `c` |"), "another schema");
}
