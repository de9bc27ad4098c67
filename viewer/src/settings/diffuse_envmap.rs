//! The settings of diffuse-envmap by name.

use super::{Field, Technique, number_in, numbers};
use compositor::Settings;
use diffuse_envmap::{Base, Distribution, Horizon, Method, ParallaxBox};

pub(super) const TECHNIQUE: Technique = Technique {
    name: "diffuse-envmap",
    fields: &FIELDS,
    leave_out: |settings| settings.diffuse_envmap = None,
};

/// The method comes first, because three of the others exist only with the paper's.
const FIELDS: [Field; 10] = [
    Field {
        name: "method",
        expected: "paper or sheen",
        set: |settings, text| {
            let settings = of(settings);
            settings.method = match (text, settings.method) {
                ("paper", Method::Sheen) => diffuse_envmap::Settings::PAPER.method,
                ("paper", method @ Method::Paper { .. }) => method,
                ("sheen", _) => Method::Sheen,
                _ => return None,
            };
            Some(())
        },
    },
    Field {
        name: "rays",
        expected: "with method = paper a whole number, 1 to 4096",
        set: |settings, text| {
            let Method::Paper { rays, .. } = &mut of(settings).method else { return None };
            *rays = text.parse().ok().filter(|rays| (1..=4096).contains(rays))?;
            Some(())
        },
    },
    Field {
        name: "distribution",
        expected: "with method = paper: cosine or uniform-angle",
        set: |settings, text| {
            let Method::Paper { distribution, .. } = &mut of(settings).method else { return None };
            *distribution = match text {
                "cosine" => Distribution::Cosine,
                "uniform-angle" => Distribution::UniformAngle,
                _ => return None,
            };
            Some(())
        },
    },
    Field {
        name: "rotate",
        expected: "with method = paper: true or false",
        set: |settings, text| {
            let Method::Paper { rotate, .. } = &mut of(settings).method else { return None };
            *rotate = text.parse().ok()?;
            Some(())
        },
    },
    Field {
        name: "base",
        expected: "lerp or slerp",
        set: |settings, text| {
            of(settings).base = match text {
                "lerp" => Base::Lerp,
                "slerp" => Base::Slerp,
                _ => return None,
            };
            Some(())
        },
    },
    Field {
        name: "horizon",
        expected: "keep or discard",
        set: |settings, text| {
            of(settings).horizon = match text {
                "keep" => Horizon::Keep,
                "discard" => Horizon::Discard,
                _ => return None,
            };
            Some(())
        },
    },
    Field {
        name: "roughness_offset",
        expected: "a number, -1 to 1",
        set: |settings, text| {
            of(settings).roughness_offset = number_in(text, -1.0..=1.0)?;
            Some(())
        },
    },
    Field {
        name: "intensity",
        expected: "a number, 0 or above",
        set: |settings, text| {
            of(settings).intensity = number_in(text, 0.0..=1e9)?;
            Some(())
        },
    },
    Field {
        name: "one_tap_contrast",
        expected: "a number, 0 to 1",
        set: |settings, text| {
            of(settings).one_tap_contrast = number_in(text, 0.0..=1.0)?;
            Some(())
        },
    },
    Field {
        name: "parallax",
        expected: "off, or six numbers in metres (least corner x,y,z and greatest corner x,y,z of a box) and \
                   optionally three more (where the map was taken, the middle otherwise)",
        set: |settings, text| {
            of(settings).parallax = if text == "off" { None } else { Some(parallax_box(&numbers(text)?)?) };
            Some(())
        },
    },
];

fn of(settings: &mut Settings) -> &mut diffuse_envmap::Settings {
    settings.diffuse_envmap.get_or_insert_default()
}

/// The box that six or nine numbers describe; the centre lies inside it.
fn parallax_box(numbers: &[f32]) -> Option<ParallaxBox> {
    let (&min_world, rest) = numbers.split_first_chunk::<3>()?;
    let (&max_world, rest) = rest.split_first_chunk::<3>()?;
    let middle = std::array::from_fn(|axis| 0.5 * min_world[axis] + 0.5 * max_world[axis]);
    let centre_world = if rest.is_empty() { middle } else { rest.try_into().ok()? };
    let inside =
        (0..3).all(|axis| min_world[axis] < centre_world[axis] && centre_world[axis] < max_world[axis]);
    inside.then_some(ParallaxBox { min_world, max_world, centre_world })
}
