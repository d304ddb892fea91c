//! The surface on which the app stands: a small set of objects that Swift can call.
//!
//! `ffi.rs` lists all of it. The other files hold what is behind each object; none of them holds
//! algorithms. Three rules keep the border safe:
//!
//! * **No panic crosses it.** Every entry runs inside `failure::guarded`; a panic becomes a failure of
//!   kind `Code::InternalFault`, and what it left half changed is not used again.
//! * **Everything is `Send + Sync`.** An object may be used from any thread; what changes is behind a
//!   mutex of its own, and two objects share none.
//! * **What takes long can be stopped.** It is given a `Work`, tells it how far it is, and ends with
//!   `Code::Cancelled` soon after the other side has cancelled.

// Arguments cross the border by value, whether their bodies keep them or not.
#![allow(clippy::needless_pass_by_value)]
#![cfg_attr(not(feature = "search"), allow(dead_code, reason = "search alone asks for some of it"))]

mod dataset;
mod device;
mod edits;
mod export;
mod failure;
mod ffi;
mod frame;
mod image;
mod measure;
mod renderer;
mod scene;
#[cfg_attr(not(feature = "search"), path = "searcher/absent.rs")]
mod searcher;
mod self_check;
mod trainer;
mod work;
