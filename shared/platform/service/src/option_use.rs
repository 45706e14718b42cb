//! Use of the options of every command: one that a command would ignore is refused.

use crate::{CommonArguments, Failure};
use clap::parser::ValueSource;
use clap::{ArgMatches, Args, Command, FromArgMatches};

/// Use that a command makes of [`CommonArguments`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OptionUse {
    /// None: the command asks no daemon and reads no configuration.
    Nothing,
    /// Choice of a daemon, or of its data: `--domain` and `--home`.
    Daemon,
    /// Configuration of a daemon that the command starts for itself: `--config`.
    Configuration,
    /// All of them.
    Everything,
}

/// Options that stand on the command line, whatever the environment says.
#[derive(Debug, Clone, Copy, Default)]
pub struct GivenOptions {
    /// `--domain` is given.
    pub domain: bool,
    /// `--home` is given.
    pub home: bool,
    /// `--config` is given.
    pub config: bool,
}

impl CommonArguments {
    /// Checks that the command uses the options that are given. An environment variable is not
    /// meant for one command, and may be ignored.
    ///
    /// # Errors
    /// When the command would ignore an option.
    pub fn check_use(&self, used: OptionUse) -> Result<(), Failure> {
        let GivenOptions {
            domain,
            home,
            config,
        } = self.given;
        let asks = matches!(used, OptionUse::Daemon | OptionUse::Everything);
        let reads = matches!(used, OptionUse::Configuration | OptionUse::Everything);
        let because = if reads {
            "starts a daemon of its own"
        } else {
            "asks no daemon"
        };
        for (name, is_given, is_used, because) in [
            ("--domain", domain, asks, because),
            ("--home", home, asks, because),
            ("--config", config, reads, "reads no configuration"),
        ] {
            if is_given && !is_used {
                return Err(Failure::usage(format!(
                    "{name} has no meaning for this command, which {because}; leave it out"
                )));
            }
        }
        Ok(())
    }
}

impl FromArgMatches for GivenOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let is_given = |id| matches.value_source(id) == Some(ValueSource::CommandLine);
        Ok(Self {
            domain: is_given("domain"),
            home: is_given("home"),
            config: is_given("config"),
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Looks at the options of [`CommonArguments`], and adds none.
impl Args for GivenOptions {
    fn augment_args(command: Command) -> Command {
        command
    }

    fn augment_args_for_update(command: Command) -> Command {
        command
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::{Parser, Subcommand};

    #[derive(Debug, Parser)]
    struct Program {
        #[command(flatten)]
        common: CommonArguments,
        #[command(subcommand)]
        verb: ShownVerb,
    }

    #[derive(Debug, Subcommand)]
    enum ShownVerb {
        Show,
    }

    fn refused(words: &str, used: OptionUse) -> Option<String> {
        let words = words.split_ascii_whitespace();
        let Program { common, verb } = Program::try_parse_from(words).unwrap();
        assert!(matches!(verb, ShownVerb::Show));
        let refused = common.check_use(used).err();
        refused.map(|failure| failure.sentence.split_once(' ').unwrap().0.to_owned())
    }

    #[test]
    fn options_are_refused_where_they_are_not_used_before_and_after_the_command() {
        use OptionUse::{Configuration, Daemon, Everything, Nothing};
        let all = [Nothing, Daemon, Configuration, Everything];
        for (option, users) in [
            ("--domain=x", [false, true, false, true]),
            ("--home=/x", [false, true, false, true]),
            ("--config=x.toml", [false, false, true, true]),
        ] {
            for words in [
                format!("tabula {option} show"),
                format!("tabula show {option}"),
            ] {
                for (used, is_user) in all.into_iter().zip(users) {
                    let name = option.split('=').next().unwrap();
                    let expected = (!is_user).then(|| name.to_owned());
                    assert_eq!(refused(&words, used), expected, "{words}, {used:?}");
                }
            }
        }
        for used in all {
            assert_eq!(refused("tabula show", used), None);
        }
    }
}
