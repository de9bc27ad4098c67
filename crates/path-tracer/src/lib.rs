//! The reference image of a scene: a CPU path tracer on obvhs, with the variance of each pixel.
