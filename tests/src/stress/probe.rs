//! A library function in a compute shader.

use super::inputs::Batch;
use crate::{
    Context, bindings,
    shot::no_errors,
    technique::{Bound, Failure, StressCase},
};
use compositor::wgpu::{self, util::DeviceExt as _};
use gpu_context::readback;

/// A function that is ready to run.
pub(super) struct Probe {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    bound: Option<Bound>,
    outputs: usize,
}

impl Probe {
    /// Compiles the case's shader.
    pub(super) fn new(context: &mut Context, case: &StressCase) -> Result<Self, Failure> {
        let bound = case.bindings.as_ref().map(|make| make(context)).transpose()?;
        let declarations = bound.as_ref().map_or("", |bound| &bound.declarations);
        let source = source(case, declarations);
        let outputs = case.outputs.len();
        let gpu = context.gpu();
        let (pipeline, layout) = gpu.checked(case.function, |device| {
            let layout =
                bindings::layout(device, "stress", &[bindings::storage(true), bindings::storage(false)]);
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(case.function),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            });
            let mut groups = vec![Some(&layout)];
            groups.extend(bound.iter().map(|bound| Some(&bound.layout)));
            let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(case.function),
                bind_group_layouts: &groups,
                immediate_size: 0,
            });
            let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(case.function),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some("stress"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
            (pipeline, layout)
        })?;
        Ok(Self { pipeline, layout, bound, outputs })
    }

    /// The function's values for a batch of inputs, one input's after the other's.
    pub(super) fn run(&self, context: &Context, batch: &Batch) -> Result<Vec<f32>, Failure> {
        let gpu = context.gpu();
        let count = batch.words.len() / batch.width.max(1);
        let bytes: Vec<u8> = batch.words.iter().flat_map(|word| word.to_ne_bytes()).collect();
        let answers = gpu.checked("stress inputs", |device| {
            let input = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("stress inputs"),
                contents: &bytes,
                usage: wgpu::BufferUsages::STORAGE,
            });
            let output = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("stress outputs"),
                size: (4 * count * self.outputs) as u64,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("stress"),
                layout: &self.layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: output.as_entire_binding() },
                ],
            });
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, &group, &[]);
                if let Some(bound) = &self.bound {
                    pass.set_bind_group(1, &bound.group, &[]);
                }
                pass.dispatch_workgroups((count as u32).div_ceil(64), 1, 1);
            }
            gpu.queue().submit([encoder.finish()]);
            output
        })?;
        let bytes = readback::read_buffer(gpu, &answers)?;
        no_errors(gpu)?;
        let (words, _) = bytes.as_chunks::<4>();
        Ok(words.iter().map(|word| f32::from_ne_bytes(*word)).collect())
    }
}

/// The whole shader. Words go through integers, because a float that is not a number may change its
/// bits on the way. Nothing here loops: drivers take long over shaders with many loops.
fn source(case: &StressCase, declarations: &str) -> String {
    let width: usize = case.inputs.iter().map(|input| input.width()).sum();
    let outputs = case.outputs.len();
    let list = |count: usize, item: &dyn Fn(usize) -> String| -> String {
        (0..count).map(item).collect::<Vec<_>>().join(", ")
    };
    let words = list(width, &|i| format!("stress_inputs[stress_index * {width}u + {i}u]"));
    let floats = list(width, &|i| format!("bitcast<f32>(u[{i}])"));
    let store = |i| format!("    stress_outputs[stress_index * {outputs}u + {i}u] = bitcast<u32>(y[{i}]);");
    let stores = (0..outputs).map(store).collect::<Vec<_>>().join("\n");
    format!(
        "{library}
@group(0) @binding(0) var<storage, read> stress_inputs: array<u32>;
@group(0) @binding(1) var<storage, read_write> stress_outputs: array<u32>;
{declarations}
@compute @workgroup_size(64)
fn stress(@builtin(global_invocation_id) stress_id: vec3u) {{
    let stress_index = stress_id.x;
    if stress_index >= arrayLength(&stress_inputs) / {width}u {{
        return;
    }}
    let u = array<u32, {width}>({words});
    let x = array<f32, {width}>({floats});
    var y: array<f32, {outputs}>;
    {body}
{stores}
}}
",
        library = case.library.source(),
        body = case.body,
    )
}
