//! The adapters on which the tests run.

use gpu_context::{Gpu, HeadlessDesc, wgpu::Backends};

/// A device per backend that this machine has: Vulkan and OpenGL. At least one must be there.
pub(crate) fn all_backends() -> Vec<Gpu> {
    let open = |backends| Gpu::headless(&HeadlessDesc { backends, ..HeadlessDesc::default() });
    let gpus: Vec<_> = [Backends::VULKAN, Backends::GL].into_iter().filter_map(|b| open(b).ok()).collect();
    assert!(!gpus.is_empty(), "no adapter: {}", open(Backends::all()).unwrap_err());
    for gpu in &gpus {
        println!("adapter: {}", gpu.adapter_label());
    }
    gpus
}
