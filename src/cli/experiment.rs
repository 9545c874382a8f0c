//! `rollin experiment`

use super::progress::Work;
use super::report::{ReportOptions, Sources};
use super::terminal::names;
use super::{Global, print, print_json};
use crate::error::{Error, Result};
use crate::experiment::{Filmed, Lab, Plan, Platforming, Racing, Scale, claims, page, text};
use crate::output::{check_writable, write_whole};
use crate::read::input;
use crate::seed::Seed;
use crate::tasks::kart::Tracks;
use crate::tasks::platformer::Levels;
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};

/// A game.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum GameName {
    /// Drive a lap by what the camera sees
    Kart,
    /// Run and jump through a level by what is around
    Platformer,
}

/// Where a game takes place, if not where the program says.
#[derive(Args)]
pub struct Place {
    /// A grammar of levels, for platformer [default: the one in the program]
    #[arg(long, value_name = "FILE")]
    levels: Option<PathBuf>,
    /// A grammar of tracks, for kart [default: the one in the program]
    #[arg(long, value_name = "FILE")]
    tracks: Option<PathBuf>,
}

impl Place {
    /// The platform game there.
    pub fn platforming(&self) -> Result<Platforming> {
        refuse("--tracks", self.tracks.as_deref(), "platformer")?;
        Platforming::new(self.levels.as_ref().map_or_else(Levels::standard, Levels::read)?)
    }

    /// The kart there.
    pub fn racing(&self) -> Result<Racing> {
        refuse("--levels", self.levels.as_deref(), "kart")?;
        // One track for all seeds: what is learned on it is driven on it.
        Racing::new(&self.tracks.as_ref().map_or_else(Tracks::standard, Tracks::read)?, Seed::new(1))
    }
}

/// Refuses a file that the game has no use for.
fn refuse(name: &'static str, file: Option<&Path>, game: &str) -> Result<()> {
    file.map_or(Ok(()), |file| Err(Error::argument(name, file.display(), format!("left out: {game} has none"))))
}

/// Run the experiments of Ross & Bagnell (2010, section 5) on two games: who learns to play from how many of the expert's answers.
///
/// Every method is measured after every round on games that nobody trained on. What the paper claims is held against the intervals that come out; a
/// claim that does not come out is told, and is no error.
#[derive(Args)]
#[command(after_help = super::help::experiment())]
pub struct Experiment {
    /// The game
    #[arg(value_enum, value_name = "GAME")]
    game: GameName,
    /// As small as can be: the same methods and rounds in minutes
    #[arg(long, conflicts_with = "scale")]
    quick: bool,
    /// The part of the paper's examples, above 0 and at most 1 (for kart: of ten trainings)
    #[arg(long, default_value_t = 0.1, value_name = "PART")]
    scale: f64,
    /// Follow the plan in this file, as it is kept in a folder of --resume; its seed is what counts
    #[arg(long, conflicts_with_all = ["quick", "scale"], value_name = "FILE")]
    plan: Option<PathBuf>,
    /// These methods only, separated by commas [default: all]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    methods: Vec<String>,
    /// Keep finished parts in this folder and go on from those that are there already: the result is the same as without
    #[arg(long, value_name = "FOLDER")]
    resume: Option<PathBuf>,
    /// Write what each method had learned at the end of its first training to this folder, a model file for each: for `rollin drive`
    #[arg(long, value_name = "FOLDER")]
    models: Option<PathBuf>,
    #[command(flatten)]
    place: Place,
    #[command(flatten)]
    report: ReportOptions,
}

impl Experiment {
    pub fn run(&self, global: &Global) -> Result<()> {
        let scale = if self.quick { Scale::Quick } else { Scale::Part(self.scale) };
        match self.game {
            GameName::Kart => self.run_on(&self.place.racing()?, Racing::plan(scale, global.seed)?, global),
            GameName::Platformer => {
                self.run_on(&self.place.platforming()?, Platforming::plan(scale, global.seed)?, global)
            }
        }
    }

    fn run_on<G: Filmed>(&self, game: &G, mut plan: Plan, global: &Global) -> Result<()> {
        if let Some(path) = &self.plan {
            let parsed = serde_json::from_slice(&input::bytes(path)?);
            plan = parsed.map_err(|error| Error::file(path, error.to_string(), "give a plan.json of --resume"))?;
        }
        if let Some(name) = self.methods.iter().find(|name| plan.methods.iter().all(|method| method.name != **name)) {
            let known: Vec<&str> = plan.methods.iter().map(|method| method.name.as_str()).collect();
            return Err(Error::argument("--methods", name, format!("some of {}", names(name, &known))));
        }
        plan.methods.retain(|method| self.methods.is_empty() || self.methods.contains(&method.name));
        if let Some(folder) = &self.models {
            std::fs::create_dir_all(folder).map_err(|source| Error::io("make", folder, source))?;
            check_writable(&folder.join("model"))?;
        }
        let files = self.files();
        self.report.check(&files.iter().map(|(_, path)| *path).collect::<Vec<_>>())?;
        let work = Work::new(G::NAME, global.quiet);
        let watch = |tick: &_| work.show(tick);
        let learnt = Lab { game, plan: &plan, folder: self.resume.clone(), watch: &watch }.run()?;
        drop(work);
        if let Some(folder) = &self.models {
            for (name, driver) in &learnt.drivers {
                let about = format!("{name}, seed {}", plan.seed);
                write_whole(&folder.join(format!("{name}.model")), &driver.to_bytes::<G::View>(G::NAME, &about))?;
            }
        }
        let claims = claims(&learnt.findings);
        if global.json {
            print_json(&serde_json::json!({ "findings": learnt.findings, "claims": claims }))?;
        } else {
            print(&text(&learnt.findings, &claims))?;
        }
        let page = || {
            let mut page = page(&learnt.findings, &claims);
            if self.plan.is_some() {
                page.fact("seed of the plan, which is what counts", plan.seed.to_string());
            }
            page
        };
        self.report.write(page, global, &Sources { files: &files, texts: &[] })
    }

    /// The files that are read, by what they are for.
    fn files(&self) -> Vec<(&'static str, &Path)> {
        let files = [("plan", &self.plan), ("levels", &self.place.levels), ("tracks", &self.place.tracks)];
        files.into_iter().filter_map(|(what, path)| Some((what, path.as_deref()?))).collect()
    }
}
