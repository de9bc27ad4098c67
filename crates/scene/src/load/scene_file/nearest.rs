//! Says what the TOML parser found, and which key was probably meant.

use crate::suggestion;

/// Turns a message of the TOML parser into what was found and what was expected. For an unknown
/// key the message lists the known ones, each in backquotes, after the unknown one.
pub(super) fn explain(message: &str) -> (String, String) {
    let mut quoted = message.split('`').skip(1).step_by(2);
    if message.starts_with("unknown field")
        && let Some(unknown) = quoted.next()
    {
        let known: Vec<&str> = quoted.collect();
        if !known.is_empty() {
            return (format!("the unknown key `{unknown}`"), suggestion(unknown, &known));
        }
    }
    let message = message.trim().replace('\n', ", ");
    match message.split_once(", expected ") {
        Some((found, expected)) => (found.to_owned(), expected.to_owned()),
        None => (message, "a valid scene file".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::explain;

    #[test]
    fn messages() {
        let (found, expected) = explain("unknown field `colour`, expected one of `scale`, `color`, `file`");
        assert_eq!(found, "the unknown key `colour`");
        assert_eq!(expected, "`color`, or another of: scale, color, file");
        let (found, expected) = explain("invalid type: string \"x\", expected f32");
        assert_eq!((found.as_str(), expected.as_str()), ("invalid type: string \"x\"", "f32"));
    }
}
