//! Builds cubes, one at a time: a new one stops the one before.

use std::collections::{BTreeMap, VecDeque};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::Serialize;
use upglow_fit::{BuildError, Progress, Watch, build_cube};

use super::answer::Refusal;
use super::locked::locked;
use super::planner::Plan;
use super::shelf::{Held, Shelf};

/// Builds whose state can still be asked for.
const KNOWN: usize = 16;

/// What the page asks for.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Order {
    pub(super) options: BTreeMap<String, String>,
}

/// A build that was asked for; its number is also that of its cube.
#[derive(Debug)]
pub(super) struct Job {
    id: u32,
    plan: Plan,
    command: String,
    is_stopped: AtomicBool,
    status: Mutex<Status>,
}

#[derive(Clone, Debug)]
struct Status {
    state: State,
    started: Instant,
    ended: Option<Duration>,
    progress: Progress,
}

#[derive(Clone, Debug, PartialEq)]
enum State {
    Running,
    Done,
    Stopped,
    Failed(String),
}

/// What the page is told of a build.
#[derive(Debug, Serialize)]
pub(super) struct Told<'j> {
    id: u32,
    state: &'static str,
    /// Of the stage that `text` names, 0..=1.
    share: f64,
    text: &'static str,
    error: Option<String>,
    seconds: f64,
    /// The number of the cube once it is there.
    cube: Option<u32>,
    command: &'j str,
}

impl Job {
    fn status(&self) -> MutexGuard<'_, Status> {
        locked(&self.status)
    }

    pub(super) fn told(&self) -> Told<'_> {
        let Status { state, started, ended, progress } = self.status().clone();
        let Progress { stage, done, total } = progress;
        let is_done = state == State::Done;
        Told {
            id: self.id,
            state: match state {
                State::Running => "running",
                State::Done => "done",
                State::Stopped => "stopped",
                State::Failed(_) => "failed",
            },
            share: if is_done { 1.0 } else { done as f64 / total.max(1) as f64 },
            text: stage,
            error: if let State::Failed(error) = state { Some(error) } else { None },
            seconds: ended.unwrap_or_else(|| started.elapsed()).as_secs_f64(),
            cube: is_done.then_some(self.id),
            command: &self.command,
        }
    }

    pub(super) fn stop(&self) {
        self.is_stopped.store(true, Ordering::Relaxed);
    }

    fn end(&self, state: State) {
        let mut status = self.status();
        if status.state == State::Running {
            status.ended = Some(status.started.elapsed());
            status.state = state;
        }
    }

    fn carry_out(&self, shelf: &Shelf, pool: &rayon::ThreadPool) {
        self.status().started = Instant::now();
        let Plan { contract, model, options, resolution } = &self.plan;
        let built = pool.install(|| build_cube(contract, model, *options, *resolution, self));
        let built = built.map_err(|error| match error {
            BuildError::Stopped => State::Stopped,
            error => State::Failed(error.to_string()),
        });
        let held = built.and_then(|cube| {
            self.progress(Progress { stage: "preparing the page", done: 0, total: 1 });
            let name = format!("build {}", self.id);
            let held = pool.install(|| Held::new(self.id, cube, &name));
            held.map_err(|error| State::Failed(error.to_string()))
        });
        match held {
            Ok(_) if self.stopped() => self.end(State::Stopped),
            Ok(held) => {
                shelf.add(held);
                self.end(State::Done);
            }
            Err(state) => self.end(state),
        }
    }
}

impl Watch for Job {
    fn progress(&self, progress: Progress) {
        let mut status = self.status();
        // Threads report out of order.
        let is_later =
            status.progress.stage != progress.stage || progress.done > status.progress.done;
        if is_later {
            status.progress = progress;
        }
    }

    fn stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }
}

/// The builds so far, and the thread that carries them out.
#[derive(Debug, Default)]
pub(super) struct Builds {
    queue: Mutex<Queue>,
    woken: Condvar,
}

#[derive(Debug, Default)]
struct Queue {
    known: VecDeque<Arc<Job>>,
    waiting: Option<Arc<Job>>,
    last_id: u32,
    is_closed: bool,
}

impl Builds {
    /// Starts a build and stops the one before.
    pub(super) fn start(&self, plan: Plan, command: String) -> Arc<Job> {
        let mut queue = locked(&self.queue);
        queue.known.iter().for_each(|job| job.stop());
        if let Some(replaced) = queue.waiting.take() {
            replaced.end(State::Stopped);
        }
        queue.last_id += 1;
        let progress = Progress { stage: "starting", done: 0, total: 1 };
        let status =
            Status { state: State::Running, started: Instant::now(), ended: None, progress };
        let job = Arc::new(Job {
            id: queue.last_id,
            plan,
            command,
            is_stopped: AtomicBool::new(false),
            status: Mutex::new(status),
        });
        queue.known.push_back(job.clone());
        if queue.known.len() > KNOWN {
            queue.known.pop_front();
        }
        queue.waiting = Some(job.clone());
        self.woken.notify_all();
        job
    }

    pub(super) fn get(&self, id: u32) -> Result<Arc<Job>, Refusal> {
        let queue = locked(&self.queue);
        let found = queue.known.iter().find(|job| job.id == id);
        found.cloned().ok_or_else(|| Refusal::not_found("build"))
    }

    /// Carries out builds until the server ends.
    pub(super) fn carry_out(&self, shelf: &Shelf, pool: &rayon::ThreadPool) {
        while let Some(job) = self.next() {
            if job.stopped() {
                job.end(State::Stopped);
            } else {
                job.carry_out(shelf, pool);
            }
        }
    }

    /// Waits for the next build; `None` at the end.
    fn next(&self) -> Option<Arc<Job>> {
        let mut queue = locked(&self.queue);
        loop {
            if queue.is_closed {
                return None;
            }
            if let Some(job) = queue.waiting.take() {
                return Some(job);
            }
            queue = self.woken.wait(queue).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Stops the build and takes no more.
    pub(super) fn close(&self) {
        let mut queue = locked(&self.queue);
        queue.is_closed = true;
        queue.known.iter().for_each(|job| job.stop());
        self.woken.notify_all();
    }
}
