//! Subjects that take turns.

use super::statistics::{Times, times};
use crate::{
    Context,
    technique::{Failure, Frame, Running, Subject, Throughput, WorkDone},
};
use image_error::Image;
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

/// What was measured of a subject.
#[derive(Debug, Default)]
pub(super) struct Timed {
    pub(super) time_ms: Option<Times>,
    pub(super) clock: &'static str,
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
    let has_clock = rounds.iter().flatten().all(|frame| frame.gpu_ms.is_some());
    for (index, timed) in timed.iter_mut().enumerate() {
        let own = || rounds.iter().filter_map(|round| round.get(index));
        let values: Vec<f64> =
            own().map(|frame| frame.gpu_ms.filter(|_| has_clock).unwrap_or(frame.wall_ms)).collect();
        timed.time_ms = times(&values);
        timed.clock = if has_clock { "adapter" } else { "wall" };
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
