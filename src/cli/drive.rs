//! `rollin drive`

use super::experiment::{GameName, Place};
use super::{Global, print, print_json};
use crate::error::{Error, Result};
use crate::experiment::{Driver, Filmed, NetOf, replay};
use crate::output::{check_writable, write_whole};
use crate::read::input;
use crate::seed::Seed;
use crate::space::Space;
use clap::Args;
use std::path::{Path, PathBuf};

/// Let what an experiment learned play a game, and write a page to watch it: policy and expert side by side, decision by decision.
#[derive(Args)]
#[command(after_help = super::help::drive())]
pub struct Drive {
    /// The game
    #[arg(long, value_enum, value_name = "GAME")]
    task: GameName,
    /// A model file that `rollin experiment --models` wrote
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Another one, which plays the same game beside it
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
    /// The page to write
    #[arg(long, value_name = "FILE")]
    html: PathBuf,
    /// Which game: for platformer, game i is of difficulty i modulo 11
    #[arg(long, default_value_t = 0, value_name = "N")]
    game: usize,
    #[command(flatten)]
    place: Place,
}

impl Drive {
    pub fn run(&self, global: &Global) -> Result<()> {
        match self.task {
            GameName::Kart => self.run_on(&self.place.racing()?, global),
            GameName::Platformer => self.run_on(&self.place.platforming()?, global),
        }
    }

    fn run_on<G: Filmed>(&self, game: &G, global: &Global) -> Result<()> {
        let models: Vec<&PathBuf> = std::iter::once(&self.model).chain(&self.against).collect();
        if models.contains(&&self.html) {
            return Err(Error::argument("--html", self.html.display(), "another file than the models"));
        }
        check_writable(&self.html)?;
        let drivers = models.into_iter().map(|path| driver(game, path)).collect::<Result<Vec<_>>>()?;
        let (rides, page) = replay(game, &drivers, self.game, Seed::new(global.seed))?;
        write_whole(&self.html, page.as_bytes())?;
        if global.json {
            let told = |ride: &crate::experiment::Ride| serde_json::json!({ "name": ride.name, "end": ride.end, "decisions": ride.decisions, "different": ride.different });
            return print_json(
                &serde_json::json!({ "page": self.html, "rides": rides.iter().map(told).collect::<Vec<_>>() }),
            );
        }
        let line = |ride: &crate::experiment::Ride| {
            format!(
                "{}: {}; {} of {} decisions differ from the expert's\n",
                ride.name, ride.end, ride.different, ride.decisions
            )
        };
        let lines: String = rides.iter().map(line).collect();
        print(&format!("{lines}wrote {}\n", self.html.display()))
    }
}

/// The policy in the file at `path`, and its name.
fn driver<G: Filmed>(game: &G, path: &Path) -> Result<(String, Driver<NetOf<G>>)> {
    let bytes = input::raw(path)?;
    let (driver, about) =
        Driver::from_bytes::<G::View>(&bytes, path, (G::NAME, game.space().shared(), game.space().actions()))?;
    Ok((about, driver))
}
