//! Encodings with more features are the same to those that were there before.

use rollin::Seed;
use rollin::prelude::*;

/// Whatever the numbers are, what was learned says the same of any text.
#[test]
fn new_features_change_nothing_by_themselves() {
    let text = rollin::grammar::defaults::TRAIN;
    let mut first = Corpus::parse(text).expect("a corpus");
    first.truncate(300);
    let more = first.split_off(100);
    let test = Corpus::parse(rollin::grammar::defaults::TEST).expect("a corpus");
    for template in ["U:%x[0,0]\nB\n", "U:%x[0,0]/%x[-1,0]\nB:%x[0,0]\nU:%y[-2]/%y[-1]\nU:%x[1,0]/%y[-1]\n"] {
        let template = Template::parse(template, "template".as_ref()).expect("a template");
        let settings = tagging::Settings::from(template);
        for learner in [AnyLearner::default(), AnyLearner::Net(Default::default())] {
            let recipe = Recipe { learner, ..Recipe::default() };
            let before: Tagger = recipe.train(&first, settings.clone()).expect("a tagger");
            let (encoding, space, moved) = before.encoding.extend(&more).expect("the same labels");
            assert!(encoding.features() > before.encoding.features() && moved.len() == encoding.features());
            assert_eq!(space.sentences(), more.sentences());
            let policy = before.policy.clone().map(&mut |one| one.map_weights(|weights| weights.renumber(&moved)));
            let after = Model { encoding, policy, ..before.clone() };
            let said = |tagger: &Tagger, corpus| tagger.tag(corpus, Seed::new(1)).expect("labels");
            for corpus in [&first, &more, &test] {
                assert_eq!(said(&before, corpus), said(&after, corpus));
            }
        }
    }
}
