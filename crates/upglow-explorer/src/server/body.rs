//! Bodies of requests, within limits of size and time.

use std::time::Duration;

use axum::body::{Body, Bytes, HttpBody as _};
use axum::http::StatusCode;
use http_body_util::BodyExt as _;
use tokio::time::{Instant, timeout, timeout_at};

use super::answer::Refusal;

/// The greatest size of a body, and the time for it to arrive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limit {
    bytes: u64,
    time: Duration,
}

impl Limit {
    /// Requests in JSON.
    pub(super) const JSON: Self = Self { bytes: 64 << 10, time: Duration::from_secs(10) };
}

/// Of a body that is too large, this much is still read, so that the client gets to read the answer.
const MOST_DRAINED: u64 = 1 << 30;
/// A client that sends nothing for so long waits for the answer.
const SILENCE: Duration = Duration::from_millis(250);

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

/// The whole body as a value in JSON.
pub(super) async fn json<T: serde::de::DeserializeOwned>(body: Body) -> Result<T, Refusal> {
    serde_json::from_slice(&bytes(body, Limit::JSON).await?).map_err(Refusal::bad)
}
