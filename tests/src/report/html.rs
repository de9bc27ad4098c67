//! A page that holds its style, pictures and plots within itself, and needs no script.

use super::Header;
use std::fmt::Write as _;

const STYLE: &str = "
:root { color-scheme: light dark; --ink: #1c2024; --quiet: #667; --paper: #fff; --line: #d8dce2;
        --band: #f5f6f8; --good: #12733c; --bad: #b3261e; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e6ea; --quiet: #9aa0aa; --paper: #16181c; --line: #363b44; --band: #1e2127;
          --good: #5fd08f; --bad: #ff8a80; }
}
body { font: 15px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper);
       max-width: 92rem; margin: 2rem auto; padding: 0 1.25rem; }
h1 { font-size: 1.7rem; margin: 0 0 .25rem; } h2 { font-size: 1.3rem; margin: 2.5rem 0 .5rem; }
h3 { font-size: 1.05rem; margin: 1.75rem 0 .4rem; } p { max-width: 60rem; margin: .4rem 0; }
.quiet { color: var(--quiet); } .good { color: var(--good); } .bad { color: var(--bad); font-weight: 600; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: .6rem 0; font-variant-numeric: tabular-nums; }
th, td { padding: .22rem .7rem; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
th { font-weight: 600; background: var(--band); vertical-align: bottom; }
td.number, th.number { text-align: right; } td.number, td:first-child { white-space: nowrap; }
th.number { max-width: 9rem; }
tr.ours td { background: var(--band); }
.pictures { display: flex; flex-wrap: wrap; gap: .9rem; margin: .6rem 0; }
figure { margin: 0; max-width: 100%; } figcaption { font-size: .85rem; color: var(--quiet); max-width: 18rem; }
img { display: block; max-width: 100%; image-rendering: pixelated; border-radius: 3px; background: #000; }
.plot { background: #fff; border: 1px solid var(--line); border-radius: 6px; padding: .4rem; width: fit-content;
        max-width: 100%; } .plot svg { max-width: 100%; height: auto; display: block; }
code { font-size: .9em; } a { color: inherit; }
";

/// A page that is being written from the top.
#[derive(Clone, Debug)]
pub(crate) struct Page {
    title: String,
    body: String,
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// Words.
    Text(String),
    /// A figure, to the right.
    Number(String),
    /// Words that say that all is well.
    Good(String),
    /// Words that say that something is wrong.
    Bad(String),
    /// Words that can be passed over.
    Quiet(String),
}

impl Cell {
    /// Words.
    pub(crate) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// A figure with three digits that count.
    pub(crate) fn number(value: f64) -> Self {
        Self::Number(number(value))
    }

    fn html(&self) -> String {
        let (class, text) = match self {
            Self::Text(text) => ("", text),
            Self::Number(text) => (" class=\"number\"", text),
            Self::Good(text) => (" class=\"good\"", text),
            Self::Bad(text) => (" class=\"bad\"", text),
            Self::Quiet(text) => (" class=\"quiet\"", text),
        };
        format!("<td{class}>{}</td>", escape(text))
    }
}

impl Page {
    /// A page with its title and what the header says of the run.
    pub(crate) fn new(title: &str, header: &Header) -> Self {
        let mut page = Self { title: title.to_owned(), body: String::new() };
        page.push(&format!("<h1>{}</h1>\n", escape(title)));
        let quick = if header.quick { ", quick run" } else { "" };
        let load = header.load.map_or(String::new(), |load| format!(", load {load:.1} before"));
        page.quiet(&format!(
            "Sheen {}, {}, on {} with {} CPU threads{load}{quick}",
            header.version, header.date, header.adapter, header.threads
        ));
        if header.interrupted {
            page.bad("This run was stopped before everything was done: what is here is whole, the rest is missing.");
        }
        page
    }

    /// A heading of level 2 or 3, with a name for links.
    pub(crate) fn heading(&mut self, level: u8, text: &str, name: &str) {
        self.push(&format!("<h{level} id=\"{}\">{}</h{level}>\n", escape(name), escape(text)));
    }

    /// A paragraph.
    pub(crate) fn paragraph(&mut self, text: &str) {
        self.push(&format!("<p>{}</p>\n", escape(text)));
    }

    /// A paragraph that can be passed over.
    pub(crate) fn quiet(&mut self, text: &str) {
        self.push(&format!("<p class=\"quiet\">{}</p>\n", escape(text)));
    }

    /// A paragraph that says that all is well.
    pub(crate) fn good(&mut self, text: &str) {
        self.push(&format!("<p class=\"good\">{}</p>\n", escape(text)));
    }

    /// A paragraph that says that something is wrong.
    pub(crate) fn bad(&mut self, text: &str) {
        self.push(&format!("<p class=\"bad\">{}</p>\n", escape(text)));
    }

    /// Links to headings, by text and name.
    pub(crate) fn links(&mut self, links: &[(String, String)]) {
        let links: Vec<String> = links
            .iter()
            .map(|(text, name)| format!("<a href=\"#{}\">{}</a>", escape(name), escape(text)))
            .collect();
        self.push(&format!("<p>{}</p>\n", links.join(" &middot; ")));
    }

    /// A table; `marked` rows are set off. A column whose first cell is a figure has its title to
    /// the right.
    pub(crate) fn table(&mut self, head: &[&str], rows: &[Vec<Cell>], marked: impl Fn(usize) -> bool) {
        let is_number =
            |column: usize| rows.first().is_some_and(|row| matches!(row.get(column), Some(Cell::Number(_))));
        self.push("<div class=\"scroll\"><table><thead><tr>");
        for (column, title) in head.iter().enumerate() {
            let class = if is_number(column) { " class=\"number\"" } else { "" };
            self.push(&format!("<th{class}>{}</th>", escape(title)));
        }
        self.push("</tr></thead><tbody>\n");
        for (index, row) in rows.iter().enumerate() {
            self.push(if marked(index) { "<tr class=\"ours\">" } else { "<tr>" });
            for cell in row {
                self.push(&cell.html());
            }
            self.push("</tr>\n");
        }
        self.push("</tbody></table></div>\n");
    }

    /// Pictures side by side, each a PNG with its width and height in pixels and a caption. Small
    /// ones are shown larger, by whole factors, up to the area of 256 x 256 pixels.
    pub(crate) fn pictures(&mut self, pictures: &[(Vec<u8>, [usize; 2], String)]) {
        self.push("<div class=\"pictures\">\n");
        for (png, [width, height], caption) in pictures {
            let area = width.saturating_mul(*height).max(1);
            let shown = width * ((1 << 16) / area).isqrt().max(1);
            let data = base64::encode(png);
            let caption = escape(caption);
            self.push(&format!(
                "<figure><img width=\"{shown}\" alt=\"{caption}\" src=\"data:image/png;base64,{data}\">\
                 <figcaption>{caption}</figcaption></figure>\n"
            ));
        }
        self.push("</div>\n");
    }

    /// A plot, as SVG that this program made.
    pub(crate) fn plot(&mut self, svg: &str) {
        self.push(&format!("<div class=\"plot\">{svg}</div>\n"));
    }

    /// The whole page.
    pub(crate) fn finish(self) -> String {
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
             <title>{}</title><style>{STYLE}</style></head><body>\n{}</body></html>\n",
            escape(&self.title),
            self.body
        )
    }

    fn push(&mut self, html: &str) {
        self.body.push_str(html);
    }
}

/// Text with what HTML would take for markup replaced.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            _ => escaped.push(letter),
        }
    }
    escaped
}

/// A figure with three digits that count.
pub(crate) fn number(value: f64) -> String {
    let mut text = String::new();
    let size = value.abs();
    let written = if !value.is_finite() {
        write!(text, "{value}")
    } else if value == 0.0 {
        write!(text, "0")
    } else if !(1e-3..1e6).contains(&size) {
        write!(text, "{value:.2e}")
    } else {
        let digits = (2 - size.log10().floor() as i32).clamp(0, 6) as usize;
        write!(text, "{value:.digits$}")
    };
    // Writing to a string does not fail.
    written.map_or_else(|_| value.to_string(), |()| text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header() -> Header {
        Header {
            program: "compare",
            version: "0",
            date: "today".into(),
            adapter: "<b>adapter</b>".into(),
            threads: 2,
            load: None,
            quick: false,
            interrupted: false,
        }
    }

    #[test]
    fn text_cannot_become_markup() {
        let nasty = "<script>alert('x & \"y\"')</script>";
        let mut page = Page::new(nasty, &header());
        page.heading(2, nasty, nasty);
        page.paragraph(nasty);
        page.links(&[(nasty.into(), nasty.into())]);
        page.table(&[nasty], &[vec![Cell::text(nasty), Cell::Bad(nasty.into())]], |_| false);
        page.pictures(&[(vec![1, 2, 3], [8, 8], nasty.into())]);
        let html = page.finish();
        assert!(!html.contains("<script") && !html.contains("<b>"), "{html}");
        assert!(html.contains("&lt;script&gt;alert(&#39;x &amp; &quot;y&quot;&#39;)"), "{html}");
    }

    #[test]
    fn a_page_needs_nothing_beside_itself() {
        let mut page = Page::new("t", &header());
        page.pictures(&[(vec![1, 2, 3], [100, 100], "p".into())]);
        let html = page.finish();
        assert!(
            html.contains("src=\"data:image/png;base64,AQID\"") && html.contains("width=\"200\""),
            "{html}"
        );
        assert!(!html.contains("http") && !html.contains("src=\"/"), "{html}");
    }

    #[test]
    fn figures_have_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.00"),
            (12.345, "12.3"),
            (999.6, "1000"),
            (0.012345, "0.0123"),
            (0.00012345, "1.23e-4"),
            (-2.5e7, "-2.50e7"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
