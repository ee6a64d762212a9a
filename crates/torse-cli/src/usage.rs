//! Wrong usage told like every other refusal: one message and one line of help.

use crate::args::Arguments;
use crate::failure::Failure;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::CommandFactory;

/// The refusal for arguments that cannot be understood. Help and version are printed at once and end the program.
pub fn refusal(error: clap::Error) -> Failure {
    let kind = error.kind();
    if matches!(
        kind,
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
    ) {
        error.exit();
    }
    // The message is the first paragraph; usage and tips of the parser follow after a blank line.
    let text = error.to_string();
    let first = text.split("\n\n").next().unwrap_or_default();
    let message = first.strip_prefix("error: ").unwrap_or(first).split_whitespace().collect::<Vec<_>>().join(" ");
    let told = |what: ContextKind| match error.get(what) {
        Some(ContextValue::String(name)) => name.clone(),
        Some(ContextValue::Strings(names)) => names.join(" "),
        _ => String::new(),
    };
    let argument = told(ContextKind::InvalidArg);
    let help = match kind {
        ErrorKind::MissingRequiredArgument if argument.starts_with("--thickness") => {
            let given = ["--side", "--offsets"].iter().filter(|o| std::env::args().any(|a| a.starts_with(*o)));
            let given: Vec<&str> = given.copied().collect();
            format!(
                "give the thickness of the sheet too, for example --thickness 2mm: {} asks for it",
                given.join(" and ")
            )
        }
        // Only options that others need have names without being needed always.
        ErrorKind::MissingRequiredArgument if needed_by_others(&argument) => {
            format!("give {argument} too: another option that was given needs it; {}", general())
        }
        ErrorKind::MissingRequiredArgument => format!("for example: {}", example()),
        ErrorKind::ArgumentConflict => format!("leave one of both out; {}", general()),
        ErrorKind::UnknownArgument => others_with(&argument),
        _ if argument.starts_with("--tolerance") => {
            "give a positive length with its unit, for example --tolerance 2mm".into()
        }
        _ if argument.starts_with("--time-limit") => {
            "give a positive time with its unit, for example --time-limit 5min".into()
        }
        _ if argument.starts_with("--max-panels") => {
            "give a whole number of at least 1, for example --max-panels 40, or leave it out".into()
        }
        _ => general(),
    };
    Failure::new(message, help)
}

/// The command that was called, the main one where it is none.
fn command() -> clap::Command {
    let name = std::env::args().nth(1).unwrap_or_default();
    let all = Arguments::command();
    let of = |name: &str| all.find_subcommand(name).cloned();
    of(&name).or_else(|| of("approximate")).unwrap_or_default()
}

/// Whether an argument that is missing may as well be left out.
fn needed_by_others(argument: &str) -> bool {
    let long =
        |a: &clap::Arg| a.get_long().is_some_and(|l| argument.split_whitespace().next() == Some(&format!("--{l}")));
    command().get_arguments().any(|a| long(a) && !a.is_required_set())
}

/// The first example of the command's own help.
fn example() -> String {
    let command = command();
    let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let line = help.lines().map(str::trim).find(|l| l.starts_with("torse "));
    line.map_or_else(general, ToString::to_string)
}

/// Which commands have an option that this one has not.
fn others_with(argument: &str) -> String {
    let long = |a: &clap::Arg| a.get_long().is_some_and(|l| argument.split('=').next() == Some(&format!("--{l}")));
    let all = Arguments::command();
    let names: Vec<&str> =
        all.get_subcommands().filter(|c| c.get_arguments().any(long)).map(clap::Command::get_name).collect();
    match &names[..] {
        [] => general(),
        some => format!("{argument} is an option of torse {}; {}", some.join(", "), general()),
    }
}

/// Where options are listed.
fn general() -> String {
    format!("'torse --help' and 'torse {} --help' list commands and options, with examples", command().get_name())
}
