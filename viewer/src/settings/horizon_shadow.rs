//! The settings of horizon-shadow by name.

use super::{Field, Technique, number_in};
use compositor::Settings;
use horizon_shadow::{Method, Precision, Search, Tables};
use std::{ops::RangeInclusive, str::FromStr};

pub(super) const TECHNIQUE: Technique = Technique {
    name: "horizon-shadow",
    fields: &FIELDS,
    leave_out: |settings| settings.horizon_shadow = None,
};

const FIELDS: [Field; 12] = [
    Field {
        name: "method",
        expected: "none, flat, paper, exact, sheen, certified or marched",
        set: |settings, text| {
            of(settings).method = match text {
                "none" => Method::None,
                "flat" => Method::Flat,
                "paper" => Method::Paper,
                "exact" => Method::Exact,
                "sheen" => Method::Sheen,
                "certified" => Method::Certified,
                "marched" => Method::Marched,
                _ => return None,
            };
            Some(())
        },
    },
    Field {
        name: "march_steps",
        expected: "a whole number, 1 to 1024",
        set: |settings, text| {
            of(settings).march_steps = whole_in(text, 1..=1024)?;
            Some(())
        },
    },
    Field {
        name: "prefilter",
        expected: "true or false",
        set: |settings, text| {
            of(settings).prefilter = text.parse().ok()?;
            Some(())
        },
    },
    Field {
        name: "tiles",
        expected: "true or false",
        set: |settings, text| {
            of(settings).tiles = text.parse().ok()?;
            Some(())
        },
    },
    Field {
        name: "ambient",
        expected: "true or false",
        set: |settings, text| {
            of(settings).ambient = text.parse().ok()?;
            Some(())
        },
    },
    Field {
        name: "azimuths",
        expected: "a whole number, 4 to 64",
        set: |settings, text| {
            of(settings).azimuths = whole_in(text, 4..=64)?;
            Some(())
        },
    },
    Field {
        name: "candidates",
        expected: "a whole number, 1 to 4",
        set: |settings, text| {
            of(settings).candidates = whole_in(text, 1..=4)?;
            Some(())
        },
    },
    Field {
        name: "precision",
        expected: "compact or full",
        set: |settings, text| {
            of(settings).precision = match text {
                "compact" => Precision::Compact,
                "full" => Precision::Full,
                _ => return None,
            };
            Some(())
        },
    },
    Field {
        name: "tables",
        expected: "beta-and-distance or distance-and-height",
        set: |settings, text| {
            of(settings).tables = match text {
                "beta-and-distance" => Tables::BetaAndDistance,
                "distance-and-height" => Tables::DistanceAndHeight,
                _ => return None,
            };
            Some(())
        },
    },
    Field {
        name: "search",
        expected: "sweep or brute-force",
        set: |settings, text| {
            of(settings).search = match text {
                "sweep" => Search::Sweep,
                "brute-force" => Search::BruteForce,
                _ => return None,
            };
            Some(())
        },
    },
    Field {
        name: "radius_texels",
        expected: "a number, 2 to 4096",
        set: |settings, text| {
            of(settings).radius_texels = number_in(text, 2.0..=4096.0)?;
            Some(())
        },
    },
    Field {
        name: "azimuths_per_prepare",
        expected: "a whole number, 1 or above",
        set: |settings, text| {
            of(settings).azimuths_per_prepare = whole_in(text, 1..=u32::MAX)?;
            Some(())
        },
    },
];

fn of(settings: &mut Settings) -> &mut horizon_shadow::Settings {
    settings.horizon_shadow.get_or_insert_default()
}

/// One whole number of a range.
fn whole_in(text: &str, range: RangeInclusive<u32>) -> Option<u32> {
    u32::from_str(text).ok().filter(|number| range.contains(number))
}
