//! The text of Open Rails' files: words, and blocks in parentheses with a name ahead of them.

/// Words of a file that are read at most, and the depth below which a block is part of the one around it.
const MOST_WORDS: usize = 1_000_000;
const DEEPEST: usize = 100;

/// A block: its name, and the words and blocks in it.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub(super) name: String,
    pub(super) words: Vec<String>,
    inner: Vec<Block>,
}

impl Block {
    /// The whole text as a block without a name, and whether it has unclosed blocks, which its end closes.
    pub(super) fn parse(text: &str) -> (Block, bool) {
        let mut open = vec![Block::default()];
        for token in (Tokens { rest: text }).take(MOST_WORDS) {
            let depth = open.len();
            match token {
                Token::Open if depth < DEEPEST => {
                    let name = open[depth - 1].words.pop().unwrap_or_default();
                    open.push(Block { name, ..Block::default() });
                }
                Token::Close if depth > 1 => close(&mut open),
                Token::Word(word) => open[depth - 1].words.push(word),
                _ => {}
            }
        }
        let unclosed = open.len() > 1;
        while open.len() > 1 {
            close(&mut open);
        }
        (open.pop().unwrap_or_default(), unclosed)
    }

    /// The blocks directly in it but for comments.
    pub(super) fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.inner.iter().filter(|b| !b.name.starts_with(['#', '_']) && !b.name.eq_ignore_ascii_case("comment"))
    }

    /// Those directly in it of that name, in any case.
    pub(super) fn all<'b>(&'b self, name: &str) -> impl Iterator<Item = &'b Block> {
        self.blocks().filter(move |b| b.name.eq_ignore_ascii_case(name))
    }

    /// The last one of that name in it, or in a block in it.
    pub(super) fn find(&self, name: &str) -> Option<&Block> {
        self.all(name).last().or_else(|| self.blocks().find_map(|b| b.find(name)))
    }

    pub(super) fn word(&self) -> Option<&str> {
        self.words.first().map(String::as_str)
    }
}

fn close(open: &mut Vec<Block>) {
    if let Some(block) = open.pop()
        && let Some(around) = open.last_mut()
    {
        around.inner.push(block);
    }
}

enum Token {
    Open,
    Close,
    Word(String),
}

struct Tokens<'t> {
    rest: &'t str,
}

impl Iterator for Tokens<'_> {
    type Item = Token;

    fn next(&mut self) -> Option<Token> {
        self.rest = self.rest.trim_start_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
        let first = self.rest.chars().next()?;
        if let '(' | ')' = first {
            self.rest = &self.rest[1..];
            return Some(if first == '(' { Token::Open } else { Token::Close });
        }
        if first == '"' {
            return Some(Token::Word(self.quoted()));
        }
        let end =
            self.rest.find(|c: char| c.is_whitespace() || matches!(c, '(' | ')' | '"')).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        Some(Token::Word(word.to_owned()))
    }
}

impl Tokens<'_> {
    /// A text in quotation marks, and those joined to it by plus signs.
    fn quoted(&mut self) -> String {
        let mut text = String::new();
        loop {
            let inside = &self.rest[1..];
            let end = inside.find('"').unwrap_or(inside.len());
            text += &inside[..end];
            self.rest = inside.get(end + 1..).unwrap_or_default();
            let next = self.rest.trim_start().strip_prefix('+').map(str::trim_start);
            match next.filter(|next| next.starts_with('"')) {
                Some(next) => self.rest = next,
                None => return text,
            }
        }
    }
}
