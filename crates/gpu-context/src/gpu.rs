//! The device, its queue, and how failures of either reach the caller.

use crate::{DeviceError, Error, device_error::ErrorList};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A device and its queue. Clones share both.
#[derive(Clone, Debug)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    adapter_info: wgpu::AdapterInfo,
    errors: ErrorList,
}

impl Gpu {
    /// Wraps a host's device and queue, which stay the host's.
    ///
    /// The host's handlers of uncaptured errors and of device loss are left alone, so
    /// [`take_errors`](Self::take_errors) stays empty until [`collect_errors`](Self::collect_errors)
    /// is called. `adapter_info` is the answer of [`wgpu::Device::adapter_info`].
    pub fn from_host(device: wgpu::Device, queue: wgpu::Queue, adapter_info: wgpu::AdapterInfo) -> Self {
        Self { device, queue, adapter_info, errors: ErrorList::default() }
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// What the driver says of the adapter.
    pub fn adapter_info(&self) -> &wgpu::AdapterInfo {
        &self.adapter_info
    }

    /// The adapter's name, backend and driver on one line, for figures and reports.
    pub fn adapter_label(&self) -> String {
        adapter_label(&self.adapter_info)
    }

    /// Replaces the device's handlers of uncaptured errors and of device loss by ones that keep
    /// them for [`take_errors`](Self::take_errors). A headless device has them from the start.
    pub fn collect_errors(&self) {
        self.errors.attach(&self.device);
    }

    /// Errors that no call's result carried, in order of arrival, since the last call.
    ///
    /// The first 32 are kept with their text, further ones are counted. The loss of the device
    /// arrives here too.
    pub fn take_errors(&self) -> Vec<DeviceError> {
        self.errors.take()
    }

    /// Runs `f` and returns its result, or the error that the device raised meanwhile.
    ///
    /// Put every allocation in here whose size a user chose. `what` names it in the error's text.
    /// Objects that `f` made are invalid where an error is returned; drop them.
    /// [`Error::OutOfMemory`] (which wgpu's OpenGL does not report), [`Error::Validation`],
    /// [`Error::Internal`] and [`Error::Lost`] arise.
    pub fn checked<T>(&self, what: &str, f: impl FnOnce(&wgpu::Device) -> T) -> Result<T, Error> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let value = f(&self.device);
        let internal = pollster::block_on(internal.pop());
        let validation = pollster::block_on(validation.pop());
        let memory = pollster::block_on(memory.pop());
        // Exhausted memory explains the others, so it goes first.
        if let Some(error) = memory.or(validation).or(internal) {
            return Err(Error::from_wgpu(what, error));
        }
        self.check_lost()?;
        Ok(value)
    }

    /// Blocks until all submitted work is done and its callbacks have run.
    ///
    /// [`Error::Lost`] where the device was lost before or meanwhile.
    pub fn wait(&self) -> Result<(), Error> {
        self.check_lost()?;
        // wgpu panics where the driver reports the loss of the device to a waiting call.
        let polled = catch_unwind(AssertUnwindSafe(|| self.device.poll(wgpu::PollType::wait_indefinitely())));
        match polled {
            Ok(Ok(_)) => self.check_lost(),
            Ok(Err(error)) => {
                Err(Error::Internal { what: "waiting for the GPU".into(), message: error.to_string() })
            }
            Err(_) => {
                self.errors.lose("the driver reported a loss while waiting".into());
                self.check_lost()
            }
        }
    }

    /// [`Error::Lost`] where the device is known to be lost.
    pub fn check_lost(&self) -> Result<(), Error> {
        self.errors.lost().map_or(Ok(()), |message| Err(Error::Lost { message }))
    }

    /// [`Error::MissingFeature`] where the device was made without one of `features`.
    pub(crate) fn require(&self, what: &str, features: wgpu::Features) -> Result<(), Error> {
        let missing = features.difference(self.device.features());
        if missing.is_empty() {
            return Ok(());
        }
        Err(Error::MissingFeature { what: what.to_owned(), features: missing.to_string() })
    }
}

/// One line that tells one adapter from another: name, backend, driver.
pub(crate) fn adapter_label(info: &wgpu::AdapterInfo) -> String {
    let driver = [info.driver.as_str(), info.driver_info.as_str()];
    let driver: Vec<_> = driver.into_iter().filter(|part| !part.is_empty()).collect();
    let driver = if driver.is_empty() { String::new() } else { format!(", {}", driver.join(" ")) };
    format!("{} ({}{driver})", info.name, backend_name(info.backend))
}

/// The backend as people write it.
pub(crate) fn backend_name(backend: wgpu::Backend) -> &'static str {
    match backend {
        wgpu::Backend::Vulkan => "Vulkan",
        wgpu::Backend::Metal => "Metal",
        wgpu::Backend::Dx12 => "Direct3D 12",
        wgpu::Backend::Gl => "OpenGL",
        wgpu::Backend::BrowserWebGpu => "WebGPU",
        wgpu::Backend::Noop => "no backend",
    }
}
