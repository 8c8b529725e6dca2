//! What a report says, as data: Markdown and HTML are written from it.

/// One element of a report: a heading, a paragraph, a table or a figure.
pub enum Block {
    /// The report's title.
    Title(String),
    /// A heading below it, with the index of the scenario in the analysis if the part is of one.
    Heading(String, Option<usize>),
    /// The verdict on the scenario of an index, and what limits it.
    Verdict(usize, String, String),
    /// A note, without its full stop.
    Note(String),
    /// Sentences after a title in bold, which can be empty.
    Paragraph(&'static str, Text),
    /// An unordered list.
    List(Vec<Text>),
    /// Rows of cells.
    Table(Table),
    /// A figure, with the index of the scenario if it is of one.
    Figure(Option<usize>, Picture),
}

/// Sentences.
pub type Text = Vec<Span>;

/// A part of a sentence.
pub enum Span {
    /// Plain text.
    Plain(String),
    /// A link to a file beside the report, by its name.
    Link(&'static str),
    /// The end of a line of Markdown; in HTML a space.
    LineEnd,
}

/// A table.
pub struct Table {
    /// A title in bold before the caption; empty for none.
    pub title: &'static str,
    /// What it is of; empty where the heading above says so.
    pub caption: String,
    /// Names of the columns; none for a table of names and values.
    pub head: Vec<(String, Side)>,
    /// The cells of each row.
    pub rows: Vec<Vec<String>>,
}

/// The side of a column on which its cells are aligned.
#[derive(Clone, Copy, PartialEq)]
pub enum Side {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// A figure of a report.
pub struct Picture {
    /// Name of the file, beside a report in Markdown.
    pub file: String,
    /// What it is, for who cannot see it.
    pub alt: String,
    /// What it shows.
    pub caption: String,
    /// The SVG.
    pub svg: String,
}

impl Block {
    /// Sentences of plain text after a title.
    pub fn titled(title: &'static str, text: impl Into<String>) -> Block {
        Block::Paragraph(title, vec![Span::Plain(text.into())])
    }

    /// Sentences of plain text.
    pub fn plain(text: impl Into<String>) -> Block {
        Block::titled("", text)
    }

    /// A table under a caption.
    pub fn table(caption: impl Into<String>, head: &[(&str, Side)], rows: Vec<Vec<String>>) -> Block {
        let head = head.iter().map(|(name, side)| ((*name).to_owned(), *side)).collect();
        Block::Table(Table { title: "", caption: caption.into(), head, rows })
    }
}

/// The program's own text, with its line ends.
pub fn lines(text: &str) -> Text {
    let mut spans: Text = text.lines().flat_map(|line| [Span::Plain(line.to_owned()), Span::LineEnd]).collect();
    spans.pop();
    spans
}
