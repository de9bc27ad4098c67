//! Where one azimuth is sampled, and the curved profile of the base at those distances.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::{Contents, TableDesc, codes::Codes};

/// What lies at a distance along a base of constant curvature: `[s, c, cos(gamma), distance]` of
/// the exact horizon, tan = (H cos(gamma) - (1 + kappa h) c) / ((1 + kappa (h + H)) s). All zero
/// beyond a quarter turn, where nothing is seen.
pub(crate) type ProfilePoint = [f32; 4];

/// The samples of one azimuth.
#[derive(Clone, Debug)]
pub(crate) struct Samples {
    /// From one sample to the next in texels; half a texel along the greater of both axes.
    pub(crate) advance: [f32; 2],
    /// The same length, texels.
    pub(crate) step: f32,
    /// The first sample that may be the horizon.
    pub(crate) first: u32,
    /// The last sample within the radius.
    pub(crate) last: u32,
    /// Points of the profile for each node: those of all samples, and two more.
    pub(crate) profile_row: u32,
    /// For each curvature node a row of points, then for each node one for every distance code where
    /// candidates are compact.
    pub(crate) profile: Vec<ProfilePoint>,
    /// For each node the last point of its row within a quarter turn.
    pub(crate) last_seen: Vec<u32>,
}

impl Samples {
    pub(crate) fn new(desc: &TableDesc, azimuth: u32) -> Self {
        let angle_rad = TAU * f64::from(azimuth) / f64::from(desc.azimuths);
        // Quarter turns are exact, so that their samples stay on the texels' centres.
        let direction = [angle_rad.cos(), angle_rad.sin()].map(|c| if c.abs() < 1e-12 { 0.0 } else { c });
        let step = 0.5 / direction[0].abs().max(direction[1].abs());
        let last = (f64::from(desc.radius_texels) / step).floor() as u32;
        let profile_row = last + 3;
        let nodes = desc.nodes();
        let point = |node: &f32, distance: f64| profile_point(f64::from(*node), distance);
        let mut profile: Vec<_> = nodes
            .iter()
            .flat_map(|node| (0..profile_row).map(move |sample| point(node, f64::from(sample) * step)))
            .collect();
        let rows = profile.chunks_exact(profile_row as usize);
        let last_seen =
            rows.map(|row| row.iter().rposition(|point| point[2] > 0.0).unwrap_or(0) as u32).collect();
        if let Some(codes) = desc.adjusted_codes() {
            profile.extend(nodes.iter().flat_map(|node| {
                let distances = 0..=codes.greatest_distance_code();
                distances.map(move |code| point(node, f64::from(codes.distance(code))))
            }));
        }
        Self {
            advance: direction.map(|c| (c * step) as f32),
            step: step as f32,
            first: if desc.candidates() > 0 { (1.0 / step).ceil() as u32 } else { 1 },
            last,
            profile_row,
            profile,
            last_seen,
        }
    }
}

impl TableDesc {
    /// The codes whose distances are so coarse that the slope makes up for what rounding them
    /// changes: those of compact candidates.
    pub(crate) fn adjusted_codes(&self) -> Option<Codes> {
        match self.contents {
            Contents::Candidates { precision: crate::Precision::Compact, .. } => {
                Some(Codes::new(crate::Precision::Compact, self.radius_texels))
            }
            _ => None,
        }
    }
}

fn profile_point(kappa: f64, distance: f64) -> ProfilePoint {
    let gamma = kappa * distance;
    if gamma.abs() >= FRAC_PI_2 {
        return [0.0; 4];
    }
    let sinc = |x: f64| if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { x.sin() / x };
    let (s, half) = (distance * sinc(gamma), sinc(0.5 * gamma));
    let c = 0.5 * kappa * distance * distance * half * half;
    [s, c, gamma.cos(), distance].map(|x| x as f32)
}
