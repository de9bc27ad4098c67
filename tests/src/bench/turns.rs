//! Subjects that take turns.

use super::statistics::{Times, times};
use crate::{
    Context,
    technique::{Failure, Frame, Running, Subject, Throughput, WorkDone},
};
use compositor::wgpu;
use image_error::Image;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Rounds before times count, and the fewest and most that do.
const WARM_UP: usize = 3;
const LEAST_ROUNDS: usize = 5;
const MOST_ROUNDS: usize = 60;
/// Rounds go on until the counted ones took so long.
const ROUNDS_FOR: Duration = Duration::from_secs(12);
const QUICK_ROUNDS_FOR: Duration = Duration::from_secs(2);
/// How often precomputation is repeated, after one for warm-up.
const PREPARES: usize = 5;

/// Which clock a benchmark's times are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Clock {
    /// The adapter's own, over the method's own passes. Not of a software adapter: it takes the time
    /// when it records or bins work as often as when it does it, and reports microseconds for
    /// milliseconds of work.
    Adapter,
    /// The host's, from recording to completion.
    Wall,
}

/// What was measured of a subject.
#[derive(Debug, Default)]
pub(super) struct Timed {
    /// The times that count, by `clock`.
    pub(super) time_ms: Option<Times>,
    pub(super) clock: Option<Clock>,
    pub(super) wall_ms: Option<Times>,
    pub(super) adapter_ms: Option<Times>,
    pub(super) prepare_ms: Option<f64>,
    pub(super) memory_bytes: Option<u64>,
    pub(super) picture: Option<Image>,
    pub(super) work: WorkDone,
    pub(super) throughput: Option<Throughput>,
}

/// Starts all subjects and times them in turns. One that fails fails the benchmark: ratios of what
/// did not run together mean nothing.
pub(super) fn take_turns(context: &mut Context, subjects: &[&Subject]) -> Result<Vec<Timed>, Failure> {
    let named =
        |subject: &Subject, error: Failure| -> Failure { format!("{}: {error}", subject.method).into() };
    let mut running = Vec::new();
    for subject in subjects {
        context.status(&format!("starting {}", subject.method));
        running.push((subject.start)(context).map_err(|error| named(subject, error))?);
    }
    let mut timed: Vec<Timed> = subjects.iter().map(|_| Timed::default()).collect();
    prepare(context, subjects, &mut running, &mut timed)?;
    let rounds = frames(context, subjects, &mut running)?;
    let all_have = rounds.iter().flatten().all(|frame| frame.gpu_ms.is_some());
    let is_software = context.gpu().adapter_info().device_type == wgpu::DeviceType::Cpu;
    let clock = if all_have && !is_software { Clock::Adapter } else { Clock::Wall };
    for (index, timed) in timed.iter_mut().enumerate() {
        let own = || rounds.iter().filter_map(|round| round.get(index));
        timed.wall_ms = times(&own().map(|frame| frame.wall_ms).collect::<Vec<_>>());
        timed.adapter_ms = times(&own().filter_map(|frame| frame.gpu_ms).collect::<Vec<_>>());
        timed.time_ms = if clock == Clock::Adapter { timed.adapter_ms } else { timed.wall_ms };
        timed.clock = Some(clock);
        timed.work = own().next_back().map(|frame| frame.work.clone()).unwrap_or_default();
        let Running { picture, memory_bytes, throughput, .. } = &mut running[index];
        timed.throughput = *throughput;
        let subject = subjects[index];
        if let Some(memory_bytes) = memory_bytes {
            timed.memory_bytes = Some(memory_bytes(context).map_err(|error| named(subject, error))?);
        }
        if let Some(picture) = picture {
            timed.picture = Some(picture(context).map_err(|error| named(subject, error))?);
        }
    }
    Ok(timed)
}

/// Times what is precomputed, in turns.
fn prepare(
    context: &mut Context,
    subjects: &[&Subject],
    running: &mut [Running],
    timed: &mut [Timed],
) -> Result<(), Failure> {
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); running.len()];
    for round in 0..=PREPARES {
        for (index, one) in running.iter_mut().enumerate() {
            let Some(prepare) = &mut one.prepare else { continue };
            if context.is_stopped() {
                return Err("stopped".into());
            }
            context.status(&format!("preparing {}", subjects[index].method));
            let started = Instant::now();
            prepare(context).map_err(|error| format!("{}: preparing: {error}", subjects[index].method))?;
            if round > 0 {
                values[index].push(1e3 * started.elapsed().as_secs_f64());
            }
        }
    }
    for (timed, values) in timed.iter_mut().zip(values) {
        timed.prepare_ms = times(&values).map(|times| times.median);
    }
    Ok(())
}

/// One subject's frame in one round.
struct Timing {
    wall_ms: f64,
    gpu_ms: Option<f64>,
    work: WorkDone,
}

/// Rounds of one frame of each subject, after warm-up.
fn frames(
    context: &mut Context,
    subjects: &[&Subject],
    running: &mut [Running],
) -> Result<Vec<Vec<Timing>>, Failure> {
    let enough = if context.scope().quick { QUICK_ROUNDS_FOR } else { ROUNDS_FOR };
    let mut rounds: Vec<Vec<Timing>> = Vec::new();
    let mut counted = Duration::ZERO;
    for round in 0.. {
        let begun = Instant::now();
        let mut timings: Vec<(usize, Timing)> = Vec::new();
        for place in 0..running.len() {
            if context.is_stopped() {
                return Err("stopped".into());
            }
            // Another one begins each round, so that none always follows the same other.
            let index = (place + round) % running.len();
            context.status(&format!("round {round}, {}", subjects[index].method));
            let started = Instant::now();
            let Frame { gpu_ms, work } = (running[index].frame)(context)
                .map_err(|error| format!("{}: {error}", subjects[index].method))?;
            timings.push((index, Timing { wall_ms: 1e3 * started.elapsed().as_secs_f64(), gpu_ms, work }));
        }
        if round < WARM_UP {
            continue;
        }
        timings.sort_by_key(|(index, _)| *index);
        rounds.push(timings.into_iter().map(|(_, timing)| timing).collect());
        counted += begun.elapsed();
        if rounds.len() >= MOST_ROUNDS || (counted >= enough && rounds.len() >= LEAST_ROUNDS) {
            break;
        }
    }
    Ok(rounds)
}
