//! A server for one page on this machine.
//!
//! It listens on 127.0.0.1 only, and carries out requests only of the page that it gave out (`guard`).
//! Requests name cubes and dropped files by number: no path comes from the page. One thread answers;
//! fits, builds and the reading of files have threads of their own.

mod answer;
mod body;
mod builds;
mod choices;
mod drop_routes;
mod drops;
mod explain;
mod folder;
mod guard;
mod locked;
mod planner;
mod policy;
mod shelf;
mod spectral;

use std::io;
use std::net::{Ipv4Addr, TcpListener};
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{Path, State};
use axum::middleware;
use axum::response::Response;
use axum::routing::{get, post};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use serde_json::json;
use tokio::net::TcpStream;
use tokio::runtime::Runtime;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;
use upglow::Cube;

use self::answer::{Refusal, binary, of_type, work};
use self::builds::{Builds, Job, Order};
use self::drops::Drops;
use self::explain::Question;
use self::folder::PrivateFolder;
use self::guard::{Guard, guarded};
use self::shelf::{Held, Shelf};
use crate::cube_data::ExplorerError;
use crate::page::served_page;

pub use self::planner::{BuildOption, Plan, PlanOf, Planner};

/// Connections at once; others wait for one of them to end.
const MOST_CONNECTIONS: usize = 64;
/// Threads for fits and files; more requests wait for one of them.
const MOST_WORKERS: usize = 16;
/// The time for the head of a request, and for which a connection without requests is kept.
const HEAD_TIME: Duration = Duration::from_secs(15);
/// Room for the head of a request, bytes.
const HEAD_BYTES: usize = 16 << 10;
/// Pixels of a dropped picture: more takes a minute to read.
const MOST_PIXELS: usize = 1 << 28;
/// How often the server looks whether it must end.
const STOP_TIME: Duration = Duration::from_millis(100);
/// The time for work that is left when the server ends.
const END_TIME: Duration = Duration::from_secs(2);

/// Why there is no server.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServerError {
    /// The port is in use or not allowed.
    #[error("port {port} of this machine, expected a free one; 0 takes any")]
    Port {
        /// The port.
        port: u16,
        /// The system's error.
        source: io::Error,
    },
    /// The cube cannot be shown.
    #[error(transparent)]
    Cube(#[from] ExplorerError),
    /// The system has no random numbers.
    #[error("no random numbers for the address")]
    Random(#[from] getrandom::Error),
    /// The system gives no folder for dropped files, or no threads.
    #[error("the server cannot start")]
    System(#[from] io::Error),
    /// The system gives no threads.
    #[error("the server cannot start")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// A server that is ready to answer.
#[derive(Debug)]
pub struct Server {
    address: String,
    router: Router,
    shared: Arc<Shared>,
    listener: tokio::net::TcpListener,
    pool: rayon::ThreadPool,
    /// Where dropped files are; removed at the end.
    folder: PrivateFolder,
    // Last, because what it runs uses the others.
    runtime: Runtime,
}

/// What requests use.
#[derive(Debug)]
struct Shared {
    page: Bytes,
    shelf: Shelf,
    builds: Builds,
    planner: Planner,
    drops: Drops,
    /// Who has it may receive and read a picture.
    files: Arc<Semaphore>,
}

type Answer = Result<Response, Refusal>;

impl Server {
    /// A server for a cube, on a port of this machine or on any free one if it is 0.
    ///
    /// # Errors
    ///
    /// [`ServerError`] if the cube cannot be shown or the system refuses the port, a folder or threads.
    pub fn new(cube: Cube, name: &str, planner: Planner, port: u16) -> Result<Self, ServerError> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))
            .map_err(|source| ServerError::Port { port, source })?;
        let port = listener.local_addr()?.port();
        listener.set_nonblocking(true)?;
        let page = served_page();
        let guard = Guard::new(port, policy::policy(&page))?;
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .max_blocking_threads(MOST_WORKERS)
            .build()?;
        let listener = {
            let _context = runtime.enter();
            tokio::net::TcpListener::from_std(listener)?
        };
        let folder = PrivateFolder::new()?;
        let shared = Arc::new(Shared {
            page: page.into(),
            shelf: Shelf::new(Held::new(0, cube, name)?),
            builds: Builds::default(),
            planner,
            drops: Drops::new(folder.path()),
            files: Arc::new(Semaphore::new(1)),
        });
        let threads = rayon::current_num_threads();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let address = format!("http://127.0.0.1:{port}{}", guard.path());
        let router = router(guard, shared.clone());
        Ok(Self { address, router, shared, listener, pool, folder, runtime })
    }

    /// Where the page is.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Answers requests until `is_stopped`, which is asked ten times a second.
    ///
    /// # Errors
    ///
    /// The system's error if dropped files cannot be removed.
    pub fn run(self, is_stopped: impl Fn() -> bool) -> io::Result<()> {
        let Self { router, shared, listener, pool, folder, runtime, .. } = self;
        std::thread::scope(|scope| {
            scope.spawn(|| shared.builds.carry_out(&shared.shelf, &pool));
            runtime.block_on(accept(&listener, &router, is_stopped));
            shared.builds.close();
        });
        runtime.shutdown_timeout(END_TIME);
        folder.close()
    }
}

async fn accept(
    listener: &tokio::net::TcpListener,
    router: &Router,
    is_stopped: impl Fn() -> bool,
) {
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    let next = async || {
        let place = places.clone().acquire_owned().await.ok()?;
        Some((listener.accept().await, place))
    };
    while !is_stopped() {
        match timeout(STOP_TIME, next()).await {
            Ok(Some((Ok((stream, _)), place))) => {
                tokio::spawn(answer_all(stream, place, router.clone()));
            }
            // Too many open files, for example: it passes as connections end.
            Ok(Some((Err(_), _))) => tokio::time::sleep(STOP_TIME).await,
            Ok(None) | Err(_) => {}
        }
    }
}

/// Answers the requests of one connection.
async fn answer_all(stream: TcpStream, _place: OwnedSemaphorePermit, router: Router) {
    let service = TowerToHyperService::new(router);
    // A connection that breaks concerns nobody else.
    let _ = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_TIME)
        .max_buf_size(HEAD_BYTES)
        .serve_connection(TokioIo::new(stream), service)
        .await;
}

/// Every request that is carried out.
fn router(guard: Guard, shared: Arc<Shared>) -> Router {
    Router::new()
        .route("/{token}/", get(page))
        .route("/{token}/cube/{item}", get(cube_file))
        .route("/{token}/choices", get(choices))
        .route("/{token}/color", post(color))
        .route("/{token}/build", post(build))
        .route("/{token}/build/{item}", get(build_state))
        .route("/{token}/build/{item}/stop", post(build_stop))
        .merge(drop_routes::routes())
        .fallback(async || Refusal::not_found("page"))
        .with_state(shared)
        .layer(middleware::from_fn_with_state(Arc::new(guard), guarded))
}

async fn page(State(shared): State<Arc<Shared>>) -> Response {
    of_type("text/html; charset=utf-8", shared.page.clone())
}

/// A number and the ending after it.
fn numbered(item: &str) -> Result<(u32, &str), Refusal> {
    let (id, ending) = item.split_once('.').unwrap_or((item, ""));
    let id = id.parse().map_err(|_| Refusal::not_found("file"))?;
    Ok((id, ending))
}

async fn cube_file(
    State(shared): State<Arc<Shared>>,
    Path((_, item)): Path<(String, String)>,
) -> Answer {
    let (id, ending) = numbered(&item)?;
    let held = shared.shelf.get(id)?;
    match ending {
        "data" => Ok(binary(held.arrays.clone())),
        "js" => Ok(of_type("text/javascript; charset=utf-8", held.script.clone())),
        "wgsl" => Ok(of_type("text/plain; charset=utf-8", held.shader.clone())),
        "borders" => Ok(binary(work(move || held.borders()).await?)),
        _ => Err(Refusal::not_found("file")),
    }
}

/// Refuses a picture that takes too long to read.
fn check_size(name: &str, [width, height]: [usize; 2]) -> Result<(), Refusal> {
    if width.saturating_mul(height) <= MOST_PIXELS {
        return Ok(());
    }
    let error = format!("{name}: {width} × {height} pixels, expected at most {MOST_PIXELS}");
    Err(Refusal::unusable(error))
}

async fn choices(State(shared): State<Arc<Shared>>) -> Answer {
    let mut choices = choices::built_in();
    let cubes = shared.shelf.all();
    let cubes = cubes.iter().map(|held| json!({ "id": held.id, "name": held.name }));
    choices["cubes"] = cubes.collect();
    choices["dropped_lights"] = json!(shared.drops.lights());
    choices["options"] = json!(shared.planner.options);
    choices["resolution"] = json!(planner::RESOLUTIONS);
    Ok(answer::json(&choices))
}

async fn color(State(shared): State<Arc<Shared>>, body: Body) -> Answer {
    let question: Question = body::json(body).await?;
    let held = shared.shelf.get(question.cube)?;
    work(move || {
        let explanation = held.explainer()?.explain(&held.cube, &question)?;
        Ok(answer::json(&explanation))
    })
    .await
}

async fn build(State(shared): State<Arc<Shared>>, body: Body) -> Answer {
    let Order { options } = body::json(body).await?;
    let job = work(move || {
        let (plan, command) = shared.planner.checked(&options, &shared.drops)?;
        Ok(shared.builds.start(plan, command))
    });
    Ok(answer::json(&job.await?.told()))
}

async fn build_state(
    State(shared): State<Arc<Shared>>,
    Path((_, item)): Path<(String, String)>,
) -> Answer {
    Ok(answer::json(&job(&shared, &item)?.told()))
}

async fn build_stop(
    State(shared): State<Arc<Shared>>,
    Path((_, item)): Path<(String, String)>,
) -> Answer {
    let job = job(&shared, &item)?;
    job.stop();
    Ok(answer::json(&job.told()))
}

fn job(shared: &Shared, item: &str) -> Result<Arc<Job>, Refusal> {
    match numbered(item)? {
        (id, "") => shared.builds.get(id),
        _ => Err(Refusal::not_found("build")),
    }
}
