//! Arguments outside their range are refused by name.

use crate::common::{learners, problem};
use rollin::policy::{Mixture, Reading};
use rollin::space::Imitation;
use rollin::space::experts::{Noisy, Partly, Suboptimal};
use rollin::tasks::Trainer;
use rollin::tasks::tagging::{Gold, TaggingProblem};
use rollin::trainer::{
    Aggrevate, Cpi, Dagger, EarlyUpdate, Forward, Lols, Rate, Run, Schedule, Searn, Smile, Stacking, Supervised,
};
use rollin::{Error, Seed};

fn small() -> TaggingProblem {
    problem(&vec![vec![("the".into(), "D".into()), ("cat".into(), "N".into())]])
}

fn refused(trainer: &Trainer, problem: &TaggingProblem, argument: &str) {
    for learner in learners() {
        match trainer.train(problem, &learner, &Run::new(1)) {
            Err(error @ Error::Argument { name, .. }) => {
                assert_eq!(name, argument, "{trainer:?}");
                assert!(error.to_string().starts_with(argument), "{error}");
            }
            Err(error) => panic!("{trainer:?}: {error}"),
            Ok(_) => panic!("{trainer:?} was accepted"),
        }
    }
}

#[test]
fn rates() {
    let problem = small();
    for rate in [0.0, -0.0, -0.1, 1.0 + f64::EPSILON, 2.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        refused(&Trainer::Smile(Smile { alpha: rate, ..Smile::default() }), &problem, "alpha");
        let searn = Searn { beta: rate, ..Searn::default() };
        refused(&Trainer::Searn(searn.clone()), &problem, "beta");
        refused(&Trainer::SearnShortcut(searn), &problem, "beta");
    }
    for rate in [1.0, f64::MIN_POSITIVE] {
        for learner in learners() {
            let smile = Trainer::Smile(Smile { alpha: rate, rounds: 1, ..Smile::default() });
            let searn = Trainer::Searn(Searn { beta: rate, rounds: 1, ..Searn::default() });
            assert!(smile.train(&problem, &learner, &Run::new(1)).is_ok(), "{rate}");
            assert!(searn.train(&problem, &learner, &Run::new(1)).is_ok(), "{rate}");
        }
    }
}

#[test]
fn counts() {
    let problem = small();
    let searn = Searn { rounds: 0, ..Searn::default() };
    let dagger = Dagger { rounds: 0, ..Dagger::default() };
    refused(&Trainer::Smile(Smile { rounds: 0, ..Smile::default() }), &problem, "rounds");
    refused(&Trainer::Searn(searn.clone()), &problem, "rounds");
    refused(&Trainer::SearnOnline(searn.clone()), &problem, "rounds");
    refused(&Trainer::SearnShortcut(searn), &problem, "rounds");
    refused(&Trainer::Dagger(dagger.clone()), &problem, "rounds");
    refused(&Trainer::DaggerOnline(dagger), &problem, "rounds");
    refused(&Trainer::Searn(Searn { samples: 0, ..Searn::default() }), &problem, "samples");
    refused(&Trainer::SearnOnline(Searn { samples: 0, ..Searn::default() }), &problem, "samples");
    refused(&Trainer::SearnOnline(Searn { beta: 0.0, ..Searn::default() }), &problem, "beta");
}

#[test]
fn episodes() {
    let Imitation { space, expert, .. } = small();
    let none = Imitation { space, expert, episodes: 0 };
    refused(&Trainer::Supervised(Supervised::default()), &none, "episodes");
    refused(&Trainer::Forward(Forward::default()), &none, "episodes");
    refused(&Trainer::Smile(Smile::default()), &none, "episodes");
    refused(&Trainer::Searn(Searn::default()), &none, "episodes");
    refused(&Trainer::SearnOnline(Searn::default()), &none, "episodes");
    refused(&Trainer::SearnShortcut(Searn::default()), &none, "episodes");
    refused(&Trainer::Dagger(Dagger::default()), &none, "episodes");
    refused(&Trainer::DaggerOnline(Dagger::default()), &none, "episodes");
}

#[test]
fn weights_of_mixtures() {
    let bad: [&[f64]; 6] = [&[], &[0.5], &[0.7, 0.7], &[1.5, -0.5], &[f64::NAN, 1.0], &[f64::INFINITY]];
    for weights in bad {
        let members = weights.iter().map(|w| (*w, ())).collect();
        let refusal = Mixture::of(members, Reading::Vote).map(|_| ());
        assert!(matches!(refusal, Err(Error::Argument { name: "weights", .. })), "{weights:?}");
    }
    assert!(Mixture::of(vec![(0.0, ()), (1.0, ())], Reading::Vote).is_ok());
}

#[test]
fn shares_and_sizes_of_the_later_trainers() {
    let problem = small();
    for rate in [0.0, -0.1, 1.0 + f64::EPSILON, f64::NAN] {
        refused(&Trainer::Cpi(Cpi { rate: Rate::Fixed(rate), ..Cpi::default() }), &problem, "rate");
    }
    for beta in [-0.1, 1.0 + f64::EPSILON, f64::NAN, f64::INFINITY] {
        refused(&Trainer::Lols(Lols { beta, ..Lols::default() }), &problem, "beta");
        refused(&Trainer::LolsOnline(Lols { beta, ..Lols::default() }), &problem, "beta");
    }
    let bad =
        [Schedule::Exponential(1.0), Schedule::Exponential(-0.1), Schedule::Exponential(f64::NAN), Schedule::Linear(0)];
    for schedule in bad {
        let dagger = Dagger { schedule: Some(schedule), ..Dagger::default() };
        refused(&Trainer::Dagger(dagger.clone()), &problem, "schedule");
        refused(&Trainer::DaggerOnline(dagger), &problem, "schedule");
        refused(&Trainer::Aggrevate(Aggrevate { schedule, ..Aggrevate::default() }), &problem, "schedule");
    }
    for text in ["", "First", "linear", "linear:0", "linear:-1", "linear:x", "exponential:1", "exponential:", "often:2"]
    {
        assert!(matches!(Schedule::parse(text), Err(Error::Argument { name: "schedule", .. })), "{text}");
    }
    assert_eq!(Schedule::parse("exponential:0.25").unwrap().share(3), 0.0625);
    assert_eq!(
        (1..=4).map(|i| Schedule::parse("linear:2").unwrap().share(i)).collect::<Vec<_>>(),
        [1.0, 0.5, 0.0, 0.0]
    );
    assert_eq!((1..=2).map(|i| Schedule::parse("first").unwrap().share(i)).collect::<Vec<_>>(), [1.0, 0.0]);
    refused(&Trainer::Cpi(Cpi { rounds: 0, ..Cpi::default() }), &problem, "rounds");
    refused(&Trainer::Cpi(Cpi { samples: 0, ..Cpi::default() }), &problem, "samples");
    refused(&Trainer::Aggrevate(Aggrevate { rounds: 0, ..Aggrevate::default() }), &problem, "rounds");
    refused(&Trainer::Lols(Lols { rounds: 0, ..Lols::default() }), &problem, "rounds");
    refused(&Trainer::LolsOnline(Lols { rounds: 0, ..Lols::default() }), &problem, "rounds");
    refused(&Trainer::EarlyUpdate(EarlyUpdate { rounds: 0, ..EarlyUpdate::default() }), &problem, "rounds");
    refused(&Trainer::EarlyUpdate(EarlyUpdate { width: 0, ..EarlyUpdate::default() }), &problem, "width");
    refused(&Trainer::EarlyUpdate(EarlyUpdate { width: 1025, ..EarlyUpdate::default() }), &problem, "width");
    refused(&Trainer::Stacked(Stacking { folds: 1, ..Stacking::default() }), &problem, "folds");
    refused(&Trainer::Stacked(Stacking { window: 65, ..Stacking::default() }), &problem, "window");
    let Imitation { space, expert, .. } = problem;
    let none = Imitation { space, expert, episodes: 0 };
    for trainer in crate::common::trainers() {
        refused(&trainer, &none, "episodes");
    }
    for chance in [-0.1, 1.1, f64::NAN] {
        assert!(matches!(Noisy::new(Gold, chance), Err(Error::Argument { name: "wrong", .. })));
        assert!(matches!(Partly::new(Gold, chance), Err(Error::Argument { name: "silent", .. })));
        assert!(matches!(Suboptimal::new(Gold, chance, Seed::new(1)), Err(Error::Argument { name: "bad", .. })));
    }
}
