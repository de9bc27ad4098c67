//! The methods that are compared, and their settings.

use crate::technique::Role;
use horizon_shadow::{Method, Precision, Settings, Tables};

/// A way to tell what lies in shadow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Way {
    /// Bump-mapped normals without shadows.
    None,
    /// The horizon map of a flat surface (Forsyth).
    Flat,
    /// As published.
    Paper(Tables),
    /// The published tables with the exact curved horizon.
    Exact,
    /// Ours with so many candidates.
    Sheen(u32, Precision),
    /// Ours, where the extents of tiles decide first.
    Tiles,
    /// Ours, undecided pixels marched.
    Certified,
    /// The relief marched in so many steps.
    Marched(u32),
    /// Depth from the light, of the displaced mesh.
    ShadowMap,
}

/// What the project offers by default.
pub(super) const OURS: Way = Way::Sheen(2, Precision::Compact);
/// The published method with its better layout.
pub(super) const PAPER: Way = Way::Paper(Tables::BetaAndDistance);

impl Way {
    /// All that a table of queries can be given, with one candidate where the curvature is constant.
    pub(super) fn all(is_constant: bool) -> Vec<Self> {
        let mut all = vec![
            Self::None,
            Self::Flat,
            PAPER,
            Self::Paper(Tables::DistanceAndHeight),
            Self::Exact,
            OURS,
            Self::Sheen(3, Precision::Compact),
            Self::Sheen(4, Precision::Compact),
            Self::Sheen(2, Precision::Full),
            Self::Sheen(4, Precision::Full),
            Self::Certified,
            Self::Marched(16),
            Self::Marched(64),
            Self::Marched(256),
        ];
        if is_constant {
            all.insert(5, Self::Sheen(1, Precision::Compact));
        }
        all
    }

    /// Those of scenes that add no new question about the rest.
    pub(super) fn main() -> Vec<Self> {
        vec![
            Self::None,
            Self::Flat,
            PAPER,
            Self::Exact,
            OURS,
            Self::Sheen(4, Precision::Compact),
            Self::Certified,
            Self::Marched(64),
            Self::Marched(256),
        ]
    }

    /// Those of a quick run.
    pub(super) fn few() -> Vec<Self> {
        vec![Self::None, Self::Flat, PAPER, Self::Exact, OURS, Self::Certified, Self::Marched(64)]
    }

    /// The name in every report.
    pub(super) fn name(self) -> String {
        match self {
            Self::None => "none".into(),
            Self::Flat => "flat".into(),
            Self::Paper(Tables::BetaAndDistance) => "paper".into(),
            Self::Paper(Tables::DistanceAndHeight) => "paper, eq. 4".into(),
            Self::Exact => "exact".into(),
            Self::Sheen(count, Precision::Compact) => format!("sheen K={count}"),
            Self::Sheen(count, Precision::Full) => format!("sheen K={count}, full"),
            Self::Tiles => format!("{}, tiles first", OURS.name()),
            Self::Certified => "certified".into(),
            Self::Marched(steps) => format!("marched, {steps} steps"),
            Self::ShadowMap => "shadow map".into(),
        }
    }

    /// Its part.
    pub(super) fn role(self) -> Role {
        match self {
            Self::Sheen(..) | Self::Tiles | Self::Certified => Role::Ours,
            Self::Paper(_) => Role::Paper,
            _ => Role::Baseline,
        }
    }

    /// Methods that differ in one number only.
    pub(super) fn series(self) -> Option<String> {
        match self {
            Self::Sheen(_, Precision::Compact) => Some("sheen".into()),
            Self::Marched(_) => Some("marched".into()),
            _ => None,
        }
    }

    /// The technique's settings, for tables of so many azimuths and a search of this radius;
    /// without prefiltering, which blurs what is measured here.
    pub(super) fn settings(self, azimuths: u32, radius_texels: f32) -> Settings {
        let base = Settings { prefilter: false, azimuths, radius_texels, ..Settings::SHEEN };
        match self {
            Self::None | Self::ShadowMap => Settings { method: Method::None, ..base },
            Self::Flat => Settings { method: Method::Flat, ..base },
            Self::Paper(tables) => Settings { method: Method::Paper, tables, ..base },
            Self::Exact => Settings { method: Method::Exact, ..base },
            Self::Sheen(candidates, precision) => Settings { candidates, precision, ..base },
            Self::Tiles => Settings { tiles: true, ..OURS.settings(azimuths, radius_texels) },
            Self::Certified => Settings { method: Method::Certified, ..base },
            Self::Marched(march_steps) => Settings { method: Method::Marched, march_steps, ..base },
        }
    }
}
