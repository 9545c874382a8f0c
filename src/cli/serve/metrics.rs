//! What is counted while serving, in Prometheus' text form.

use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::registry::{Registry, Unit};

/// What tells requests apart.
#[derive(Clone, Debug, PartialEq, Eq, Hash, EncodeLabelSet)]
struct Kind {
    path: &'static str,
    status: u16,
}

/// All counts.
pub struct Metrics {
    registry: Registry,
    requests: Family<Kind, Counter>,
    seconds: Histogram,
    /// Tokens labelled.
    pub tokens: Counter,
    /// Requests to label that are in progress or wait.
    pub waiting: Gauge,
    /// Times that the model was read again.
    pub reloads: Counter,
}

/// Upper ends of the histogram's buckets, in seconds.
const ENDS: [f64; 12] = [0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 5.0];

impl Metrics {
    pub fn new() -> Self {
        let mut registry = Registry::with_prefix("rollin");
        let (requests, seconds) = (Family::default(), Histogram::new(ENDS));
        let (tokens, waiting, reloads) = (Counter::default(), Gauge::default(), Counter::default());
        registry.register("requests", "Requests answered", Family::clone(&requests));
        registry.register_with_unit("request", "Time to answer", Unit::Seconds, seconds.clone());
        registry.register("tokens", "Tokens labelled", Counter::clone(&tokens));
        registry.register("waiting", "Requests to label that are in progress or wait", Gauge::clone(&waiting));
        registry.register("reloads", "Times that the model was read again", Counter::clone(&reloads));
        Metrics { registry, requests, seconds, tokens, waiting, reloads }
    }

    /// Counts a request for `path` that took so many seconds.
    pub fn answered(&self, path: &'static str, status: u16, seconds: f64) {
        self.requests.get_or_create(&Kind { path, status }).inc();
        self.seconds.observe(seconds);
    }

    /// All of it as text.
    pub fn text(&self) -> String {
        let mut text = String::new();
        // A string takes everything.
        let _ = encode(&mut text, &self.registry);
        text
    }
}
