//! `rollin serve`

mod app;
mod metrics;
mod model;

use super::{Global, print};
use crate::error::{Error, Result};
use crate::read::input;
use app::{App, Limits};
use clap::Args;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use model::{Served, Wishes};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;

/// Serve a model over HTTP: POST /tag, GET /health, GET /metrics, POST /reload, and a page to try it at /.
///
/// POST /tag takes what `rollin tag` reads and answers what it writes, or, with content type application/json, {"sentences": [["the", "cat"]]} for one
/// column and {"sentences": [[["the", "DT"], ["cat", "NN"]]]} for more, answered by {"sentences": [{"labels": ["DT", "NN"]}]}; ?confidence, or
/// "confidence": true, tells how sure each label is, and ?explain, or "explain": true, why it was set. SIGHUP and POST /reload read the model file again; requests on the way are answered by the model
/// that was there when they came. SIGTERM and Ctrl-C answer what has come and end.
#[derive(Args)]
#[command(after_help = crate::cli::help::serve())]
pub struct Serve {
    /// The model file
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Where to listen; port 0 is any that is free, and what it is stands on standard output
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080")]
    listen: SocketAddr,
    /// A file with the token that requests must bring (Authorization: Bearer TOKEN); a must where others than this machine can reach the address
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
    /// The largest body of a request, in bytes; a larger one is answered by 413
    #[arg(long, value_name = "BYTES", default_value_t = 1 << 20)]
    body_limit: usize,
    /// Seconds a request may take once its head has come; then it is answered by 408
    #[arg(long, value_name = "SECONDS", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=3600))]
    time_limit: u64,
    /// Seconds a connection may be silent or take to send a request's head; then it is closed
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..=3600))]
    idle_limit: u64,
    /// Requests that may be in progress or wait; one more is answered by 503
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    queue: u32,
    /// Connections that may be open; others wait until one is closed
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    connections: u32,
}

/// How long after the end was asked for those who were at the door by then are let in and heard. A connection of which nothing was read is closed when the
/// others are told to finish, even if its request has come.
const MOMENT: Duration = Duration::from_millis(100);
/// How long requests in progress may take after that.
const FAREWELL: Duration = Duration::from_secs(30);

impl Serve {
    pub fn run(&self, global: &Global) -> Result<()> {
        global.refuse_json("what is served is JSON already")?;
        let token = self.token_file.as_deref().map(token).transpose()?;
        if token.is_none() && !self.listen.ip().is_loopback() {
            let expected = "a loopback address, or come with a --token-file: others can reach it";
            return Err(Error::argument("--listen", self.listen, expected));
        }
        let model = Served::load(&self.model, global.seed)?;
        let threads = rayon::current_num_threads();
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(threads)
            .enable_all()
            .build()
            .map_err(|error| Error::io("start", "the server", error))?;
        let limits = Limits {
            body: self.body_limit,
            time: Duration::from_secs(self.time_limit),
            queue: self.queue as usize,
            threads,
        };
        runtime.block_on(self.serve(App::new(model, token, limits)))
    }

    /// Answers until the end is asked for, and then what has come.
    async fn serve(&self, app: App) -> Result<()> {
        let refused = |error| Error::io("listen on", self.listen.to_string(), error);
        let app = Arc::new(app);
        // Whoever knows the address may send a signal at once.
        let unheard = |error| Error::io("listen for", "signals", error);
        let end = asked_to_end().map_err(unheard)?;
        tokio::spawn(reload_on_hangup(app.clone()).map_err(unheard)?);
        let mut end = std::pin::pin!(async {
            end.await;
            tokio::time::sleep(MOMENT).await;
        });
        let listener = TcpListener::bind(self.listen).await.map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        print(&format!("listening on http://{address}\n"))?;
        let seats = Arc::new(Semaphore::new(self.connections as usize));
        let graceful = GracefulShutdown::new();
        let welcome = |stream: TcpStream, seat| {
            let connection = graceful.watch(self.connection(stream, app.clone()));
            tokio::spawn(async move {
                // Whoever hangs up is not our error.
                let _ = connection.await;
                drop(seat);
            });
        };
        loop {
            let accepted = async {
                let seat = seats.clone().acquire_owned().await;
                (listener.accept().await, seat)
            };
            tokio::select! {
                () = &mut end => break,
                (stream, seat) = accepted => match stream {
                    Ok((stream, _)) => welcome(stream, seat),
                    // Too many open files, or a client that is gone already: there will be others.
                    Err(_) => tokio::time::sleep(Duration::from_millis(10)).await,
                },
            }
        }
        drop(listener);
        // What is still unanswered then will not be.
        let _ = tokio::time::timeout(FAREWELL, graceful.shutdown()).await;
        Ok(())
    }

    /// What answers the requests of one connection.
    fn connection(
        &self,
        stream: TcpStream,
        app: Arc<App>,
    ) -> impl hyper_util::server::graceful::GracefulConnection + use<> {
        let _ = stream.set_nodelay(true);
        let service = TowerToHyperService::new(app::routes(app));
        hyper::server::conn::http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(Duration::from_secs(self.idle_limit))
            .serve_connection(TokioIo::new(stream), service)
    }
}

/// The token in a file.
fn token(path: &std::path::Path) -> Result<String> {
    let text = String::from_utf8_lossy(&input::raw(path)?).trim().to_owned();
    let fit = text.len() >= 16 && text.bytes().all(|byte| byte.is_ascii_graphic());
    if fit {
        Ok(text)
    } else {
        Err(Error::file(path, "no token", "write one of at least 16 printable ASCII characters into it"))
    }
}

/// Done when SIGTERM or SIGINT comes, which are heard from the call on; where there is no SIGTERM, when Ctrl-C comes.
fn asked_to_end() -> std::io::Result<impl Future<Output = ()>> {
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        let (mut terminate, mut interrupt) = (signal(SignalKind::terminate())?, signal(SignalKind::interrupt())?);
        Ok(async move {
            tokio::select! {
                _ = terminate.recv() => {}
                _ = interrupt.recv() => {}
            }
        })
    }
    #[cfg(not(unix))]
    Ok(async {
        let _ = tokio::signal::ctrl_c().await;
    })
}

/// Reads the model file again whenever SIGHUP comes, which is heard from the call on; what is wrong with it is said on standard error, and the model stays.
fn reload_on_hangup(app: Arc<App>) -> std::io::Result<impl Future<Output = ()>> {
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        let mut hangup = signal(SignalKind::hangup())?;
        Ok(async move {
            while hangup.recv().await.is_some() {
                if let Err(error) = app.reload().await {
                    eprintln!("error: {error}; the model stays as it was");
                }
            }
        })
    }
    #[cfg(not(unix))]
    Ok(async move { drop(app) })
}

/// What answers the body of a request, without a network: for the fuzz target of bodies.
#[doc(hidden)]
pub struct Answerer(Served);

impl Answerer {
    /// With the model in this file.
    ///
    /// # Errors
    /// When it is none.
    pub fn load(path: &std::path::Path) -> Result<Self> {
        Served::load(path, 1).map(Answerer)
    }

    /// What this body is answered by.
    ///
    /// # Errors
    /// When it is refused.
    pub fn answer(&self, body: &[u8], json: bool, confidence: bool, explain: bool) -> Result<Vec<u8>> {
        let wishes = Wishes { confidence, explain };
        match json {
            true => Ok(serde_json::to_vec(&self.0.json(body, wishes)?.0).unwrap_or_default()),
            false => Ok(self.0.text(body.to_vec(), wishes)?.0),
        }
    }
}
