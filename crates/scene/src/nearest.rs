//! Says which of the known names was probably meant.

/// "`nearest`, or another of: ..." for a name that is none of `known`.
pub fn suggestion(unknown: &str, known: &[&str]) -> String {
    let list = known.join(", ");
    match known.iter().min_by_key(|name| edit_distance(unknown, name)) {
        Some(nearest) if known.len() > 1 => format!("`{nearest}`, or another of: {list}"),
        _ => format!("`{list}`"),
    }
}

/// Fewest insertions, deletions and replacements of characters that turn one word into the other.
/// Only the first 64 characters of the first word count.
fn edit_distance(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (index, from) in from.chars().take(64).enumerate() {
        let (mut diagonal, mut left) = (index, index + 1);
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
    use super::{edit_distance, suggestion};

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
    fn the_nearest_comes_first() {
        let known = ["method", "rays", "horizon"];
        assert_eq!(suggestion("ray", &known), "`rays`, or another of: method, rays, horizon");
        assert_eq!(suggestion("hoirzon", &known), "`horizon`, or another of: method, rays, horizon");
        assert_eq!(suggestion("x", &["only"]), "`only`");
    }
}
