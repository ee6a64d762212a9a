//! Wrong usage told like every other refusal: one message and one line of help.

use crate::failure::Failure;
use clap::error::{ContextKind, ContextValue, ErrorKind};

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
    let argument = match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(name)) => name.as_str(),
        _ => "",
    };
    let help = if kind == ErrorKind::MissingRequiredArgument {
        match message.as_str() {
            m if m.contains("<RAIL_") => {
                "for example: torse loft chine.csv sheer.csv --unit m --tolerance 0.5mm --out plate"
            }
            m if m.contains("<CURVE>") && command() == "net" => {
                "for example: torse net keel.csv --unit mm --start-ruling y --width 400mm --end-ruling 0.2,1,0 -t 0.05mm -o plate"
            }
            m if m.contains("<CURVE>") => "for example: torse hull inlet.dxf outlet.dxf --tolerance 0.1mm --out hopper",
            m if m.contains("<STRIP>") => "for example: torse planarise strip.csv --tolerance 0.01mm --out strip",
            _ => "for example: torse approximate hull.step --tolerance 2mm --out hull-panels",
        }
    } else if argument.starts_with("--tolerance") {
        "give a positive length with its unit, for example --tolerance 2mm"
    } else if argument.starts_with("--time-limit") {
        "give a positive time with its unit, for example --time-limit 5min"
    } else if argument.starts_with("--max-panels") {
        "give a whole number of at least 1, for example --max-panels 40, or leave it out"
    } else {
        return Failure::new(message, general());
    };
    Failure::new(message, help)
}

/// The first word after the program's name.
fn command() -> String {
    std::env::args().nth(1).unwrap_or_default()
}

/// Where options are listed.
fn general() -> String {
    let known = ["approximate", "cones", "fit", "loft", "net", "hull", "planarise", "info"];
    let command = command();
    let command = if known.contains(&command.as_str()) { command.as_str() } else { "approximate" };
    format!("'torse --help' and 'torse {command} --help' list commands and options, with examples")
}
