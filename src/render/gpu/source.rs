//! Puts the WGSL of a pipeline together, without what it does not need.
//!
//! Lines between `//#if NAME` and `//#end` stay only when `NAME` is defined; `//#else` turns
//! the choice around. Blocks may nest.

use crate::render::constants;
use crate::render::settings::Show;

/// Bits of an identity word that hold the splat's index; the rest hold its colour by kind
/// ([`constants::tint`]).
pub const INDEX_BITS: u32 = 29;

const _: () = assert!(constants::TINTS.len() <= 1 << (u32::BITS - INDEX_BITS));

/// What the splat passes are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Some splat is no piece of a plane.
    pub quadric: bool,
    /// Some splat has clip curves.
    pub clipped: bool,
    /// Some splat has clip partners.
    pub partnered: bool,
    /// Colours are blended.
    pub colored: bool,
}

impl Needs {
    fn names(self) -> Vec<&'static str> {
        let all = [
            (self.quadric, "QUADRIC"),
            (self.clipped, "CLIPPED"),
            (self.partnered, "PARTNERED"),
            (self.colored, "COLORED"),
        ];
        all.into_iter().filter_map(|(needed, name)| needed.then_some(name)).collect()
    }
}

/// The module of the visibility and attribute passes.
#[must_use]
pub fn splats(needs: Needs) -> String {
    let mut parts = vec![
        include_str!("../eye.wgsl"),
        include_str!("../project.wgsl"),
        include_str!("../intersect.wgsl"),
        include_str!("../composite.wgsl"),
        include_str!("../splat.wgsl"),
    ];
    if needs.clipped {
        parts.push(include_str!("../clip.wgsl"));
    }
    if needs.partnered {
        parts.push(include_str!("../partner.wgsl"));
    }
    assemble(&parts, &needs.names())
}

/// The module of the shading pass.
#[must_use]
pub fn shading(colored: bool) -> String {
    let names: &[&str] = if colored { &["COLORED"] } else { &[] };
    assemble(&[include_str!("../eye.wgsl"), include_str!("../shade.wgsl")], names)
}

/// The module part of the clip test, as the passes over clipped splats are compiled with.
#[must_use]
pub fn clip() -> String {
    assemble(&[include_str!("../clip.wgsl")], &[])
}

/// The number that stands for a show in the shading pass.
#[must_use]
pub fn show_number(show: Show) -> u32 {
    Show::ALL.iter().position(|&other| other == show).unwrap_or_default() as u32
}

fn assemble(parts: &[&str], names: &[&str]) -> String {
    let mut text = constants::wgsl();
    text += &format!("const INDEX_BITS: u32 = {INDEX_BITS}u;\n");
    text += &format!("const INDEX_MASK: u32 = {}u;\n", (1_u32 << INDEX_BITS) - 1);
    for show in Show::ALL {
        text += &format!("const SHOW_{}: u32 = {}u;\n", show.name().to_uppercase(), show_number(show));
    }
    for part in parts {
        choose(part, names, &mut text);
    }
    text
}

/// Appends the lines that the names choose.
fn choose(source: &str, names: &[&str], text: &mut String) {
    let mut open: Vec<bool> = Vec::new();
    for line in source.lines() {
        match line.strip_prefix("//#") {
            Some(rule) if rule.starts_with("if ") => open.push(names.contains(&rule[3..].trim())),
            Some("else") => {
                if let Some(last) = open.last_mut() {
                    *last = !*last;
                }
            }
            Some(_) => {
                open.pop();
            }
            None if open.iter().all(|&kept| kept) => {
                text.push_str(line);
                text.push('\n');
            }
            None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_unneeded_is_compiled() {
        let plain = splats(Needs { quadric: false, clipped: false, partnered: false, colored: false });
        for word in ["conic:", "discriminant", "color:", "//#", "var<storage", "partner"] {
            let place = plain.find(word).map(|at| &plain[at..plain.len().min(at + 60)]);
            // The record's layout is the same for all, so its colour stays.
            let record = word == "color:"
                && place.is_some_and(|text| text.starts_with("color: vec3<f32>,\n    // index"));
            assert!(place.is_none() || record, "{place:?}");
        }
        let full = splats(Needs { quadric: true, clipped: true, partnered: true, colored: true });
        for word in ["conic: Conic", "discriminant", "sums.color", "var<storage", "partners_cut"] {
            assert!(full.contains(word), "{word}");
        }
    }

    #[test]
    fn blocks_nest_and_turn_around() {
        let mut text = String::new();
        choose("a\n//#if X\nb\n//#if Y\nc\n//#else\nd\n//#end\n//#else\ne\n//#end\nf", &["X"], &mut text);
        assert_eq!(text, "a\nb\nd\nf\n");
    }
}
