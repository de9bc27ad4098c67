//! Scenes and environments that need no file.
