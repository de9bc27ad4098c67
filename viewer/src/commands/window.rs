//! `sheen [FILE...]`: the window, or a picture where there is no display to open one on.

use super::{Failure, print, render};
use crate::{
    app::App,
    inputs::{self, Inputs},
    output::Format,
    settings,
};
use compositor::{Settings, wgpu};
use eframe::{NativeOptions, egui};
use egui_wgpu::{WgpuConfiguration, WgpuSetupCreateNew};
use gpu_context::Timer;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The picture that stands in for the window.
const PICTURE: &str = "sheen.png";
const PICTURE_SIZE: [u32; 2] = [1280, 720];

/// Backends in the order in which they are tried, as without a window.
const ORDER: [wgpu::Backend; 4] =
    [wgpu::Backend::Vulkan, wgpu::Backend::Metal, wgpu::Backend::Dx12, wgpu::Backend::Gl];

pub(crate) fn run(files: &[PathBuf]) -> Result<(), Failure> {
    let inputs = Inputs::of_files(files).map_err(Failure::Usage)?;
    let for_window = inputs.clone();
    let options = NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Sheen")
            .with_app_id("sheen")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([480.0, 320.0])
            .with_drag_and_drop(true),
        wgpu_options: WgpuConfiguration { wgpu_setup: setup().into(), ..WgpuConfiguration::default() },
        ..NativeOptions::default()
    };
    let run = eframe::run_native(
        "sheen",
        options,
        Box::new(move |context| Ok(Box::new(App::new(context, for_window)?))),
    );
    match run {
        Ok(()) => Ok(()),
        Err(eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_)) => without_display(&inputs),
        Err(eframe::Error::Wgpu(error)) => Err(Failure::Other(format!(
            "no graphics adapter can draw to the window ({error}). Install a driver for this machine's GPU, or \
             Mesa's software Vulkan driver (Debian, Ubuntu: apt-get install mesa-vulkan-drivers)"
        ))),
        Err(error) => Err(Failure::Other(error.to_string())),
    }
}

/// A picture of what the window would have shown.
fn without_display(inputs: &Inputs) -> Result<(), Failure> {
    print(&format!("There is no display to open a window on; rendering to {PICTURE} instead.\n"));
    let out = Path::new(PICTURE);
    let format = Format::of_path(out, &Format::ALL)?;
    let mut scene = inputs.load_lit()?;
    let mut changes = Settings::FULL;
    let notes = settings::apply_scene(&mut changes, &scene)?;
    scene.warnings.extend(notes);
    let camera = inputs::camera(&scene, PICTURE_SIZE);
    render::picture(&scene, &camera, PICTURE_SIZE, &changes, format, out)
}

/// The device that the window shares with the compositor. The environment variables `WGPU_BACKEND`
/// and `WGPU_POWER_PREF` have their usual effect on the backends.
fn setup() -> WgpuSetupCreateNew {
    WgpuSetupCreateNew {
        native_adapter_selector: Some(Arc::new(choose)),
        device_descriptor: Arc::new(describe),
        ..WgpuSetupCreateNew::without_display_handle()
    }
}

/// The first backend that can draw to the window, and on it a GPU before a software adapter.
fn choose(adapters: &[wgpu::Adapter], surface: Option<&wgpu::Surface<'_>>) -> Result<wgpu::Adapter, String> {
    let rank = |adapter: &&wgpu::Adapter| {
        let info = adapter.get_info();
        let backend = ORDER.iter().position(|backend| *backend == info.backend);
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::Cpu => 2,
            _ => 1,
        };
        (backend.unwrap_or(ORDER.len()), kind)
    };
    let usable =
        adapters.iter().filter(|adapter| surface.is_none_or(|surface| adapter.is_surface_supported(surface)));
    usable.min_by_key(rank).cloned().ok_or_else(|| format!("{} adapters, none of them fits", adapters.len()))
}

/// Everything that helps the compositor and that the adapter has.
fn describe(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    let offered = adapter.limits();
    let wanted = wgpu::Features::FLOAT32_FILTERABLE | Timer::FEATURES;
    wgpu::DeviceDescriptor {
        label: Some("sheen"),
        required_features: wanted & adapter.features(),
        required_limits: wgpu::Limits {
            max_texture_dimension_2d: offered.max_texture_dimension_2d,
            max_buffer_size: offered.max_buffer_size,
            ..wgpu::Limits::default()
        },
        ..wgpu::DeviceDescriptor::default()
    }
}
