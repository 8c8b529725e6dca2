//! What can be wrong with an input, and where: a message with file, line, column and the text underlined.
