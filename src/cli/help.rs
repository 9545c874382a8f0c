//! What stands below the options of each command: what to type. Every line that begins with `rollin`, set in by two, is run by a test.

use super::terminal::help;
use clap::builder::StyledStr;

/// `rollin --help`
pub fn program() -> StyledStr {
    help(
        "\
Examples:
  rollin generate --grammar grammars/dialects.grammar --count 1000 > words.txt
  rollin train --data words.txt --model words.model
  cut -d ' ' -f 1 words.txt | rollin tag --model words.model > tagged.txt

What is read may be packed (.gz, .zst), and - is standard input. Each command has examples of its own.",
    )
}

const TRAIN: &str = "\
Examples:
  rollin train --data train.txt --model tagger.model
  rollin train --data train.txt.gz --template words.template --model tagger.model
  rollin train --data train.txt --model sure.model --calibrate
  rollin train --task parsing --data train.conllu --model parser.model
  rollin train --task segmenting --data train.txt --model spans.model --span 4
  rollin train --task ocr --data letters.tsv --model reader.model
  rollin train --task graph --data graphs.txt --model graphs.model
  rollin train --task navigation --data maps.txt --model maps.model --costs 1,9
  rollin train --task tabular --data problem.json --model walker.model
";

/// One recipe an algorithm, the default first.
const RECIPES: &str = "
Which algorithm:
  good labels, quick      dagger-online, or smile with --reuse: they ask for labels only
  every mistake counts    aggrevate or searn-shortcut: they learn what each label costs in the end
  labels that may be bad  lols-online: rolls out with itself as often as with the expert
  a gentle start          dagger --schedule: the expert drives less often in each round
  the paper's theory      forward, smile, searn, and cpi --conservative

Recipes, with who rolls in and who rolls out:

DAgger: the learner rolls in, the expert only labels; nobody rolls out. The one to begin with.
  rollin train --data train.txt --model tagger.model --algorithm dagger-online
  rollin train --data train.txt --model tagger.model --algorithm dagger --schedule exponential:0.5

Supervised: the expert rolls in, nobody rolls out. To compare with: it never sees its own mistakes.
  rollin train --data train.txt --model tagger.model --algorithm supervised

Forward: the classifiers of earlier steps roll in, nobody rolls out. For short episodes.
  rollin train --data train.txt --model tagger.model --algorithm forward --longest 64

SMILe: expert and classifiers roll in, one drawn a step; nobody rolls out. Where no state can be
put back; with --reuse where labels are dear.
  rollin train --data train.txt --model tagger.model --algorithm smile --alpha 0.3 --reuse

SEARN: expert and classifiers roll in, one drawn a step, and roll out every action. Where mistakes
are not alike; online it learns from the costs as they come, in less time and memory, and the
shortcut asks the expert what an action costs and rolls nothing out.
  rollin train --data train.txt --model tagger.model --algorithm searn --learner csoaa --beta 0.3
  rollin train --data train.txt --model tagger.model --algorithm searn-online --learner hinge --warm
  rollin train --data train.txt --model tagger.model --algorithm searn-shortcut --learner csoaa

CPI: as SEARN, but from one state an episode. Where roll-outs are dear; --conservative only goes
as far as it gains, and never leaves a perfect expert.
  rollin train --data train.txt --model tagger.model --algorithm cpi --rounds 10

AggreVaTe: the learner rolls in, the expert tells what each action costs if it goes on from there.
Where mistakes are not alike and the expert knows their costs.
  rollin train --data train.txt --model tagger.model --algorithm aggrevate --learner csoaa

LOLS: the learner rolls in; the expert or the learner rolls out. Where the expert can be outdone.
  rollin train --data train.txt --model tagger.model --algorithm lols --reference 0.5
  rollin train --data train.txt --model tagger.model --algorithm lols-online --learner csoaa

Stacked: the expert rolls in once for two stages; nobody rolls out. Where what comes later matters.
  rollin train --data train.txt --model tagger.model --algorithm stacked --window 2

Early update: the learner's beam rolls in until the right path falls out of it; nobody rolls out.
Where one label at a time is too hasty.
  rollin train --data train.txt --model tagger.model --algorithm early-update --width 8
";

/// `rollin train -h`
pub fn train() -> StyledStr {
    help(&format!("{TRAIN}\n`rollin train --help` has a recipe for each algorithm."))
}

/// `rollin train --help`
pub fn recipes() -> StyledStr {
    help(&format!("{TRAIN}{RECIPES}"))
}

/// The others' examples, by command.
macro_rules! examples {
    ($($name:ident $text:expr;)*) => {
        $(pub fn $name() -> StyledStr {
            help(concat!("Examples:\n  ", $text))
        })*
    };
}

examples! {
    tag "\
  rollin tag --model tagger.model < new.txt > tagged.txt
  rollin tag --model tagger.model < new.txt.gz > tagged.txt
  rollin tag --model tagger.model --explain < new.txt
  rollin tag --model tagger.model --explain --json < new.txt > reasons.jsonl
  rollin tag --model sure.model --confidence < new.txt
  rollin tag --model parser.model < new.conllu > parsed.conllu";
    evaluate "\
  rollin evaluate --model tagger.model --data test.txt
  rollin evaluate --model tagger.model --data test.txt --errors 5
  rollin evaluate --model tagger.model --data test.txt --html report.html
  rollin evaluate --model parser.model --data train.conllu --json";
    compare "\
  rollin compare --algorithms supervised,dagger
  rollin compare --data train.txt --test test.txt --algorithms supervised,smile,dagger
  rollin compare --data train.txt --algorithms smile,searn --learner csoaa --html compare.html

`rollin train --help` says which algorithm for what.";
    convert "\
  rollin convert --from conll --to vw --template words.template < train.txt > train.vw
  rollin convert --from vw --to crfsuite --data train.vw
  rollin convert --from conllu --to conll --data train.conllu
  rollin convert --from conll --to conll --repair --order bilou < train.txt > bilou.txt";
    generate "\
  rollin generate --grammar grammars/dialects.grammar --count 3
  rollin generate --grammar grammars/dialects.grammar --count 1000 --seed 2 | gzip > more.txt.gz";
    inspect "\
  rollin inspect tagger.model
  rollin inspect tagger.model --label B-NP --top 20
  rollin inspect tagger.model --data train.txt --json";
    theory "\
  rollin theory audit problem.json
  rollin theory bounds --horizon 10 --alpha 0.1
  rollin theory plan --horizon 10 --alpha 0.1 --beta 0.1 --m 1000 --actions 4 --k 1 --rounds 44";
    audit "\
  rollin theory audit problem.json
  rollin theory audit - --json < problem.json
  rollin theory audit problem.json --html audit.html";
    bounds "\
  rollin theory bounds --horizon 10 --alpha 0.1
  rollin theory bounds --horizon 100 --alpha 0.01 --rounds 1000 --html bounds.html";
    plan "\
  rollin theory plan --horizon 10 --alpha 0.1 --beta 0.1 --m 1000 --actions 4 --k 1 --rounds 44";
    experiment "\
  rollin experiment kart --quick --models drivers
  rollin experiment platformer --quick --resume kept --html platformer.html";
    drive "\
  rollin experiment kart --quick --models drivers
  rollin drive --task kart --model drivers/smile-0.1.model --html lap.html
  rollin drive --task kart --model drivers/smile-0.1.model --html lap.html --game 2";
    completions "\
  rollin completions bash > rollin.bash
  rollin completions zsh > _rollin
  rollin completions fish > rollin.fish

Where it belongs: bash takes it from ~/.local/share/bash-completion/completions/rollin, zsh from any folder of
$fpath, fish from ~/.config/fish/completions; PowerShell and elvish take it at the end of what they start with.";
    man "\
  rollin man > rollin.1
  rollin man share/man/man1";
}

/// `rollin update`
pub fn update() -> StyledStr {
    help(
        "\
Examples:
  rollin generate --grammar grammars/dialects.grammar --count 200 --seed 2 > more.txt
  rollin update --model words.model --data more.txt --output newer.model
  rollin update --model newer.model --data more.txt --output newer.model --rounds 2",
    )
}

/// `rollin serve`
#[cfg(feature = "serve")]
pub fn serve() -> StyledStr {
    help(
        "\
Examples:
  rollin serve --model tagger.model
  rollin serve --model tagger.model --body-limit 100000 --time-limit 2 --queue 64

Then, from another terminal:
  curl --data-binary @new.txt http://127.0.0.1:8080/tag",
    )
}
