//! Which functions a library has, and which of them nobody stresses.

use crate::technique::{Failure, StressCase, Technique};
use shaders::Module;
use std::collections::BTreeSet;

/// What is missing or left over in a technique's list of cases, one line each.
pub(super) fn gaps(technique: &Technique, cases: &[StressCase]) -> Result<Vec<String>, Failure> {
    let mut functions = BTreeSet::new();
    for module in technique.libraries {
        functions.extend(own_functions(module)?);
    }
    let cases: BTreeSet<&str> = cases.iter().map(|case| plain_name(case.function)).collect();
    let exempt: BTreeSet<&str> = technique.exemptions.iter().map(|exemption| exemption.function).collect();
    let mut lines = Vec::new();
    for function in &functions {
        if !cases.contains(function.as_str()) && !exempt.contains(function.as_str()) {
            lines.push(format!("{}: {function} has no stress case", technique.name));
        }
    }
    for name in cases.union(&exempt).filter(|name| !functions.contains(**name)) {
        lines.push(format!("{}: {name} is stressed or exempt, but no library has it", technique.name));
    }
    for name in cases.intersection(&exempt) {
        lines.push(format!("{}: {name} is exempt although it has a stress case", technique.name));
    }
    Ok(lines)
}

/// The function of a case: its name without the suffix in brackets.
fn plain_name(function: &str) -> &str {
    function.split_once('[').map_or(function, |(name, _)| name).trim_end()
}

/// The functions that stand in a module's own file.
fn own_functions(module: &Module) -> Result<Vec<String>, Failure> {
    let names = |source: &str| -> Result<Vec<String>, Failure> {
        let parsed = naga::front::wgsl::parse_str(source)
            .map_err(|error| format!("{}: {}", module.path, error.emit_to_string(source)))?;
        Ok(parsed.functions.iter().filter_map(|(_, function)| function.name.clone()).collect())
    };
    let all = names(&module.source())?;
    let mut before: BTreeSet<String> = BTreeSet::new();
    for dependency in module.dependencies {
        before.extend(names(&dependency.source())?);
    }
    Ok(all.into_iter().filter(|name| !before.contains(name)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::{Exemption, Input, Tolerance};

    static MODULE: Module = Module {
        path: "test/library.wgsl",
        text: "fn test_a(x: f32) -> f32 { return sheen_acos(x); } // fn test_comment(\nfn test_b() {}",
        dependencies: &[&shaders::COMMON_MATH],
    };

    static MODULES: &[&Module] = &[&MODULE];

    fn technique(exemptions: &'static [Exemption]) -> Technique {
        Technique {
            name: "test",
            summary: "",
            libraries: MODULES,
            exemptions,
            comparisons: |_| Vec::new(),
            benchmarks: |_| Vec::new(),
            measurements: |_| Vec::new(),
            stress: |_| Vec::new(),
            hostile_scenes: |_| Vec::new(),
            figures: |_| Vec::new(),
        }
    }

    fn case(function: &'static str) -> StressCase {
        StressCase {
            function,
            library: &MODULE,
            inputs: vec![Input::Real { least: -1.0, greatest: 1.0 }],
            body: "",
            outputs: &[],
            model: Box::new(|_| Vec::new()),
            tolerance: Tolerance { absolute: 0.0, relative: 0.0, slack: None, reason: "" },
            bindings: None,
            samples: None,
        }
    }

    #[test]
    fn a_module_has_the_functions_of_its_own_file() {
        assert_eq!(own_functions(&MODULE).unwrap(), ["test_a", "test_b"]);
        let broken = Module { path: "broken.wgsl", text: "fn (", dependencies: &[] };
        let error = own_functions(&broken).unwrap_err().to_string();
        assert!(error.starts_with("broken.wgsl: "), "{error}");
    }

    const EXEMPT: &[Exemption] = &[Exemption { function: "test_b", reason: "it does nothing" }];

    #[test]
    fn every_function_needs_a_case_or_a_reason() {
        let none = technique(&[]);
        assert_eq!(gaps(&none, &[case("test_a")]).unwrap(), ["test: test_b has no stress case"],);
        assert!(gaps(&none, &[case("test_a [near 1]"), case("test_a"), case("test_b")]).unwrap().is_empty());
        assert!(gaps(&technique(EXEMPT), &[case("test_a")]).unwrap().is_empty());
        assert_eq!(
            gaps(&technique(EXEMPT), &[case("test_a"), case("test_b"), case("gone")]).unwrap().len(),
            2
        );
    }
}
