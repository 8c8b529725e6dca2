//! `report.html`: the words of `report.md` with the figures in them, one file that asks for nothing from outside.
//!
//! The Markdown is the source, read by `pulldown-cmark` with HTML in it taken for text, so that both reports say the same. The
//! static figures stand inline as SVG; where scripts run, interactive ones take their place on the screen.
//!
//! Those are drawn by Plotly.js, which every report carries (0.7 MB of base64; the page unpacks it): it has lines, pictures by
//! place and time and hover labels in one schema. Where its text is from is in `assets/README.md`.
//!
//! A policy in the page's head forbids everything but its own scripts, by their digests: whatever a train file's names hold,
//! nothing else runs and nothing is fetched.

use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use pulldown_cmark::{Alignment, Event, Options, Parser, Tag, TagEnd};
use sha2::{Digest, Sha256};

use super::markdown::{Picture, Pictures};
use super::words;
use crate::error::harmless;
use crate::figures::{css, escaped};
use crate::findings::{Analysis, ScenarioFindings};
use crate::train::Train;

const STYLE: &str = concat!(include_str!("page.css"), include_str!("report.css"));
/// Rows of a table that is shown unfolded, at most.
const LONG: usize = 40;
const SCRIPT: &str = include_str!("report.js");
/// Plotly.js, packed with gzip, in base64; and the digest of its text.
static LIBRARY: LazyLock<String> = LazyLock::new(|| STANDARD.encode(include_bytes!("../../assets/plotly.min.js.gz")));
const LIBRARY_DIGEST: &str = include_str!("../../assets/plotly.min.js.sha256");

/// A page with the script that draws the figures.
pub(crate) struct Frame<'a> {
    /// Plain text.
    pub title: &'a str,
    /// CSS beyond that of a report.
    pub style: &'a str,
    /// What stands in the body, as HTML.
    pub body: &'a str,
    /// What the figures are drawn from, as JSON.
    pub data: &'a str,
    /// A script that runs after the one that draws.
    pub script: Option<&'a str>,
}

impl Frame<'_> {
    /// The page, whose policy lets nothing else run; with a script of its own it may ask the server that it came from.
    pub(crate) fn page(&self) -> String {
        let Frame { style, body, .. } = self;
        let scripts: Vec<&str> = std::iter::once(SCRIPT).chain(self.script).collect();
        let digest = |script: &&str| format!("'sha256-{}'", STANDARD.encode(Sha256::digest(script.as_bytes())));
        let digests: String = scripts.iter().map(digest).map(|digest| digest + " ").collect();
        let elements: String = scripts.iter().map(|script| format!("<script>{script}</script>\n")).collect();
        let connect = if self.script.is_some() { "connect-src 'self'; " } else { "" };
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; img-src \
             data: blob:; {connect}script-src {digests}'sha256-{LIBRARY_DIGEST}'; base-uri 'none'; form-action 'none'\">\n\
             <title>{title}</title>\n<style>\n{colors}{STYLE}{style}</style>\n</head>\n<body>\n\
             <a class=\"skip\" href=\"#main\">Skip to the report</a>\n{body}\
             <script type=\"application/json\" id=\"data\">{data}</script>\n\
             <script type=\"text/plain\" id=\"library\">{library}</script>\n{elements}</body>\n</html>\n",
            title = escaped(self.title),
            colors = css(),
            data = in_script(self.data),
            library = LIBRARY.as_str(),
        )
    }
}

/// JSON as the text of a script element, which only "<" could end or turn into a comment.
pub(crate) fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// The report as a page: its Markdown, its figures, and what the script draws from.
pub fn html(train: &Train, analysis: &Analysis, markdown: &str, pictures: &Pictures, data: &str) -> String {
    let body = format!(
        "<main id=\"main\">\n{body}{file}</main>\n\
         <footer><p>Written by trainsafe {version}. Interactive figures: Plotly.js, MIT licence, within this file.</p></footer>\n",
        body = body(analysis, markdown, pictures),
        file = train_file(&train.origin().text),
        version = env!("CARGO_PKG_VERSION"),
    );
    Frame { title: &analysis.train, style: "", body: &body, data, script: None }.page()
}

/// What a report says, as HTML.
pub(crate) fn body(analysis: &Analysis, markdown: &str, pictures: &Pictures) -> String {
    Page { analysis, pictures, out: String::new(), heading: String::new() }.body(markdown)
}

/// The same without scripts and what they draw from.
pub fn light(analysis: &Analysis, markdown: &str, pictures: &Pictures) -> String {
    let title = escaped(&analysis.train);
    let body = body(analysis, markdown, pictures);
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:\">\n\
         <title>{title}</title>\n<style>\n{colors}{STYLE}</style>\n</head>\n<body>\n<main id=\"main\">\n{body}</main>\n</body>\n\
         </html>\n",
        colors = css(),
    )
}

/// The train file's text, folded; nothing for a train that was not read from a text.
fn train_file(text: &str) -> String {
    if text.is_empty() {
        return String::new();
    }
    let lines: Vec<String> = text.lines().map(|line| escaped(&harmless(line))).collect();
    format!("<details>\n<summary>The train file</summary>\n<pre>{}</pre>\n</details>\n", lines.join("\n"))
}

/// A page under way.
struct Page<'a> {
    analysis: &'a Analysis,
    pictures: &'a Pictures,
    out: String,
    /// The last heading: what a table without a lead of its own is of.
    heading: String,
}

type Events<'a> = Vec<Event<'a>>;

impl Page<'_> {
    fn body(mut self, markdown: &str) -> String {
        let events = Parser::new_ext(markdown, Options::ENABLE_TABLES).map(|event| match event {
            Event::Html(html) | Event::InlineHtml(html) => Event::Text(html),
            other => other,
        });
        let mut blocks = blocks(events).into_iter().peekable();
        let mut lead = None;
        while let Some(block) = blocks.next() {
            match &block[0] {
                Event::Start(Tag::Heading { .. }) => self.heading(block),
                Event::Start(Tag::Table(alignments)) => {
                    let alignments = alignments.clone();
                    self.table(block, &alignments, lead.take());
                }
                Event::Start(Tag::Paragraph) if matches!(block[1], Event::Start(Tag::Image { .. })) => {
                    self.figure(&block);
                    // Its caption follows again in words.
                    blocks.next_if(|b| matches!(b[1], Event::Start(Tag::Emphasis)));
                }
                // A paragraph that leads to a table is its caption.
                Event::Start(Tag::Paragraph)
                    if blocks.peek().is_some_and(|b| matches!(b[0], Event::Start(Tag::Table(_))))
                        && plain(&block).ends_with(':') =>
                {
                    lead = Some(plain(&block));
                }
                Event::Start(Tag::Paragraph) => self.paragraph(block),
                _ => self.push(block),
            }
        }
        self.out
    }

    fn push(&mut self, events: Events) {
        pulldown_cmark::html::push_html(&mut self.out, events.into_iter());
    }

    fn heading(&mut self, block: Events) {
        self.heading = plain(&block);
        let Event::Start(Tag::Heading { level, .. }) = block[0] else { return };
        let several = self.analysis.scenarios.len() > 1;
        let of = self
            .analysis
            .scenarios
            .iter()
            .position(|s| several && level as usize == 2 && spaced(&s.name) == self.heading);
        match of {
            Some(i) if i == 0 && !self.out.contains("<nav ") => {
                self.out += &contents(&self.analysis.scenarios);
                self.out += &format!("<h2 id=\"scenario-1\">{}</h2>\n", escaped(&self.heading));
            }
            Some(i) => self.out += &format!("<h2 id=\"scenario-{}\">{}</h2>\n", i + 1, escaped(&self.heading)),
            None => self.push(block),
        }
    }

    /// A paragraph; one that opens with a scenario's verdict is marked as such.
    fn paragraph(&mut self, block: Events) {
        let strong = block.iter().position(|e| matches!(e, Event::End(TagEnd::Strong)));
        let opening = match (&block[1], strong) {
            (Event::Start(Tag::Strong), Some(end)) => plain(&block[1..end]),
            _ => String::new(),
        };
        let verdict_of = |s: &&ScenarioFindings| spaced(&words::verdict_of(s, self.analysis.units)) == opening;
        let found = self.analysis.scenarios.iter().find(verdict_of);
        let from = self.out.len();
        self.push(block);
        if let Some(scenario) = found {
            let class = format!("<p class=\"verdict {}\">", state(scenario).0);
            self.out.replace_range(from..from + "<p>".len(), &class);
        }
    }

    /// A figure: its SVG inline, or nothing where there is no such picture.
    fn figure(&mut self, block: &[Event]) {
        let Event::Start(Tag::Image { dest_url, .. }) = &block[1] else { return };
        let found = self
            .pictures
            .iter()
            .enumerate()
            .find_map(|(i, of)| Some((i, of.iter().position(|p| p.file == **dest_url)?)));
        let Some((scenario, n)) = found else { return };
        let Picture { file, caption, svg } = &self.pictures[scenario][n];
        if n == 0 {
            self.out += &format!("<div class=\"live\" data-scenario=\"{scenario}\" hidden></div>\n");
        }
        let kind = file.trim_end_matches(".svg").rsplit('-').next().unwrap_or_default();
        let caption = escaped(caption);
        let svg = inline(svg, &caption);
        self.out += &format!(
            "<figure data-scenario=\"{scenario}\" data-kind=\"{kind}\" tabindex=\"0\">\n{svg}\n<figcaption>{caption}</figcaption>\n</figure>\n"
        );
    }

    /// A table with a caption, in a frame that scrolls where it is wider than the page; a long one is folded.
    fn table(&mut self, block: Events, alignments: &[Alignment], lead: Option<String>) {
        let heading = escaped(&self.heading);
        // The label is apart from that of the same table of another scenario.
        let (caption, label) = match lead {
            Some(lead) => {
                let caption = escaped(lead.trim_end_matches(':'));
                let label = format!("{heading}: {caption}");
                (caption, label)
            }
            None => (heading.clone(), heading),
        };
        let long = block.iter().filter(|e| matches!(e, Event::Start(Tag::TableRow))).count() > LONG;
        if long {
            self.out += &format!("<details>\n<summary>{caption}</summary>\n");
        }
        self.out += &format!(
            "<div class=\"table\" role=\"region\" aria-label=\"{label}\" tabindex=\"0\">\n<table>\n<caption><span>{caption}</span></caption>\n"
        );
        let named = block
            .iter()
            .take_while(|e| !matches!(e, Event::End(TagEnd::TableHead)))
            .any(|e| matches!(e, Event::Text(_)));
        let (mut column, mut head) = (0, false);
        let mut cell: Events = Vec::new();
        for event in block {
            match event {
                Event::Start(Tag::TableHead) => {
                    head = true;
                    column = 0;
                    self.out += if named { "<thead><tr>" } else { "" };
                }
                Event::End(TagEnd::TableHead) => {
                    head = false;
                    self.out += if named { "</tr></thead>\n<tbody>\n" } else { "<tbody>\n" };
                }
                Event::Start(Tag::TableRow) => {
                    column = 0;
                    self.out += "<tr>";
                }
                Event::End(TagEnd::TableRow) => self.out += "</tr>\n",
                Event::Start(Tag::TableCell) => cell.clear(),
                Event::End(TagEnd::TableCell) => {
                    let right = if alignments.get(column) == Some(&Alignment::Right) { " class=\"right\"" } else { "" };
                    let (open, close) = match (head, column) {
                        (true, _) => (format!("<th scope=\"col\"{right}>"), "</th>"),
                        (false, 0) => (format!("<th scope=\"row\"{right}>"), "</th>"),
                        (false, _) => (format!("<td{right}>"), "</td>"),
                    };
                    column += 1;
                    if named || !head {
                        self.out += &open;
                        self.push(std::mem::take(&mut cell));
                        self.out += close;
                    }
                }
                Event::Start(Tag::Table(_)) | Event::End(TagEnd::Table) => {}
                other => cell.push(other),
            }
        }
        self.out += "</tbody>\n</table>\n</div>\n";
        self.out += if long { "</details>\n" } else { "" };
    }
}

/// The document cut into its outermost blocks.
fn blocks<'a>(events: impl Iterator<Item = Event<'a>>) -> Vec<Events<'a>> {
    let (mut depth, mut all, mut block) = (0, Vec::new(), Vec::new());
    for event in events {
        depth += match event {
            Event::Start(_) => 1,
            Event::End(_) => -1,
            _ => 0,
        };
        block.push(event);
        if depth == 0 {
            all.push(std::mem::take(&mut block));
        }
    }
    all
}

/// The words of a block.
fn plain(block: &[Event]) -> String {
    let word = |e: &Event| match e {
        Event::Text(t) | Event::Code(t) => t.clone().into_string(),
        Event::SoftBreak | Event::HardBreak => " ".to_owned(),
        _ => String::new(),
    };
    block.iter().map(word).collect()
}

/// The text as Markdown has it.
fn spaced(plain: &str) -> String {
    harmless(plain).trim().to_owned()
}

/// A scenario's state, as a class and in words.
fn state(scenario: &ScenarioFindings) -> (&'static str, String) {
    let over = scenario.cases.iter().filter(|c| c.exceeding > 0).count();
    let open = scenario.cases.iter().any(|c| c.undecided > 0);
    match (&scenario.cases[..], over) {
        ([case], 1..) => ("exceeds", format!("{} over the rating", words::count(case.exceeding, "coupler"))),
        (cases, 1..) => ("exceeds", format!("{over} of {} overload a coupler", words::count(cases.len(), "break"))),
        _ if open => ("open", "not decided".to_owned()),
        _ => ("safe", "no coupler over its rating".to_owned()),
    }
}

/// Links to the scenarios, with the state of each.
fn contents(scenarios: &[ScenarioFindings]) -> String {
    let entry = |(i, s): (usize, &ScenarioFindings)| {
        let (class, words) = state(s);
        format!(
            "<li><a href=\"#scenario-{}\">{}</a>: <strong class=\"{class}\">{words}</strong></li>\n",
            i + 1,
            escaped(&spaced(&s.name))
        )
    };
    let entries: String = scenarios.iter().enumerate().map(entry).collect();
    format!("<nav aria-label=\"Scenarios\">\n<ol>\n{entries}</ol>\n</nav>\n")
}

/// A figure's SVG within a page: named for who cannot see it; `label` is HTML.
pub(crate) fn inline(svg: &str, label: &str) -> String {
    svg.trim().replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{label}\" "), 1)
}
