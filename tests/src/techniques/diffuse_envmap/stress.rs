//! Functions of the library against f64 models, and frames that try to break.

mod lobes;
mod math;
pub(super) mod passes;
mod stage;
mod textures;
mod twin;

use crate::{
    Scope,
    technique::{Input, StressCase, Tolerance},
};

/// All cases.
pub(super) fn cases(_scope: &Scope) -> Vec<StressCase> {
    let mut all = math::cases();
    all.extend(lobes::cases());
    all.extend(textures::cases());
    all.extend(passes::cases());
    all
}

/// A case to be completed with inputs and a tolerance.
fn case(
    function: &'static str,
    library: &'static shaders::Module,
    body: &'static str,
    outputs: &'static [&'static str],
    model: impl Fn(&[f64]) -> Vec<f64> + Sync + 'static,
) -> StressCase {
    StressCase {
        function,
        library,
        inputs: Vec::<Input>::new(),
        body,
        outputs,
        model: Box::new(model),
        tolerance: Tolerance { absolute: 0.0, relative: 0.0, slack: None, reason: "" },
        bindings: None,
        samples: None,
    }
}
