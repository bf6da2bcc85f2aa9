//! A page of pictures side by side, with numbers: one HTML file beside its PNGs, no network.

use std::fmt::Write as _;

/// The whole page.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// Heading and window title.
    pub title: String,
    /// What the page comes to, in one sentence.
    pub verdict: String,
    /// Whether everything passed.
    pub passed: bool,
    /// Facts about the whole, one a line.
    pub notes: Vec<String>,
    /// One section a view.
    pub views: Vec<View>,
}

/// One section of the page.
#[derive(Clone, Debug, Default)]
pub struct View {
    /// Its heading.
    pub name: String,
    /// Whether every number keeps its limit.
    pub passed: bool,
    /// Numbers beside their limits.
    pub numbers: Vec<Number>,
    /// Facts about the view, one a line.
    pub notes: Vec<String>,
    /// Pictures of one size, side by side; without any, the view is in the table alone.
    pub pictures: Vec<Picture>,
    /// The place to look at.
    pub mark: Option<Mark>,
}

/// A number and its limit.
#[derive(Clone, Debug)]
pub struct Number {
    /// What it is.
    pub name: &'static str,
    /// What it came to, as text.
    pub value: String,
    /// What is allowed, as text; empty where nothing is.
    pub limit: String,
    /// Whether the limit is kept.
    pub kept: bool,
}

/// A picture beside the page.
#[derive(Clone, Debug)]
pub struct Picture {
    /// What it shows.
    pub caption: &'static str,
    /// File name, relative to the page: letters, digits, `-` and `.`.
    pub file: String,
}

/// A rectangle in fractions of the picture's sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

const STYLE: &str = include_str!("page.css");

impl Page {
    /// The page as HTML. Everything that is not a constant of this file is escaped.
    #[must_use]
    pub fn html(&self) -> String {
        let mut html = String::new();
        let (title, verdict) = (escape(&self.title), escape(&self.verdict));
        // Writing to a string cannot fail.
        let _ = write!(
            html,
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
             <h1>{title}</h1>\n<p class=\"verdict {}\">{verdict}</p>\n",
            class(self.passed)
        );
        html.push_str(&list(&self.notes));
        html.push_str(&self.contents());
        // What failed comes first; within that, the order given.
        for passed in [false, true] {
            let shown = self.views.iter().filter(|view| view.passed == passed && !view.pictures.is_empty());
            shown.for_each(|view| view.write(&mut html));
        }
        html.push_str("</body>\n</html>\n");
        html
    }

    /// A table of all views, so that the worst is seen without scrolling.
    fn contents(&self) -> String {
        let Some(first) = self.views.first() else { return String::new() };
        let heads: String =
            first.numbers.iter().map(|number| format!("<th>{}</th>", escape(number.name))).collect();
        let rows: String = self.views.iter().map(View::row).collect();
        format!("<table>\n<tr><th>view</th><th></th>{heads}</tr>\n{rows}</table>\n")
    }
}

impl View {
    fn row(&self) -> String {
        let cell = |number: &Number| {
            let limit = if number.limit.is_empty() {
                String::new()
            } else {
                format!(" <small>of {}</small>", escape(&number.limit))
            };
            format!("<td class=\"{}\">{}{limit}</td>", class(number.kept), escape(&number.value))
        };
        let (name, cells) = (escape(&self.name), self.numbers.iter().map(cell).collect::<String>());
        let word = if self.passed { "passed" } else { "FAILED" };
        let name = if self.pictures.is_empty() { name } else { format!("<a href=\"#{name}\">{name}</a>") };
        format!("<tr><td>{name}</td><td class=\"{}\">{word}</td>{cells}</tr>\n", class(self.passed))
    }

    fn write(&self, html: &mut String) {
        let name = escape(&self.name);
        let word = if self.passed { "passed" } else { "FAILED" };
        let _ = write!(
            html,
            "<section id=\"{name}\">\n<h2>{name} <span class=\"{}\">{word}</span></h2>\n",
            class(self.passed)
        );
        html.push_str(&list(&self.notes));
        html.push_str("<div class=\"pictures\">\n");
        for picture in &self.pictures {
            let (caption, file) = (escape(picture.caption), escape(&picture.file));
            let mark = self.mark.map_or(String::new(), Mark::frame);
            let enlarged = self.mark.map_or(String::new(), |mark| mark.enlarged(&file));
            let _ = writeln!(
                html,
                "<figure><a href=\"{file}\"><img src=\"{file}\" alt=\"{caption}, {name}\">{mark}</a>\
                 {enlarged}<figcaption>{caption}</figcaption></figure>"
            );
        }
        html.push_str("</div>\n</section>\n");
    }
}

impl Mark {
    fn frame(self) -> String {
        let [x, y, width, height] = [self.x, self.y, self.width, self.height].map(|part| 100.0 * part);
        format!("<i style=\"left:{x:.2}%;top:{y:.2}%;width:{width:.2}%;height:{height:.2}%\"></i>")
    }
}

impl Mark {
    /// What the frame holds, as wide as the picture.
    fn enlarged(self, file: &str) -> String {
        // A background's position is the share of the room that is left beside it.
        let share = |start: f64, part: f64| if part < 1.0 { 100.0 * start / (1.0 - part) } else { 0.0 };
        let (x, y) = (share(self.x, self.width), share(self.y, self.height));
        let [width, height] = [self.width, self.height].map(|part| 100.0 / part);
        format!(
            "<b style=\"background-image:url({file});background-size:{width:.2}% {height:.2}%;\
             background-position:{x:.2}% {y:.2}%\"></b>"
        )
    }
}

/// Notes as a list; nothing without any.
fn list(notes: &[String]) -> String {
    let items: String = notes.iter().map(|note| format!("<li>{}</li>", escape(note))).collect();
    if items.is_empty() { items } else { format!("<ul class=\"notes\">{items}</ul>\n") }
}

fn class(passed: bool) -> &'static str {
    if passed { "good" } else { "bad" }
}

/// Text that is safe between tags and in quoted attributes.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            _ => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page() -> Page {
        let number = |kept| Number { name: "mean", value: "0.25".into(), limit: "0.01".into(), kept };
        let view = |name: &str, passed| View {
            name: name.into(),
            passed,
            numbers: vec![number(passed)],
            notes: vec![],
            pictures: vec![Picture { caption: "golden", file: format!("{name}-golden.png") }],
            mark: Some(Mark { x: 0.5, y: 0.25, width: 0.125, height: 0.125 }),
        };
        let title = "part <1> & \"2\"".into();
        Page {
            title,
            verdict: "1 of 2 failed".into(),
            passed: false,
            notes: vec![],
            views: vec![view("good", true), view("poor", false)],
        }
    }

    #[test]
    fn names_cannot_break_the_page() {
        let html = page().html();
        assert!(html.contains("part &lt;1&gt; &amp; &quot;2&quot;") && !html.contains("<1>"));
    }

    #[test]
    fn a_view_without_pictures_is_in_the_table_alone() {
        let mut page = page();
        page.views[0].pictures.clear();
        page.views[1].notes.push("splat <7>".into());
        let html = page.html();
        assert!(html.contains("<td>good</td>") && !html.contains("section id=\"good\""));
        assert!(html.contains("section id=\"poor\"") && html.contains("<li>splat &lt;7&gt;</li>"));
    }

    #[test]
    fn failures_come_first_and_nothing_is_fetched() {
        let html = page().html();
        let at = |text: &str| html.find(text).unwrap_or(usize::MAX);
        assert!(at("section id=\"poor\"") < at("section id=\"good\""));
        assert!(!html.contains("http"), "the page must not need a network");
        assert!(html.contains("left:50.00%;top:25.00%"), "the mark is placed");
    }
}
