//! Named spans of GPU work and the time each took.

use crate::{Error, Gpu};
use wgpu_profiler::{GpuProfiler, GpuProfilerSettings, GpuTimerQueryResult};

/// A named span of an encoder's (or pass's) commands; ends when dropped. It stands in for the
/// encoder: pass `&mut scope` where `&mut CommandEncoder` is wanted.
///
/// `scope.scope(label)` nests a further span, `scope.scoped_render_pass(label, descriptor)` and
/// `scope.scoped_compute_pass(label)` a timed pass.
pub type Scope<'a, Recorder> = wgpu_profiler::Scope<'a, Recorder>;

/// A timed pass opened within a [`Scope`]; ends when dropped and stands in for the pass.
pub type PassScope<'a, Pass> = wgpu_profiler::OwningScope<'a, Pass>;

/// The time of one named span.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// The span's name.
    pub label: String,
    /// Time on the GPU in milliseconds, above 0. `None` where the device cannot measure this kind
    /// of span, or its clock did not move between the span's ends.
    pub time_ms: Option<f64>,
    /// Spans opened within this one, in order of their ends.
    pub children: Vec<Timing>,
}

/// Times named spans, one frame after the other.
///
/// ```no_run
/// # fn frame(gpu: &gpu_context::Gpu, timer: &mut gpu_context::Timer) -> Result<(), gpu_context::Error> {
/// let mut encoder = gpu.device().create_command_encoder(&Default::default());
/// {
///     let mut frame = timer.scope("frame", &mut encoder);
///     let mut geometry = frame.scope("geometry");
///     // Record commands with `&mut geometry` as the encoder.
/// }
/// timer.resolve(&mut encoder);
/// gpu.queue().submit([encoder.finish()]);
/// timer.end_frame()?;
/// gpu.wait()?; // Or poll, and ask again in a later frame.
/// for timing in timer.finished_frame().into_iter().flatten() {
///     println!("{}: {:?} ms", timing.label, timing.time_ms);
/// }
/// # Ok(())
/// # }
/// ```
pub struct Timer {
    profiler: GpuProfiler,
    queue: wgpu::Queue,
}

impl Timer {
    /// Device features that timing profits from: passes, spans of an encoder, spans within a pass.
    /// A kind of span whose feature the device lacks is named in captures but not timed.
    pub const FEATURES: wgpu::Features = GpuProfiler::ALL_WGPU_TIMER_FEATURES;

    /// A timer for work on this device. The device's features decide what it can measure.
    pub fn new(gpu: &Gpu) -> Result<Self, Error> {
        let profiler =
            GpuProfiler::new(gpu.device(), GpuProfilerSettings::default()).map_err(out_of_order)?;
        Ok(Self { profiler, queue: gpu.queue().clone() })
    }

    /// Opens a named span on an encoder, a render pass or a compute pass.
    pub fn scope<'a, Recorder: wgpu_profiler::ProfilerCommandRecorder>(
        &'a self,
        label: &str,
        recorder: &'a mut Recorder,
    ) -> Scope<'a, Recorder> {
        self.profiler.scope(label, recorder)
    }

    /// Records the collection of this frame's times: once, after the last span has ended, in the
    /// encoder that is submitted last.
    pub fn resolve(&mut self, encoder: &mut wgpu::CommandEncoder) {
        self.profiler.resolve_queries(encoder);
    }

    /// Ends the frame; call it after submitting. [`Error::Timer`] where a span is still open or
    /// [`resolve`](Self::resolve) was left out.
    pub fn end_frame(&mut self) -> Result<(), Error> {
        self.profiler.end_frame().map_err(out_of_order)
    }

    /// The spans of the oldest frame that the GPU has finished, `None` where it has finished none
    /// since the last call. After [`Gpu::wait`] every ended frame is finished. At most three
    /// frames wait to be taken; beyond that the newest is dropped.
    pub fn finished_frame(&mut self) -> Option<Vec<Timing>> {
        let frame = self.profiler.process_finished_frame(self.queue.get_timestamp_period())?;
        Some(frame.into_iter().map(timing).collect())
    }
}

fn out_of_order(error: impl std::fmt::Display) -> Error {
    Error::Timer { message: error.to_string() }
}

fn timing(result: GpuTimerQueryResult) -> Timing {
    let time_ms = result.time.map(|time_s| (time_s.end - time_s.start) * 1000.0);
    Timing {
        label: result.label,
        time_ms: time_ms.filter(|&time_ms| time_ms > 0.0),
        children: result.nested_queries.into_iter().map(timing).collect(),
    }
}
