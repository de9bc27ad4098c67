//! Bringing up a device without a window.

use crate::{Error, Gpu, gpu::adapter_label};
use wgpu::Backends;

/// Backends in the order in which they are tried.
const ORDER: [Backends; 4] = [Backends::VULKAN, Backends::METAL, Backends::DX12, Backends::GL];

/// What a device without a window must offer.
#[derive(Clone, Debug)]
pub struct HeadlessDesc<'a> {
    /// A part of the adapter's name, upper and lower case alike; `None` takes the first that fits.
    pub adapter_name: Option<&'a str>,
    /// Backends that may be used. Vulkan is tried first, OpenGL last.
    pub backends: Backends,
    /// Features without which an adapter is passed over.
    pub required_features: wgpu::Features,
    /// Features that the device gets where the adapter has them.
    pub optional_features: wgpu::Features,
    /// Limits without which an adapter is passed over. The sizes of textures and buffers are
    /// raised to what the adapter offers.
    pub required_limits: wgpu::Limits,
}

impl Default for HeadlessDesc<'_> {
    /// Any adapter on Vulkan or OpenGL (or the platform's own API where wgpu was built with it)
    /// with wgpu's default limits; GPU timings and filtering of 32-bit floats where there are.
    fn default() -> Self {
        Self {
            adapter_name: None,
            backends: Backends::all(),
            required_features: wgpu::Features::empty(),
            optional_features: crate::Timer::FEATURES | wgpu::Features::FLOAT32_FILTERABLE,
            required_limits: wgpu::Limits::default(),
        }
    }
}

impl Gpu {
    /// Makes a device without a window.
    ///
    /// Vulkan goes before OpenGL, and within a backend real GPUs go before software adapters:
    /// OpenGL is not even loaded where Vulkan has an adapter that fits. A host that would rather
    /// have a GPU on OpenGL than a software adapter on Vulkan says so in `backends`.
    /// [`Error::NoAdapter`] lists what was seen and why it was not taken.
    pub fn headless(desc: &HeadlessDesc<'_>) -> Result<Self, Error> {
        let mut seen = Vec::new();
        for backend in ORDER.into_iter().filter(|&backend| desc.backends.contains(backend)) {
            let mut adapters = adapters(backend);
            adapters.sort_by_key(|adapter| adapter.get_info().device_type == wgpu::DeviceType::Cpu);
            for adapter in adapters {
                match desc.open(&adapter) {
                    Ok(gpu) => return Ok(gpu),
                    Err(reason) => seen.push(format!("{} {reason}", adapter_label(&adapter.get_info()))),
                }
            }
        }
        Err(Error::NoAdapter { wanted: desc.wanted(), seen })
    }
}

impl HeadlessDesc<'_> {
    /// Why an adapter does not fit, `None` where it does.
    fn refusal(&self, adapter: &wgpu::Adapter) -> Option<String> {
        let name = adapter.get_info().name.to_lowercase();
        if self.adapter_name.is_some_and(|part| !name.contains(&part.to_lowercase())) {
            return Some("has another name".into());
        }
        let missing = self.required_features.difference(adapter.features());
        if !missing.is_empty() {
            return Some(format!("lacks {missing}"));
        }
        let mut refusal = None;
        self.required_limits.check_limits_with_fail_fn(
            &adapter.limits(),
            true,
            |limit, requested, offered| {
                refusal = Some(format!("offers {limit} {offered}, {requested} is needed"));
            },
        );
        refusal
    }

    /// Makes a device of an adapter, or says why it does not fit.
    fn open(&self, adapter: &wgpu::Adapter) -> Result<Gpu, String> {
        if let Some(reason) = self.refusal(adapter) {
            return Err(reason);
        }
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("headless"),
            required_features: self.required_features | (self.optional_features & adapter.features()),
            required_limits: self.limits(adapter),
            ..wgpu::DeviceDescriptor::default()
        });
        let (device, queue) =
            pollster::block_on(request).map_err(|error| format!("could not be opened: {error}"))?;
        let gpu = Gpu::from_host(device, queue, adapter.get_info());
        gpu.collect_errors();
        Ok(gpu)
    }

    /// The limits to ask of an adapter that fits: sizes that a user chooses are bounded by the
    /// adapter, everything else by the request, so that programs work alike on all adapters.
    fn limits(&self, adapter: &wgpu::Adapter) -> wgpu::Limits {
        let offered = adapter.limits();
        let limits = self.required_limits.clone();
        wgpu::Limits {
            max_texture_dimension_1d: limits.max_texture_dimension_1d.max(offered.max_texture_dimension_1d),
            max_texture_dimension_2d: limits.max_texture_dimension_2d.max(offered.max_texture_dimension_2d),
            max_texture_dimension_3d: limits.max_texture_dimension_3d.max(offered.max_texture_dimension_3d),
            max_buffer_size: limits.max_buffer_size.max(offered.max_buffer_size),
            ..limits
        }
    }

    /// The request in words, to follow "no graphics adapter".
    fn wanted(&self) -> String {
        let name = match self.adapter_name {
            Some(name) => format!("named \"{name}\""),
            None => "that fits".to_owned(),
        };
        if self.required_features.is_empty() {
            return name;
        }
        format!("{name} with {}", self.required_features)
    }
}

/// All adapters of one backend, through an instance of its own.
fn adapters(backend: Backends) -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: backend,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    pollster::block_on(instance.enumerate_adapters(backend))
}
