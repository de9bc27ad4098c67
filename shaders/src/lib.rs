//! Sheen's WGSL as a table of modules.
//!
//! Files are plain WGSL. A library file holds functions and constants only: no bindings and no
//! entry points, so that it can be pasted before a host's own shader; its identifiers carry its
//! technique's prefix. A pass file holds bindings and entry points. [`Module::source`] puts a
//! module's dependencies before it, each file once.

use std::{fs, io, path::Path};

mod table;
pub use table::*;

/// One WGSL file and the files whose functions it calls.
#[derive(Debug)]
pub struct Module {
    /// The file's path in this package, for instance `diffuse-envmap/library.wgsl`.
    pub path: &'static str,
    /// The file's text as it was compiled in.
    pub text: &'static str,
    /// Modules that must stand before this one.
    pub dependencies: &'static [&'static Module],
}

impl Module {
    /// The whole shader: dependencies first, each file once.
    pub fn source(&self) -> String {
        let mut source = String::new();
        for module in self.files() {
            source.push_str(module.text);
            source.push('\n');
        }
        source
    }

    /// The same, read from a folder laid out like this package, for hot reload.
    ///
    /// Fails with the first file that cannot be read.
    pub fn source_from(&self, folder: &Path) -> io::Result<String> {
        let mut source = String::new();
        for module in self.files() {
            source.push_str(&fs::read_to_string(folder.join(module.path))?);
            source.push('\n');
        }
        Ok(source)
    }

    /// This module after its dependencies, each once, in an order that compiles.
    pub fn files(&self) -> Vec<&Module> {
        let mut files = Vec::new();
        self.collect(&mut files);
        files
    }

    fn collect<'a>(&'a self, files: &mut Vec<&'a Module>) {
        if files.iter().any(|file| file.path == self.path) {
            return;
        }
        for dependency in self.dependencies {
            dependency.collect(files);
        }
        files.push(self);
    }
}
