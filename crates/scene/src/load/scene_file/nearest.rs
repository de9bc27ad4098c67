//! Says which key was probably meant.

/// Turns a message of the TOML parser into what was found and what was expected. For an unknown
/// key the message lists the known ones, each in backquotes, after the unknown one.
pub(super) fn explain(message: &str) -> (String, String) {
    let mut quoted = message.split('`').skip(1).step_by(2);
    if message.starts_with("unknown field")
        && let Some(unknown) = quoted.next()
    {
        let known: Vec<&str> = quoted.collect();
        if let Some(nearest) = known.iter().min_by_key(|known| edit_distance(unknown, known)) {
            let expected = format!("`{nearest}`, or another of: {}", known.join(", "));
            return (format!("the unknown key `{unknown}`"), expected);
        }
    }
    let message = message.trim().replace('\n', ", ");
    match message.split_once(", expected ") {
        Some((found, expected)) => (found.to_owned(), expected.to_owned()),
        None => (message, "a valid scene file".to_owned()),
    }
}

/// Fewest insertions, deletions and replacements of characters that turn one word into the other.
/// Only the first 64 characters of the first word count.
fn edit_distance(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (index, from) in from.chars().take(64).enumerate() {
        let mut diagonal = index;
        let mut left = index + 1;
        for (cell, to) in row.iter_mut().skip(1).zip(&to) {
            let above = *cell;
            *cell = (diagonal + usize::from(from != *to)).min(above + 1).min(left + 1);
            (diagonal, left) = (above, *cell);
        }
        if let Some(first) = row.first_mut() {
            *first = index + 1;
        }
    }
    row.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::{edit_distance, explain};

    #[test]
    fn distances() {
        let triples = [
            ("", "abc", 3),
            ("abc", "", 3),
            ("abc", "abc", 0),
            ("kitten", "sitting", 3),
            ("roughnes", "roughness", 1),
        ];
        for (from, to, distance) in triples {
            assert_eq!(edit_distance(from, to), distance, "{from} {to}");
        }
    }

    #[test]
    fn messages() {
        let (found, expected) = explain("unknown field `colour`, expected one of `scale`, `color`, `file`");
        assert_eq!(found, "the unknown key `colour`");
        assert_eq!(expected, "`color`, or another of: scale, color, file");
        let (found, expected) = explain("invalid type: string \"x\", expected f32");
        assert_eq!((found.as_str(), expected.as_str()), ("invalid type: string \"x\"", "f32"));
    }
}
