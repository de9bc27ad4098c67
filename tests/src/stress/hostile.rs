//! Scenes that try to break whole frames.

use crate::{
    Context,
    program::Run,
    shot::no_errors,
    technique::{Expectation, Failure, HostileScene},
};
use compositor::{Frame, SceneGpu, Settings, wgpu};
use gpu_context::{Timer, readback};
use serde::Serialize;
use std::time::{Duration, Instant};

/// A frame that takes longer hangs.
const LONGEST: Duration = Duration::from_secs(60);

/// One frame of a hostile scene.
#[derive(Clone, Debug, Serialize)]
pub(super) struct HostileRow {
    pub(super) technique: &'static str,
    pub(super) scene: String,
    pub(super) why: &'static str,
    pub(super) settings: String,
    /// What came of it, in words.
    pub(super) outcome: String,
    pub(super) passed: bool,
    /// Upload, compilation and rendering.
    pub(super) time_ms: f64,
}

impl HostileRow {
    pub(super) fn complaint(&self) -> Option<String> {
        let Self { technique, scene, settings, outcome, .. } = self;
        (!self.passed).then(|| format!("{technique}: {scene} ({settings}): {outcome}"))
    }
}

/// Renders a scene with each of its settings.
pub(super) fn rows(run: &mut Run<'_>, technique: &'static str, hostile: &HostileScene) -> Vec<HostileRow> {
    let mut rows = Vec::new();
    for (name, settings) in &hostile.settings {
        if run.context.is_stopped() {
            break;
        }
        let started = Instant::now();
        let result = run.guard(|context| frame(context, hostile, settings));
        let (passed, outcome) = judged(result, hostile.expectation);
        rows.push(HostileRow {
            technique,
            scene: hostile.name.clone(),
            why: hostile.why,
            settings: name.clone(),
            outcome,
            passed,
            time_ms: 1e3 * started.elapsed().as_secs_f64(),
        });
    }
    rows
}

/// Whether what came of a frame is what should.
fn judged(result: Result<String, String>, expectation: Expectation) -> (bool, String) {
    match (result, expectation) {
        (Ok(seen), Expectation::Picture) => (true, seen),
        (Err(error), Expectation::Picture) => (false, error),
        (Ok(seen), Expectation::Refusal(text)) => {
            (false, format!("{seen}; expected an error with \"{text}\""))
        }
        (Err(error), Expectation::Refusal(text)) => {
            let passed = error.contains(text) && !error.starts_with("panicked");
            (passed, format!("refused: {error}"))
        }
    }
}

/// Renders one frame and looks at every value; says what it saw.
fn frame(context: &mut Context, hostile: &HostileScene, settings: &Settings) -> Result<String, Failure> {
    let scene = (hostile.scene)()?;
    let [width, height] = hostile.size;
    let camera = hostile.camera.or(scene.camera);
    let camera = camera.unwrap_or_else(|| scene.framing_camera(width as f32 / height as f32));
    let uploaded = SceneGpu::upload(context.gpu(), &scene)?;
    let (gpu, compositor) = context.compositor()?;
    let timer = Timer::new(gpu)?;
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let lent = Frame { scene: &uploaded, camera: &camera, size: hostile.size, timer: &timer };
    compositor.render(gpu, &mut encoder, settings, &lent)?;
    let submission = gpu.queue().submit([encoder.finish()]);
    let wait = wgpu::PollType::Wait { submission_index: Some(submission), timeout: Some(LONGEST) };
    if gpu.device().poll(wait).is_err() {
        return Err(format!("the frame did not end within {} s", LONGEST.as_secs()).into());
    }
    let hdr = compositor.hdr().ok_or("the frame left no picture")?;
    let values = readback::read_texture(gpu, &hdr.texture, 0, 0)?.values;
    no_errors(gpu)?;
    let count = |is: fn(&f32) -> bool| values.iter().filter(|value| is(value)).count();
    let (nan, infinite, negative) =
        (count(|value| value.is_nan()), count(|value| value.is_infinite()), count(|value| *value < 0.0));
    if nan + infinite + negative > 0 {
        let all = values.len();
        return Err(format!("of {all} values {nan} are NaN, {infinite} infinite, {negative} negative").into());
    }
    let greatest = values.iter().copied().fold(0.0, f32::max);
    Ok(format!("a picture up to {greatest:.3e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_has_to_say_what_was_expected() {
        let refusal = Expectation::Refusal("too many");
        let error = |text: &str| Err(text.to_owned());
        assert!(judged(error("too many triangles"), refusal).0);
        assert!(!judged(error("panicked: too many"), refusal).0);
        assert!(!judged(error("out of memory"), refusal).0);
        assert!(!judged(Ok("a picture".into()), refusal).0);
        assert!(judged(Ok("a picture".into()), Expectation::Picture).0);
        assert!(!judged(error("of 4 values 1 are NaN"), Expectation::Picture).0);
    }
}
