//! Tests of lobes and of their mixtures.

#![allow(clippy::float_cmp, reason = "exact zeros and equal densities are meant")]

mod energy;
mod model;
mod robustness;
mod sampling;

use glam::DVec3;

use super::{Bsdf, Parameters};
use crate::{Lobe, chi_squared::integrate};

/// The direction at an angle from the normal.
fn at_degrees(incidence: f64) -> DVec3 {
    let (sine, cosine) = incidence.to_radians().sin_cos();
    // Off the axes, so that no symmetry hides a mistake.
    DVec3::new(sine * 0.8, sine * 0.6, cosine)
}

/// A white metal, of which the specular lobe alone is seen.
fn metal(roughness: f64) -> Parameters {
    Parameters { metallic: 1.0, roughness, ..Parameters::default() }
}

/// A surface without specular reflection.
fn matte() -> Parameters {
    Parameters { ks: Some([0.0; 3]), ..Parameters::default() }
}

fn blinn(exponent: f64) -> Bsdf {
    Bsdf::new(&Parameters { shininess: Some(exponent), ..metal(0.5) }, Lobe::Blinn)
}

fn cone(half_angle_deg: f64) -> Bsdf {
    let spread_rad = Some(half_angle_deg.to_radians());
    Bsdf::new(&Parameters { spread_rad, ..metal(0.5) }, Lobe::PhongCone)
}

/// The integral over the hemisphere of a function whose features lie about the mirror direction
/// of `outgoing` and are about `width` radians wide (a jump is allowed there): in polar coordinates about that direction,
/// the angle as width * sinh(x), which follows features of all sizes, and of each circle the part
/// above the horizon.
fn over_hemisphere(outgoing: DVec3, width: f64, f: &dyn Fn(DVec3) -> f64) -> f64 {
    let axis = super::mirrored(outgoing);
    let up = (DVec3::Z - axis.z * axis).try_normalize().unwrap_or(DVec3::X);
    let side = axis.cross(up);
    let lift = axis.z.asin();
    let integrand = |x: f64, share: f64| {
        let angle = width * x.sinh();
        let (sine, cosine) = angle.sin_cos();
        // Half the circle's part above the horizon.
        let reach = (-cosine * lift.sin() / (sine * lift.cos())).clamp(-1.0, 1.0).acos();
        let turn = reach * share;
        let direction = sine * (turn.cos() * up + turn.sin() * side) + cosine * axis;
        if direction.z <= 0.0 {
            return 0.0;
        }
        f(direction) * sine * width * x.cosh() * reach
    };
    // The circles begin to dip at `lift` and are below from pi - lift on. Near the first the reach
    // falls like a root.
    let between = |from: f64, to: f64| {
        let inside = |y: f64, share: f64| {
            let slope = 2.0 * (to - from) * y;
            if slope == 0.0 { 0.0 } else { slope * integrand(from + (to - from) * y * y, share) }
        };
        let part = |i: i32| integrate(&inside, [f64::from(i) / 8.0, f64::from(i + 1) / 8.0, -1.0, 1.0], 1e-7);
        (0..8).map(part).sum::<f64>()
    };
    let last = std::f64::consts::PI - lift;
    let mut ends = [0.0, lift, width.min(last), last].map(|angle| (angle / width).asinh());
    ends.sort_by(f64::total_cmp);
    ends.windows(2).map(|pair| between(pair[0], pair[1])).sum()
}

/// The share of an even light that is reflected, by quadrature (red channel).
fn albedo(bsdf: &Bsdf, outgoing: DVec3, width: f64) -> f64 {
    over_hemisphere(outgoing, width, &|incoming| bsdf.evaluate(outgoing, incoming).value[0])
}
