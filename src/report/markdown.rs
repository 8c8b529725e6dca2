//! Markdown written from the blocks of a report.

use super::block::{Block, Side, Span, Table, Text};
use crate::error::controls_display;

/// A report as Markdown.
pub fn markdown<'a>(blocks: impl IntoIterator<Item = &'a Block>) -> String {
    blocks.into_iter().map(block).collect::<Vec<_>>().join("\n")
}

fn block(block: &Block) -> String {
    match block {
        Block::Title(text) => format!("# {}\n", escape(text)),
        Block::Heading(text, _) => format!("## {}\n", escape(text)),
        Block::Verdict(_, verdict, more) => format!("**{}**{}\n", escape(verdict), escape(more)),
        Block::Note(text) => format!("*Note: {}.*\n", escape(text)),
        Block::Paragraph(title, text) => format!("{}{}\n", bold(title), spans(text, "\n")),
        Block::List(points) => points.iter().map(|text| format!("- {}\n", spans(text, "\n  "))).collect(),
        Block::Table(of) => table(of),
        Block::Figure(_, of) => {
            format!("![{}]({})\n\n*{}*\n", escape(&of.alt), of.file, escape(&of.caption))
        }
    }
}

fn bold(title: &str) -> String {
    if title.is_empty() { String::new() } else { format!("**{}.** ", escape(title)) }
}

fn spans(text: &Text, line_end: &str) -> String {
    let one = |span: &Span| match span {
        Span::Plain(text) => escape(text),
        Span::Link(file) => format!("[{file}]({file})"),
        Span::LineEnd => line_end.to_owned(),
    };
    text.iter().map(one).collect()
}

fn table(table: &Table) -> String {
    let caption = match table.caption.as_str() {
        "" => String::new(),
        caption => format!("{}{}:\n\n", bold(table.title), escape(caption)),
    };
    let row =
        |cells: &Vec<String>| format!("| {} |\n", cells.iter().map(|c| escape(c)).collect::<Vec<_>>().join(" | "));
    let (head, sides) = match &table.head[..] {
        [] => table.rows.first().map_or(Default::default(), |row| (" |".repeat(row.len()), " --- |".repeat(row.len()))),
        columns => {
            let side = |(_, side): &(String, Side)| if *side == Side::Right { " ---: |" } else { " --- |" };
            let names = columns.iter().map(|(name, _)| format!(" {} |", escape(name)));
            (names.collect(), columns.iter().map(side).collect())
        }
    };
    let rows: String = table.rows.iter().map(row).collect();
    format!("{caption}|{head}\n|{sides}\n{rows}")
}

/// The text with nothing in it that Markdown, or the HTML within it, would take for markup.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for (i, c) in text.char_indices() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '~' | '#' | '$' => out.extend(['\\', c]),
            // Keep a bare address from becoming a link.
            '.' if text[..i].ends_with("www") => out.push_str("\\."),
            ':' if text[i..].starts_with("://") => out.push_str("\\:"),
            c if controls_display(c) => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests;
