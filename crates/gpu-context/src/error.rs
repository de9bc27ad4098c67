//! What a correct caller can meet, said so that it can be mended.

/// Why a call failed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// No adapter fits the request.
    #[error(
        "found no graphics adapter {wanted}; seen: {}. Install a driver for this machine's GPU, or Mesa's \
         software Vulkan driver (Debian, Ubuntu: apt-get install mesa-vulkan-drivers)",
        if seen.is_empty() { "none".to_owned() } else { seen.join("; ") }
    )]
    NoAdapter {
        /// What was asked for.
        wanted: String,
        /// Each adapter that was seen, with the reason why it was not taken.
        seen: Vec<String>,
    },
    /// The device was made without a feature that the call needs.
    #[error("{what} needs the device feature {features}: request it when the device is made")]
    MissingFeature {
        /// What was asked for.
        what: String,
        /// The missing features.
        features: String,
    },
    /// A size is beyond what the device allows.
    #[error("{what}: {found} is beyond the device's limit of {limit}; use a smaller size")]
    Limit {
        /// The object and the quantity.
        what: String,
        /// The size asked for.
        found: u64,
        /// The largest size allowed.
        limit: u64,
    },
    /// An argument does not fit the others.
    #[error("{what}: found {found}, expected {expected}")]
    Invalid {
        /// The object and the quantity.
        what: String,
        /// What was passed.
        found: String,
        /// What would have been accepted.
        expected: String,
    },
    /// The call has no meaning or no implementation for this texture format.
    #[error("{what}: format {format:?} is not supported; supported are {supported}")]
    UnsupportedFormat {
        /// The object.
        what: String,
        /// Its format.
        format: wgpu::TextureFormat,
        /// What would have been accepted.
        supported: &'static str,
    },
    /// Memory ran out, on the GPU or on the host.
    #[error("{what}: out of memory; use a smaller size or close other programs that use the GPU")]
    OutOfMemory {
        /// What was being made.
        what: String,
    },
    /// wgpu refused a call: a mistake in the caller's use of the device.
    #[error("{what}: refused by validation: {message}")]
    Validation {
        /// What was being done.
        what: String,
        /// wgpu's explanation.
        message: String,
    },
    /// The driver failed for a reason of its own.
    #[error("{what}: the graphics driver failed: {message}")]
    Internal {
        /// What was being done.
        what: String,
        /// The driver's or wgpu's explanation.
        message: String,
    },
    /// The device is gone and everything made with it: make a new one.
    #[error("the graphics device was lost ({message}); make a new device and load everything again")]
    Lost {
        /// The driver's explanation.
        message: String,
    },
    /// A buffer could not be read by the host.
    #[error("{what}: the GPU's answer could not be read: {message}")]
    Map {
        /// What was being read.
        what: String,
        /// wgpu's explanation.
        message: String,
    },
    /// The scopes of a [`Timer`](crate::Timer) were not closed or not resolved in order.
    #[error("GPU timer: {message}")]
    Timer {
        /// What was out of order.
        message: String,
    },
}

impl Error {
    /// The error of wgpu that `what` met.
    pub(crate) fn from_wgpu(what: &str, error: wgpu::Error) -> Self {
        let what = what.to_owned();
        match error {
            wgpu::Error::OutOfMemory { .. } => Self::OutOfMemory { what },
            wgpu::Error::Validation { description, .. } => Self::Validation { what, message: description },
            wgpu::Error::Internal { description, .. } => Self::Internal { what, message: description },
        }
    }

    /// An argument that does not fit.
    pub(crate) fn invalid(
        what: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Invalid { what: what.into(), found: found.into(), expected: expected.into() }
    }
}
