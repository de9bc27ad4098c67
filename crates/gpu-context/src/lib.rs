//! A wgpu device with or without a window, and the few things that every user of one needs.
//!
//! - [`Gpu`] is a device and its queue: brought up without a window by [`Gpu::headless`], or lent
//!   by a host through [`Gpu::from_host`]. Failures arrive as values: [`Gpu::checked`] for work
//!   whose size a user chose, [`Gpu::take_errors`] for everything that nobody waited for.
//! - [`Timer`] names and times spans of GPU work.
//! - [`upload`] makes textures, [`Mipmaps`] their mip chains, [`readback`] brings texels and
//!   buffers back.
//! - [`Work`] and [`Skip`] are a technique's account of what it did.
//!
//! The crate keeps no cache, sets no policy and reads no file or environment variable.
//!
//! ```no_run
//! use gpu_context::{Gpu, HeadlessDesc, readback, upload};
//!
//! # fn main() -> Result<(), gpu_context::Error> {
//! let gpu = Gpu::headless(&HeadlessDesc::default())?;
//! let texels = [[0.5, 1.0, 2.0, 1.0]; 6];
//! let texture = upload::rgba16_float(&gpu, "example", 3, 2, &texels, None)?;
//! let image = readback::read_texture(&gpu, &texture, 0, 0)?;
//! assert_eq!(image.values[..4], [0.5, 1.0, 2.0, 1.0]);
//! # Ok(())
//! # }
//! ```

mod device_error;
mod error;
mod gpu;
mod headless;
mod mipmaps;
pub mod readback;
mod timer;
pub mod upload;
mod work;

pub use device_error::DeviceError;
pub use error::Error;
pub use gpu::Gpu;
pub use headless::HeadlessDesc;
pub use mipmaps::{Mipmaps, mip_level_count};
pub use readback::FloatImage;
pub use timer::{PassScope, Scope, Timer, Timing};
pub use wgpu;
pub use work::{Skip, Work};
