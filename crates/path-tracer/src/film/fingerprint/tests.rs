//! What changes a fingerprint, and what does not.
