//! Tests of lobes and of their mixtures.

mod energy;
mod model;
mod robustness;
mod sampling;

use std::f64::consts::TAU;

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
/// of `outgoing` and are about `width` radians wide: in polar coordinates about that direction,
/// the angle as width * sinh(x), which follows features of all sizes.
fn over_hemisphere(outgoing: DVec3, width: f64, f: &dyn Fn(DVec3) -> f64) -> f64 {
    let frame = crate::frame::Frame::new(super::mirrored(outgoing));
    let last = (std::f64::consts::PI / width).asinh();
    let integrand = |x: f64, turn: f64| {
        let angle = width * x.sinh();
        let direction = frame.world_from_local(super::azimuthal(angle.sin(), angle.cos(), turn / TAU));
        if direction.z > 0.0 { f(direction) * angle.sin() * width * x.cosh() } else { 0.0 }
    };
    let step = last / 8.0;
    (0..8)
        .map(|i| {
            let from = f64::from(i) * step;
            integrate(&integrand, [from, from + step, 0.0, TAU], 1e-7)
        })
        .sum()
}

/// The share of an even light that is reflected, by quadrature (red channel).
fn albedo(bsdf: &Bsdf, outgoing: DVec3, width: f64) -> f64 {
    over_hemisphere(outgoing, width, &|incoming| bsdf.evaluate(outgoing, incoming).value[0])
}
