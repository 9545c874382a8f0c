//! Chapters that go with the reference; every number in them is computed and asserted by their examples.

#[doc = include_str!("theorems.md")]
pub mod theorems {}
