//! Chapters that go with the reference; every number of the theorems is computed and asserted by its examples.

#[doc = include_str!("speed.md")]
pub mod speed {}

#[doc = include_str!("theorems.md")]
pub mod theorems {}
