//! Bodies of requests, within limits of size and time.

use std::path::PathBuf;
use std::time::Duration;

use axum::body::{Body, Bytes, HttpBody as _};
use axum::http::StatusCode;
use http_body_util::BodyExt as _;
use tokio::sync::mpsc;
use tokio::time::{Instant, timeout, timeout_at};

use super::answer::{Refusal, work};

/// The greatest size of a body, and the time for it to arrive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limit {
    bytes: u64,
    time: Duration,
}

impl Limit {
    /// Requests in JSON.
    pub(super) const JSON: Self = Self { bytes: 64 << 10, time: Duration::from_secs(10) };
    /// Tables in CSV.
    pub(super) const TABLE: Self = Self { bytes: 1 << 20, time: Duration::from_secs(10) };
    /// Pictures.
    pub(super) const PICTURE: Self = Self { bytes: 256 << 20, time: Duration::from_secs(120) };
}

/// Of a body that is too large, this much is still read, so that the client gets to read the answer.
const MOST_DRAINED: u64 = 1 << 30;
/// A client that sends nothing for so long waits for the answer.
const SILENCE: Duration = Duration::from_millis(250);
/// Parts of a body that wait to be written.
const WAITING_PARTS: usize = 4;

/// A body that is being read.
struct Reading {
    body: Body,
    limit: Limit,
    deadline: Instant,
    read: u64,
}

impl Reading {
    async fn start(body: Body, limit: Limit) -> Result<Self, Refusal> {
        let stated = body.size_hint().lower();
        let mut reading = Self { body, limit, deadline: Instant::now() + limit.time, read: 0 };
        if stated > limit.bytes {
            return Err(reading.too_large().await);
        }
        Ok(reading)
    }

    /// The next part; `None` at the end.
    async fn next(&mut self) -> Result<Option<Bytes>, Refusal> {
        loop {
            let frame = timeout_at(self.deadline, self.body.frame()).await.map_err(|_| {
                let most = self.limit.time.as_secs();
                let error = format!("a body that takes longer than {most} s");
                Refusal::new(StatusCode::REQUEST_TIMEOUT, error)
            })?;
            let Some(frame) = frame else { return Ok(None) };
            let frame = frame.map_err(|_| Refusal::bad("a damaged body"))?;
            // Other frames are trailers, which nothing here needs.
            let Ok(data) = frame.into_data() else { continue };
            self.read += data.len() as u64;
            if self.read > self.limit.bytes {
                return Err(self.too_large().await);
            }
            return Ok(Some(data));
        }
    }

    async fn too_large(&mut self) -> Refusal {
        let mut drained = 0;
        while drained < MOST_DRAINED && Instant::now() < self.deadline {
            match timeout(SILENCE, self.body.frame()).await {
                Ok(Some(Ok(frame))) => drained += frame.data_ref().map_or(0, |d| d.len() as u64),
                _ => break,
            }
        }
        let most = self.limit.bytes;
        Refusal::new(StatusCode::PAYLOAD_TOO_LARGE, format!("a body of more than {most} bytes"))
    }
}

/// The whole body.
pub(super) async fn bytes(body: Body, limit: Limit) -> Result<Vec<u8>, Refusal> {
    let mut reading = Reading::start(body, limit).await?;
    let mut all = Vec::new();
    while let Some(part) = reading.next().await? {
        all.extend_from_slice(&part);
    }
    Ok(all)
}

/// The whole body as text.
pub(super) async fn text(body: Body, limit: Limit) -> Result<String, Refusal> {
    String::from_utf8(bytes(body, limit).await?)
        .map_err(|_| Refusal::bad("bytes that are no text, expected UTF-8"))
}

/// The whole body as a value in JSON.
pub(super) async fn json<T: serde::de::DeserializeOwned>(body: Body) -> Result<T, Refusal> {
    serde_json::from_slice(&bytes(body, Limit::JSON).await?).map_err(Refusal::bad)
}

/// Writes the whole body to a new file.
pub(super) async fn file(body: Body, limit: Limit, path: PathBuf) -> Result<(), Refusal> {
    let mut reading = Reading::start(body, limit).await?;
    let (sender, mut parts) = mpsc::channel::<Bytes>(WAITING_PARTS);
    let failed = |error: std::io::Error| {
        Refusal::new(StatusCode::INSUFFICIENT_STORAGE, format!("the file is not kept: {error}"))
    };
    let written = tokio::spawn(work(move || {
        use std::io::Write as _;
        let mut file = std::fs::File::create_new(path).map_err(failed)?;
        while let Some(part) = parts.blocking_recv() {
            file.write_all(&part).map_err(failed)?;
        }
        file.flush().map_err(failed)
    }));
    let read = loop {
        let part = match reading.next().await {
            Ok(Some(part)) => part,
            Ok(None) => break Ok(()),
            Err(refusal) => break Err(refusal),
        };
        if sender.send(part).await.is_err() {
            // The writer has failed, and says why.
            break Ok(());
        }
    };
    drop(sender);
    let written = written.await.map_err(|_| Refusal::bad("the file is not kept"))?;
    read.and(written)
}
