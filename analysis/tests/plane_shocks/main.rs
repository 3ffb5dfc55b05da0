//! Exact plane waves: closed forms, conservation, and a first-order scheme that knows no waves.

mod closed_forms;
mod column;
mod conservation;
mod media;
mod release;
mod scheme;
