//! Collects the warnings of one file.

use std::collections::HashMap;

use crate::Warning;

/// Warnings of one file. The same message at many places becomes one warning, so that a file with
/// a thousand odd meshes stays readable.
pub(super) struct Warnings {
    file: String,
    entries: Vec<Entry>,
    entry_of_message: HashMap<String, usize>,
}

struct Entry {
    message: String,
    first_place: String,
    count: usize,
}

impl Warnings {
    /// No warnings yet for a file as the caller named it.
    pub(super) fn new(file: &str) -> Self {
        Self { file: file.to_owned(), entries: Vec::new(), entry_of_message: HashMap::new() }
    }

    /// Adds a warning at a place.
    pub(super) fn add(&mut self, place: impl Into<String>, message: impl Into<String>) {
        let message = message.into();
        let known = self.entry_of_message.get(&message).and_then(|&index| self.entries.get_mut(index));
        if let Some(entry) = known {
            entry.count += 1;
            return;
        }
        self.entry_of_message.insert(message.clone(), self.entries.len());
        self.entries.push(Entry { message, first_place: place.into(), count: 1 });
    }

    /// Adds every (place, message) in order.
    pub(super) fn extend(&mut self, notes: Vec<(String, String)>) {
        for (place, message) in notes {
            self.add(place, message);
        }
    }

    /// The warnings in the order in which their first places were met.
    pub(super) fn into_vec(self) -> Vec<Warning> {
        let file = self.file;
        let more = |count: usize| match count {
            0 => String::new(),
            1 => " (and at 1 more place)".to_owned(),
            _ => format!(" (and at {count} more places)"),
        };
        let warning = |entry: Entry| Warning {
            file: file.clone(),
            place: entry.first_place,
            message: entry.message + &more(entry.count - 1),
        };
        self.entries.into_iter().map(warning).collect()
    }
}
