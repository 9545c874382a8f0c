//! The kart: tracks, driving and what is seen of it.

mod common;
mod driving;
mod picture;
mod tracks;
