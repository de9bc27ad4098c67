//! A technique's account of what it did in one frame.

use std::fmt;

/// What one call of a technique's `prepare` did, or why it did nothing.
///
/// A technique that has nothing to do records no pass and says so in `skipped`; it never
/// returns in silence. `passes` may be above 0 beside a skip where a part was left out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Render and compute passes recorded.
    pub passes: u32,
    /// Why work was left out, `None` where everything ran.
    pub skipped: Option<Skip>,
}

impl Work {
    /// Everything ran, in so many passes.
    pub const fn done(passes: u32) -> Self {
        Self { passes, skipped: None }
    }

    /// Nothing ran, for this reason.
    pub const fn skipped(skip: Skip) -> Self {
        Self { passes: 0, skipped: Some(skip) }
    }
}

/// A reason for leaving work out. Each technique defines its own as constants:
///
/// ```
/// use gpu_context::{Skip, Work};
///
/// /// The scene has no light strong enough to glare.
/// pub const NO_STRONG_LIGHT: Skip = Skip::new("no light is strong enough to glare");
///
/// let work = Work::skipped(NO_STRONG_LIGHT);
/// assert_eq!(work.skipped, Some(NO_STRONG_LIGHT));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skip {
    reason: &'static str,
}

impl Skip {
    /// A skip for a reason that reads well after "skipped: ".
    pub const fn new(reason: &'static str) -> Self {
        Self { reason }
    }

    /// The reason, as it was given.
    pub const fn reason(self) -> &'static str {
        self.reason
    }
}

impl fmt::Display for Skip {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.reason)
    }
}
