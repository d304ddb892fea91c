//! Random numbers that are a pure function of where they are used.
//!
//! A training run must end the same whether it was interrupted or not, on any number of threads,
//! and the GPU must be able to draw the stream that the CPU draws. A generator with a state can do
//! none of this without saving and splitting the state. A *counter-based* generator
//! ([`philox4x32`]) maps (seed, step, purpose, index) to words directly: there is nothing to save.

mod normal;
mod philox;
mod stream;
mod view_order;

pub use normal::normal;
pub use philox::philox4x32;
pub use stream::{Purpose, Stream, below, uniform};
pub use view_order::ViewOrder;
