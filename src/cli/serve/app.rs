//! What is answered to which request.

use super::metrics::Metrics;
use super::model::{Served, Wishes};
use crate::error::{Error, Result};
use axum::Router;
use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, MatchedPath, Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::{get, post};
use serde_json::json;
use std::collections::HashMap;
use std::sync::{Arc, PoisonError, RwLock};
use std::time::{Duration, Instant};
use tokio::sync::Semaphore;
use tower_http::timeout::TimeoutLayer;

/// What a server allows.
pub struct Limits {
    /// The largest body, in bytes.
    pub body: usize,
    /// The longest a request may take.
    pub time: Duration,
    /// Requests in progress and waiting.
    pub queue: usize,
    /// Requests in progress.
    pub threads: usize,
}

/// What all requests share.
pub struct App {
    model: RwLock<Arc<Served>>,
    token: Option<String>,
    limits: Limits,
    /// Room for requests, in progress and waiting.
    queue: Arc<Semaphore>,
    /// Those in progress.
    working: Arc<Semaphore>,
    metrics: Metrics,
}

impl App {
    pub fn new(model: Served, token: Option<String>, limits: Limits) -> Self {
        App {
            model: RwLock::new(Arc::new(model)),
            token,
            queue: Arc::new(Semaphore::new(limits.queue)),
            working: Arc::new(Semaphore::new(limits.threads)),
            limits,
            metrics: Metrics::new(),
        }
    }

    /// The model as it is now.
    fn model(&self) -> Arc<Served> {
        self.model.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Reads the model file again; requests that have begun keep the model that they began with.
    pub async fn reload(&self) -> Result<()> {
        let model = self.model();
        let read = tokio::task::spawn_blocking(move || model.again()).await;
        let read = read.unwrap_or_else(|_| Err(Error::argument("model", "unreadable", "a model file")))?;
        *self.model.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(read);
        self.metrics.reloads.inc();
        Ok(())
    }

    /// Whether a request brings the token that is asked for; it takes as long whatever is wrong with it.
    fn admits(&self, headers: &HeaderMap) -> bool {
        let Some(token) = &self.token else { return true };
        let given = headers.get(header::AUTHORIZATION).and_then(|value| value.as_bytes().strip_prefix(b"Bearer "));
        let given = given.unwrap_or_default();
        let differing = given.iter().zip(token.as_bytes()).fold(0, |all, (a, b)| all | (a ^ b));
        differing == 0 && given.len() == token.len()
    }
}

/// Which function answers what.
pub fn routes(app: Arc<App>) -> Router {
    let (body, time) = (app.limits.body, app.limits.time);
    let guarded = Router::new()
        .route("/tag", post(tag))
        .route("/reload", post(reload))
        .route("/metrics", get(metrics))
        .route_layer(from_fn_with_state(app.clone(), admit));
    Router::new()
        .route("/", get(page))
        .route("/health", get(health))
        .merge(guarded)
        .fallback(async || refusal(StatusCode::NOT_FOUND, "there is /, /tag, /health, /metrics and /reload"))
        .layer(DefaultBodyLimit::max(body))
        .layer(TimeoutLayer::with_status_code(StatusCode::REQUEST_TIMEOUT, time))
        .layer(from_fn_with_state(app.clone(), count))
        .with_state(app)
}

/// Why a request is not answered.
fn refusal(status: StatusCode, why: impl ToString) -> Response {
    (status, axum::Json(json!({"error": why.to_string()}))).into_response()
}

/// Lets through who may come in.
async fn admit(State(app): State<Arc<App>>, request: axum::extract::Request, next: Next) -> Response {
    match app.admits(request.headers()) {
        true => next.run(request).await,
        false => refusal(StatusCode::UNAUTHORIZED, "bring the token: Authorization: Bearer TOKEN"),
    }
}

/// Counts what comes in and how it is answered.
async fn count(State(app): State<Arc<App>>, request: axum::extract::Request, next: Next) -> Response {
    let known = ["/", "/tag", "/health", "/metrics", "/reload"];
    let path = request.extensions().get::<MatchedPath>().map_or("", MatchedPath::as_str);
    let path = known.into_iter().find(|name| *name == path).unwrap_or("other");
    let start = Instant::now();
    let response = next.run(request).await;
    app.metrics.answered(path, response.status().as_u16(), start.elapsed().as_secs_f64());
    response
}

async fn page() -> Html<&'static str> {
    Html(include_str!("page.html"))
}

async fn health(State(app): State<Arc<App>>) -> Response {
    axum::Json(app.model().about.clone()).into_response()
}

async fn metrics(State(app): State<Arc<App>>) -> Response {
    let form = "application/openmetrics-text; version=1.0.0; charset=utf-8";
    ([(header::CONTENT_TYPE, form)], app.metrics.text()).into_response()
}

async fn reload(State(app): State<Arc<App>>) -> Response {
    match app.reload().await {
        Ok(()) => health(State(app)).await,
        Err(error) => refusal(StatusCode::INTERNAL_SERVER_ERROR, format!("{error}; the model stays as it was")),
    }
}

async fn tag(
    State(app): State<Arc<App>>,
    Query(query): Query<HashMap<String, String>>,
    headers: HeaderMap,
    body: Bytes,
) -> Response {
    if let Some(unknown) = query.keys().find(|key| !["confidence", "explain"].contains(&key.as_str())) {
        let why = format!("unknown parameter {unknown:?}: there are confidence and explain");
        return refusal(StatusCode::BAD_REQUEST, why);
    }
    let asked = |name| query.get(name).is_some_and(|value| value != "false");
    let wishes = Wishes { confidence: asked("confidence"), explain: asked("explain") };
    let form = headers.get(header::CONTENT_TYPE).and_then(|value| value.to_str().ok()).unwrap_or("text/plain");
    let json = form.split(';').next().is_some_and(|form| form.trim().eq_ignore_ascii_case("application/json"));
    let Ok(place) = app.queue.clone().try_acquire_owned() else {
        let full = refusal(StatusCode::SERVICE_UNAVAILABLE, "too many requests are waiting");
        return ([(header::RETRY_AFTER, "1")], full).into_response();
    };
    app.metrics.waiting.inc();
    let waiting = Waiting(app.clone());
    let Ok(work) = app.working.clone().acquire_owned().await else {
        return refusal(StatusCode::SERVICE_UNAVAILABLE, "the server is about to end");
    };
    let model = app.model();
    // Whoever hangs up or is timed out does not make room before the work is done.
    let done = tokio::task::spawn_blocking(move || {
        let answer = match json {
            true => model.json(&body, wishes).map(|(answer, tokens)| (tokens, axum::Json(answer).into_response())),
            false => model.text(body.to_vec(), wishes).map(plain),
        };
        drop((work, place, waiting));
        answer
    });
    match done.await {
        Ok(Ok((tokens, response))) => {
            app.metrics.tokens.inc_by(tokens as u64);
            response
        }
        Ok(Err(error)) => refusal(StatusCode::BAD_REQUEST, error),
        Err(_) => refusal(StatusCode::INTERNAL_SERVER_ERROR, "the model failed"),
    }
}

/// A request that is counted as waiting as long as this lives.
struct Waiting(Arc<App>);

impl Drop for Waiting {
    fn drop(&mut self) {
        self.0.metrics.waiting.dec();
    }
}

fn plain((text, tokens): (Vec<u8>, usize)) -> (usize, Response) {
    (tokens, ([(header::CONTENT_TYPE, "text/plain; charset=utf-8")], text).into_response())
}
