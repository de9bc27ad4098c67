//! The measures that look at pixels one by one.
