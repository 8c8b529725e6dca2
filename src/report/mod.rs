//! Findings into text and figures: Markdown, CSV, JSON, SVG, and the short table on a terminal.
