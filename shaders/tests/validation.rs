//! Every module compiles, and library files keep to their rules.

#[test]
fn every_module_is_valid_wgsl() {
    for module in shaders::ALL {
        let source = module.source();
        let parsed = naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|error| panic!("{}: {}", module.path, error.emit_to_string(&source)));
        naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            naga::valid::Capabilities::default(),
        )
        .validate(&parsed)
        .unwrap_or_else(|error| panic!("{}: {}", module.path, error.emit_to_string(&source)));
    }
}

#[test]
fn library_files_hold_functions_only() {
    for module in shaders::ALL.iter().filter(|module| module.path.ends_with("library.wgsl")) {
        for word in ["@group", "@compute", "@fragment", "@vertex"] {
            assert!(!module.text.contains(word), "{} contains {word}", module.path);
        }
    }
}

#[test]
fn a_shared_dependency_appears_once() {
    for module in shaders::ALL {
        let paths: Vec<_> = module.files().iter().map(|file| file.path).collect();
        let mut unique = paths.clone();
        unique.sort_unstable();
        unique.dedup();
        assert_eq!(unique.len(), paths.len(), "{}", module.path);
    }
}

#[test]
fn source_from_reads_the_same_text() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    for module in shaders::ALL {
        assert_eq!(module.source_from(folder).unwrap(), module.source());
    }
}
