//! Functions of the library against f64 models.

mod angles;
mod relief;
mod views;

use crate::{
    Scope,
    technique::{Exemption, Input, StressCase, Tolerance},
};
use shaders::HORIZON_SHADOW_LIBRARY as LIBRARY;

/// All cases.
pub(super) fn cases(_scope: &Scope) -> Vec<StressCase> {
    let mut all = angles::cases();
    all.extend(relief::cases());
    all.extend(views::cases());
    all
}

const ON_TABLES: &str = "it reads the tables; the crate's tests/library.rs compares whole horizons with the model on tables of its own";
const INSIDE: &str = "a part of horizon_shadow_near and horizon_shadow_march, whose cases run through it";

/// Functions without a case.
pub(super) const EXEMPTIONS: &[Exemption] = &[
    Exemption { function: "horizon_shadow_published", reason: ON_TABLES },
    Exemption { function: "horizon_shadow_far", reason: ON_TABLES },
    Exemption { function: "horizon_shadow_sine", reason: ON_TABLES },
    Exemption { function: "horizon_shadow_horizon", reason: ON_TABLES },
    Exemption { function: "horizon_shadow_visibility", reason: ON_TABLES },
    Exemption { function: "horizon_shadow_tile", reason: ON_TABLES },
    Exemption { function: "horizon_shadow_prefiltered", reason: ON_TABLES },
    Exemption { function: "horizon_shadow_ambient", reason: ON_TABLES },
    Exemption { function: "horizon_shadow_cell", reason: INSIDE },
    Exemption { function: "horizon_shadow_pair", reason: INSIDE },
    Exemption { function: "horizon_shadow_steepest", reason: INSIDE },
    Exemption { function: "horizon_shadow_weights", reason: INSIDE },
    Exemption { function: "horizon_shadow_codes", reason: "a part of horizon_shadow_candidate" },
    Exemption { function: "horizon_shadow_decoded", reason: "a part of horizon_shadow_candidate" },
    Exemption { function: "horizon_shadow_period", reason: "a part of horizon_shadow_wrapped" },
];

/// A case without textures.
fn case(
    function: &'static str,
    inputs: Vec<Input>,
    body: &'static str,
    outputs: &'static [&'static str],
    tolerance: Tolerance,
    model: impl Fn(&[f64]) -> Vec<f64> + Sync + 'static,
) -> StressCase {
    StressCase {
        function,
        library: &LIBRARY,
        inputs,
        body,
        outputs,
        model: Box::new(model),
        tolerance,
        bindings: None,
        samples: None,
    }
}

fn within(absolute: f64, relative: f64, reason: &'static str) -> Tolerance {
    Tolerance { absolute, relative, slack: None, reason }
}

const fn real(least: f32, greatest: f32) -> Input {
    Input::Real { least, greatest }
}
