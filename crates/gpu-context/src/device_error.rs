//! Errors that no call waited for: wgpu's uncaptured errors and the loss of the device.

use std::sync::{Arc, Mutex, PoisonError};

/// Errors kept until they are taken. The first ones are the causes; what follows is only counted.
const KEPT: usize = 32;

/// An error that arrived outside of any call's result.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DeviceError {
    /// wgpu refused a call outside of an error scope.
    #[error("refused by validation: {0}")]
    Validation(String),
    /// The GPU ran out of memory outside of an error scope.
    #[error("the GPU is out of memory")]
    OutOfMemory,
    /// The driver failed for a reason of its own.
    #[error("the graphics driver failed: {0}")]
    Internal(String),
    /// The device is gone; everything made with it is invalid.
    #[error("the graphics device was lost: {0}")]
    Lost(String),
    /// So many further errors followed, of which no text was kept.
    #[error("{0} further errors")]
    Further(u64),
}

/// What a device reported since its owner last asked.
#[derive(Debug, Default)]
struct State {
    errors: Vec<DeviceError>,
    further: u64,
    lost: Option<String>,
}

/// The list that a device's handlers write and its owner reads.
#[derive(Clone, Debug, Default)]
pub(crate) struct ErrorList(Arc<Mutex<State>>);

impl ErrorList {
    /// Makes this list the receiver of a device's uncaptured errors and of its loss.
    pub(crate) fn attach(&self, device: &wgpu::Device) {
        let errors = self.clone();
        device.on_uncaptured_error(Arc::new(move |error| errors.push(error.into())));
        let errors = self.clone();
        device.set_device_lost_callback(move |reason, message| {
            // wgpu leaves the text empty for some causes.
            let message = if message.is_empty() { format!("{reason:?}") } else { message };
            errors.lose(message);
        });
    }

    /// Everything since the last call, in order of arrival.
    pub(crate) fn take(&self) -> Vec<DeviceError> {
        self.with(|state| {
            let mut errors = std::mem::take(&mut state.errors);
            let further = std::mem::take(&mut state.further);
            if further > 0 {
                errors.push(DeviceError::Further(further));
            }
            errors
        })
    }

    /// Why the device was lost, if it was. Taking the errors does not clear it.
    pub(crate) fn lost(&self) -> Option<String> {
        self.with(|state| state.lost.clone())
    }

    fn push(&self, error: DeviceError) {
        self.with(|state| {
            if state.errors.len() < KEPT {
                state.errors.push(error);
            } else {
                state.further = state.further.saturating_add(1);
            }
        });
    }

    /// Records the loss of the device; a device is lost once.
    pub(crate) fn lose(&self, message: String) {
        let first = self.with(|state| {
            let first = state.lost.is_none();
            state.lost.get_or_insert_with(|| message.clone());
            first
        });
        if first {
            self.push(DeviceError::Lost(message));
        }
    }

    /// A panic elsewhere while the lock was held leaves the list usable.
    fn with<T>(&self, f: impl FnOnce(&mut State) -> T) -> T {
        f(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl From<wgpu::Error> for DeviceError {
    fn from(error: wgpu::Error) -> Self {
        match error {
            wgpu::Error::OutOfMemory { .. } => Self::OutOfMemory,
            wgpu::Error::Validation { description, .. } => Self::Validation(description),
            wgpu::Error::Internal { description, .. } => Self::Internal(description),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_bounded_and_counts_the_rest() {
        let list = ErrorList::default();
        for index in 0..KEPT + 5 {
            list.push(DeviceError::Internal(index.to_string()));
        }
        let errors = list.take();
        assert_eq!(errors.len(), KEPT + 1);
        assert_eq!(errors.first(), Some(&DeviceError::Internal("0".into())));
        assert_eq!(errors.last(), Some(&DeviceError::Further(5)));
        assert!(list.take().is_empty());
    }

    #[test]
    fn loss_is_reported_once_and_remembered() {
        let list = ErrorList::default();
        list.lose("first".into());
        list.lose("second".into());
        assert_eq!(list.take(), [DeviceError::Lost("first".into())]);
        assert_eq!(list.lost(), Some("first".into()));
    }
}
