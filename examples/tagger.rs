//! Trains a tagger with DAgger, tags sentences it has never seen, and says how many labels are right.

use rollin::grammar::defaults;
use rollin::learner::Logistic;
use rollin::read::conll;
use rollin::tasks::About;
use rollin::tasks::tagging::{Encoding, Settings, Tagger};
use rollin::trainer::{Dagger, Run};
use rollin::{Result, Seed};

/// Runs the example.
pub fn main() -> Result<()> {
    let train = conll::parse(defaults::TRAIN.as_bytes(), "train".as_ref(), 1)?;
    let (encoding, space) = Encoding::learn(&train, Settings::default())?;
    let trained = Dagger::default().train_online(&space.problem(), &Logistic::default(), &Run::new(1))?;
    println!("asked the expert {} times", trained.ledger.queries);
    let tagger = Tagger::new(encoding, trained.policy, About::default())?;

    let test = conll::parse(defaults::TEST.as_bytes(), "test".as_ref(), 1)?;
    let labels = tagger.tag(&test, Seed::new(1))?;
    let right = (0..test.tokens()).filter(|t| tagger.encoding.labels[labels[*t] as usize] == test.word(1, *t)).count();
    println!("{right} of {} labels are right", test.tokens());
    assert!(right * 100 > test.tokens() * 90);
    Ok(())
}
