//! Chapters that go with the reference. Their examples are run as tests, and their commands, too.

#[doc = include_str!("start.md")]
pub mod start {}

#[doc = include_str!("the_loop.md")]
pub mod the_loop {}

#[doc = include_str!("choosing.md")]
pub mod choosing {}

#[doc = include_str!("spaces.md")]
///
/// ```
#[doc = include_str!("../../examples/sorting.rs")]
/// ```
// Its test is run where the example is.
#[allow(clippy::test_attr_in_doctest)]
pub mod spaces {}

#[doc = include_str!("learners.md")]
pub mod learners {}

#[doc = include_str!("bill.md")]
pub mod bill {}

#[doc = include_str!("theorems.md")]
pub mod theorems {}

#[doc = include_str!("long-runs.md")]
pub mod long_runs {}

#[doc = include_str!("speed.md")]
pub mod speed {}

#[doc = include_str!("games.md")]
pub mod games {}

#[doc = include_str!("serving.md")]
pub mod serving {}

#[doc = include_str!("limits.md")]
pub mod limits {}

#[doc = include_str!("from_crfsuite.md")]
pub mod from_crfsuite {}

#[doc = include_str!("from_vowpal_wabbit.md")]
pub mod from_vowpal_wabbit {}

#[doc = include_str!("from_wapiti.md")]
pub mod from_wapiti {}

#[doc = include_str!("complaints.md")]
pub mod complaints {}
