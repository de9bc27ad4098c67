//! Settings by name: `technique.field=value` of the command line, and the tables of scene files.

mod diffuse_envmap;
mod horizon_shadow;

use compositor::Settings;
use scene::{Error, Scene, Warning};

/// The techniques of this program, in the order of the frame. A new one is one line.
const TECHNIQUES: [Technique; 2] = [diffuse_envmap::TECHNIQUE, horizon_shadow::TECHNIQUE];

/// A technique by name.
struct Technique {
    name: &'static str,
    /// In the order in which they are set, whatever the order in which they were given.
    fields: &'static [Field],
    leave_out: fn(&mut Settings),
}

/// A field by name.
struct Field {
    name: &'static str,
    /// What values it takes, to follow "expected".
    expected: &'static str,
    /// Sets it; `None` where the text is no value of it.
    set: fn(&mut Settings, &str) -> Option<()>,
}

/// One `technique.field=value`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Assignment {
    technique: String,
    field: String,
    value: String,
}

impl Assignment {
    /// Takes the text apart and checks both names.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let parts = text.split_once('=').and_then(|(place, value)| Some((place.split_once('.')?, value)));
        let Some(((technique, field), value)) = parts else {
            return Err("expected technique.field=value, such as diffuse-envmap.method=paper".into());
        };
        let [technique, field, value] = [technique, field, value].map(|part| part.trim().to_owned());
        let assignment = Self { technique, field, value };
        let known = assignment.technique().ok_or_else(|| {
            format!(
                "unknown technique `{}`, expected {}",
                assignment.technique,
                suggest(&assignment.technique, &names())
            )
        })?;
        assignment.check_field(known).map_err(|(found, expected)| format!("{found}, expected {expected}"))?;
        Ok(assignment)
    }

    fn technique(&self) -> Option<&'static Technique> {
        TECHNIQUES.iter().find(|technique| technique.name == self.technique)
    }

    /// What was found and what was expected, where the field is none of the technique's.
    fn check_field(&self, technique: &Technique) -> Result<(), (String, String)> {
        let names: Vec<_> = technique.fields.iter().map(|field| field.name).collect();
        if names.contains(&self.field.as_str()) {
            return Ok(());
        }
        Err((format!("the unknown field `{}`", self.field), suggest(&self.field, &names)))
    }
}

fn suggest(unknown: &str, known: &[&str]) -> String {
    scene::suggestion(unknown, known)
}

/// The names of all techniques.
pub(crate) fn names() -> [&'static str; TECHNIQUES.len()] {
    TECHNIQUES.map(|technique| technique.name)
}

/// Makes every change; of two to the same field the later one counts. The error says `file`, the
/// field, what was found and what was expected.
pub(crate) fn apply(settings: &mut Settings, file: &str, assignments: &[Assignment]) -> Result<(), Error> {
    for technique in &TECHNIQUES {
        let own: Vec<_> = assignments.iter().filter(|entry| entry.technique == technique.name).collect();
        for assignment in &own {
            assignment.check_field(technique).map_err(|(found, expected)| {
                Error::new(file, format!("[{}]", technique.name), found, expected)
            })?;
        }
        for field in technique.fields {
            for assignment in own.iter().filter(|entry| entry.field == field.name) {
                (field.set)(settings, &assignment.value).ok_or_else(|| {
                    let place = format!("{}.{}", technique.name, field.name);
                    Error::new(file, place, format!("`{}`", assignment.value), field.expected)
                })?;
            }
        }
    }
    Ok(())
}

/// Makes the changes that a scene file asks for. Its tables for techniques that this program does
/// not have are left out, each with a warning.
pub(crate) fn apply_scene(settings: &mut Settings, scene: &Scene) -> Result<Vec<Warning>, Error> {
    let mut warnings = Vec::new();
    let mut assignments = Vec::new();
    for (technique, table) in &scene.technique_settings {
        if !names().contains(&technique.as_str()) {
            let message = "this program does not have the technique; its settings have no effect".into();
            warnings.push(Warning { file: scene.name.clone(), place: format!("[{technique}]"), message });
        }
        assignments.extend(table.iter().map(|(field, value)| Assignment {
            technique: technique.clone(),
            field: field.clone(),
            value: text_of(value),
        }));
    }
    apply(settings, &scene.name, &assignments)?;
    Ok(warnings)
}

/// Leaves out every technique that is not named; none where nothing is named.
pub(crate) fn keep_only(settings: &mut Settings, kept: &[String]) {
    let left_out =
        |technique: &&Technique| !kept.is_empty() && !kept.iter().any(|name| name == technique.name);
    TECHNIQUES.iter().filter(left_out).for_each(|technique| (technique.leave_out)(settings));
}

/// A TOML value as it would stand on the command line.
fn text_of(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        toml::Value::Integer(number) => number.to_string(),
        toml::Value::Float(number) => number.to_string(),
        toml::Value::Boolean(truth) => truth.to_string(),
        toml::Value::Datetime(time) => time.to_string(),
        toml::Value::Array(values) => values.iter().map(text_of).collect::<Vec<_>>().join(","),
        toml::Value::Table(_) => "a table".to_owned(),
    }
}

/// Finite numbers separated by commas, in brackets or not.
pub(crate) fn numbers(text: &str) -> Option<Vec<f32>> {
    let text = text.trim();
    let inner = text.strip_prefix('[').and_then(|text| text.strip_suffix(']')).unwrap_or(text);
    inner.split(',').map(number).collect()
}

/// One finite number.
fn number(text: &str) -> Option<f32> {
    text.trim().parse().ok().filter(|number: &f32| number.is_finite())
}

/// One number of a range.
fn number_in(text: &str, range: std::ops::RangeInclusive<f32>) -> Option<f32> {
    number(text).filter(|number| range.contains(number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::diffuse_envmap::{Base, Method};

    fn set_all(texts: &[&str]) -> Result<Settings, String> {
        let assignments: Result<Vec<_>, _> = texts.iter().map(|text| Assignment::parse(text)).collect();
        let mut settings = Settings::FULL;
        apply(&mut settings, "--set", &assignments?).map_err(|error| error.to_string())?;
        Ok(settings)
    }

    fn set(texts: &[&str]) -> Result<::diffuse_envmap::Settings, String> {
        set_all(texts)?.diffuse_envmap.ok_or_else(|| "off".to_owned())
    }

    #[test]
    fn fields_are_set_in_any_order() {
        for texts in [
            ["diffuse-envmap.rays=7", "diffuse-envmap.method=paper", "diffuse-envmap.base=slerp"],
            ["diffuse-envmap.method=paper", "diffuse-envmap.base=slerp", "diffuse-envmap.rays=7"],
        ] {
            let settings = set(&texts).unwrap();
            assert!(matches!(settings.method, Method::Paper { rays: 7, .. }), "{settings:?}");
            assert_eq!(settings.base, Base::Slerp);
        }
    }

    #[test]
    fn the_later_of_two_counts() {
        let settings =
            set(&["diffuse-envmap.one_tap_contrast=0.1", "diffuse-envmap.one_tap_contrast=0.7"]).unwrap();
        assert!((settings.one_tap_contrast - 0.7).abs() < 1e-6);
    }

    #[test]
    fn bad_names_and_values_say_what_was_expected() {
        let bad = [
            ("diffuse-envmap.methd=paper", "`method`"),
            ("difuse-envmap.method=paper", "`diffuse-envmap`"),
            ("diffuse-envmap.method=papr", "paper or sheen"),
            ("diffuse-envmap.rays=5", "with method = paper"),
            ("diffuse-envmap.one_tap_contrast=nan", "0 to 1"),
            ("diffuse-envmap.roughness_offset=1.5", "-1 to 1"),
            ("diffuse-envmap.intensity=-1", "0 or above"),
            ("diffuse-envmap.parallax=1,2,3", "six"),
            ("diffuse-envmap", "technique.field=value"),
            ("horizon-shadw.method=paper", "`horizon-shadow`"),
            ("horizon-shadow.metod=paper", "`method`"),
            ("horizon-shadow.method=sheeen", "certified or marched"),
            ("horizon-shadow.azimuths=3", "4 to 64"),
            ("horizon-shadow.candidates=5", "1 to 4"),
            ("horizon-shadow.candidates=1.5", "1 to 4"),
            ("horizon-shadow.radius_texels=nan", "2 to 4096"),
            ("horizon-shadow.march_steps=0", "1 to 1024"),
            ("horizon-shadow.azimuths_per_prepare=0", "1 or above"),
        ];
        for (text, expected) in bad {
            let error = set(&[text]).unwrap_err();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }

    #[test]
    fn tables_of_a_scene_file_use_the_same_names() {
        let text = "[diffuse-envmap]\nmethod = \"paper\"\nrays = 16\nparallax = [-1, 0, -1, 1, 2, 1]\n[glare]\nx = 1";
        let scene =
            scene::load::scene_file_from_str("s.toml", text, None, &scene::Limits::default()).unwrap();
        let mut settings = Settings::FULL;
        let warnings = apply_scene(&mut settings, &scene).unwrap();
        let technique = settings.diffuse_envmap.unwrap();
        assert!(matches!(technique.method, Method::Paper { rays: 16, .. }));
        assert_eq!(technique.parallax.unwrap().centre_world.map(|x| x as i32), [0, 1, 0]);
        assert!(matches!(warnings.as_slice(), [warning] if warning.place == "[glare]"), "{warnings:?}");

        let text = "[diffuse-envmap]\nbsae = \"slerp\"";
        let scene =
            scene::load::scene_file_from_str("s.toml", text, None, &scene::Limits::default()).unwrap();
        let error = apply_scene(&mut settings, &scene).unwrap_err().to_string();
        assert!(error.contains("s.toml") && error.contains("`base`"), "{error}");
    }

    #[test]
    fn every_field_of_horizon_shadow_is_set() {
        use ::horizon_shadow::{Method, Precision, Search, Settings, Tables};
        let settings = set_all(&[
            "horizon-shadow.method=certified",
            "horizon-shadow.march_steps=7",
            "horizon-shadow.prefilter=false",
            "horizon-shadow.tiles=true",
            "horizon-shadow.ambient=true",
            "horizon-shadow.azimuths=48",
            "horizon-shadow.candidates=3",
            "horizon-shadow.precision=full",
            "horizon-shadow.tables=distance-and-height",
            "horizon-shadow.search=brute-force",
            "horizon-shadow.radius_texels=12.5",
            "horizon-shadow.azimuths_per_prepare=2",
        ]);
        let expected = Settings {
            method: Method::Certified,
            march_steps: 7,
            prefilter: false,
            tiles: true,
            ambient: true,
            azimuths: 48,
            candidates: 3,
            precision: Precision::Full,
            tables: Tables::DistanceAndHeight,
            search: Search::BruteForce,
            radius_texels: 12.5,
            azimuths_per_prepare: 2,
        };
        assert_eq!(settings.unwrap().horizon_shadow, Some(expected));
        for (text, method) in [
            ("none", Method::None),
            ("flat", Method::Flat),
            ("paper", Method::Paper),
            ("exact", Method::Exact),
            ("sheen", Method::Sheen),
            ("marched", Method::Marched),
        ] {
            let settings = set_all(&[&format!("horizon-shadow.method={text}")]).unwrap();
            assert_eq!(settings.horizon_shadow.map(|settings| settings.method), Some(method), "{text}");
        }
    }

    #[test]
    fn techniques_that_are_not_named_are_left_out() {
        let mut settings = Settings::FULL;
        keep_only(&mut settings, &[]);
        assert!(settings.diffuse_envmap.is_some() && settings.horizon_shadow.is_some());
        keep_only(&mut settings, &["horizon-shadow".to_owned()]);
        assert!(settings.diffuse_envmap.is_none() && settings.horizon_shadow.is_some());
        keep_only(&mut settings, &["glare".to_owned()]);
        assert!(settings.horizon_shadow.is_none());
    }
}
