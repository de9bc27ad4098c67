//! How wrong our methods may be, and why: a quarter more than they are on the adapter that they were
//! measured on, so that a change for the worse shows. The goals stand in a table of the figures.

use super::{
    lab::Quantity,
    metrics,
    ways::{OURS, Way},
};
use crate::{
    Scope,
    technique::{Metric, Threshold},
};

/// What a limit leaves for other adapters and compilers.
const MARGIN: f64 = 1.25;

/// Fewer of a window's pixels than this are single ones, which compilers decide.
const FEW: f64 = 4e-4;

/// What was reached of a scene, quick and whole: pixels of the windows on the wrong side, mean
/// distance of the shadows' boundaries in texels, mean error of the horizons in degrees, and pixels on
/// the wrong side with undecided pixels marched.
type Reached<const N: usize> = (&'static str, Option<[f64; N]>, [f64; N]);

const TABLES: [Reached<4>; 16] = [
    ("sphere-15-cylinders", Some([0.00391, 0.0676, 0.779, 0.00217]), [0.00752, 0.137, 0.759, 0.0032]),
    ("sphere-15-rough", Some([0.00608, 0.0228, 0.664, 0.000434]), [0.0085, 0.0661, 0.68, 0.00145]),
    ("saddle-rough", Some([0.0399, 0.104, 0.743, 0.0174]), [0.0144, 0.125, 0.746, 0.00735]),
    ("sphere-5-cylinders", None, [0.0072, 0.11, 0.812, 0.000717]),
    ("sphere-5-rough", None, [0.0109, 0.0661, 0.647, 0.000519]),
    ("sphere-15-smooth", None, [0.00185, 0.0664, 0.277, 0.000824]),
    ("plane-rough", None, [0.0139, 0.0859, 0.666, 0.000168]),
    ("cylinder-rough", None, [0.0072, 0.0611, 0.649, 0.00162]),
    ("hollow-rough", None, [0.0149, 0.125, 0.738, 0.00749]),
    ("torus-craters", None, [0.00697, 0.0573, 0.445, 0.00185]),
    ("sphere-reptile", None, [0.00864, 0.0677, 0.692, 0.000397]),
    ("bezier-reptile", None, [0.00841, 0.0647, 0.686, 0.000671]),
    ("dunes-ripples", None, [0.0288, 1.67, 1.62, 0.0203]),
    ("sphere-brick", None, [0.00594, 0.0551, 0.402, 0.000229]),
    ("sphere-jacksboro", None, [0.00333, 0.0432, 0.205, 0.000168]),
    ("sphere-shapes", None, [0.00111, 0.0572, 0.0911, 0.000336]),
];

/// The same of pictures: pixels on the wrong side of ours, and with undecided pixels marched.
const PICTURES: [Reached<2>; 3] = [
    ("sphere-15-rough", Some([0.0104, 0.00379]), [0.0104, 0.00355]),
    ("sphere-reptile", None, [0.0103, 0.00184]),
    ("saddle-rough", None, [0.0206, 0.00831]),
];

fn of<const N: usize>(scope: &Scope, table: &[Reached<N>], scene: &str) -> Option<[f64; N]> {
    let (_, quick, whole) = table.iter().find(|(name, ..)| *name == scene)?;
    if scope.quick { *quick } else { Some(*whole) }
}

/// Limits of a scene's windows or horizons.
pub(super) fn table(scope: &Scope, scene: &str, quantity: Quantity) -> Vec<Threshold> {
    let Some([wrong, boundary, horizon, certified]) = of(scope, &TABLES, scene) else { return Vec::new() };
    match quantity {
        Quantity::Visibility => vec![
            limit(OURS, metrics::MISCLASSIFIED, wrong, EDGES),
            limit(OURS, metrics::BOUNDARY_MEAN, boundary, EDGES),
            limit(Way::Certified, metrics::MISCLASSIFIED, certified.max(FEW), MARCHED),
        ],
        Quantity::Horizon => vec![limit(OURS, metrics::HORIZON_MEAN, horizon, BETWEEN)],
    }
}

const EDGES: &str = "edges of shadows between the texels and azimuths of the tables; where the curvature differs from \
     direction to direction also what the turn by torsion leaves";
const BETWEEN: &str =
    "most is the blend between texels and azimuths, then the stretch of the map along the ray";

/// Limits of a picture.
pub(super) fn picture(scope: &Scope, scene: &str) -> Vec<Threshold> {
    let Some([ours, certified]) = of(scope, &PICTURES, scene) else { return Vec::new() };
    vec![
        limit(OURS, metrics::MISCLASSIFIED, ours, EDGES),
        limit(Way::Certified, metrics::MISCLASSIFIED, certified, MARCHED),
    ]
}

const MARCHED: &str =
    "what the tables cannot decide is marched: frames between vertices and the map's stretch are left";

fn limit(way: Way, metric: &'static str, reached: f64, reason: &'static str) -> Threshold {
    Threshold { method: way.name(), metric: Metric::Custom(metric), at_most: MARGIN * reached, reason }
}
