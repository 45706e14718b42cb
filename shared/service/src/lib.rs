//! What every process shares: arguments, configuration, tracing, signals, readiness, health.
