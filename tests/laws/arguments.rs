//! Arguments outside their range are refused by name.

use crate::common::{learners, problem};
use rollin::Error;
use rollin::policy::{Mixture, Reading};
use rollin::space::Imitation;
use rollin::tasks::tagging::{TaggingProblem, Trainer};
use rollin::trainer::{Dagger, Forward, Run, Searn, Smile, Supervised};

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
    refused(&Trainer::SearnShortcut(searn), &problem, "rounds");
    refused(&Trainer::Dagger(dagger.clone()), &problem, "rounds");
    refused(&Trainer::DaggerOnline(dagger), &problem, "rounds");
    refused(&Trainer::Searn(Searn { samples: 0, ..Searn::default() }), &problem, "samples");
}

#[test]
fn episodes() {
    let Imitation { space, expert, .. } = small();
    let none = Imitation { space, expert, episodes: 0 };
    refused(&Trainer::Supervised(Supervised::default()), &none, "episodes");
    refused(&Trainer::Forward(Forward::default()), &none, "episodes");
    refused(&Trainer::Smile(Smile::default()), &none, "episodes");
    refused(&Trainer::Searn(Searn::default()), &none, "episodes");
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
