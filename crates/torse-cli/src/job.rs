//! A job under way: what every command that writes files has in common.

use crate::args::Files;
use crate::failure::Failure;
use crate::folder::Output;
use crate::shop;
use crate::terminal::Terminal;
use std::io::Write;
use std::path::Path;
use std::rc::Rc;
use std::time::Duration;
use torse::answer::marks::Marks;
use torse::answer::skipped::Skipped;
use torse::answer::Answer;
use torse::certify::claim::{Status, What};
use torse::control::Control;
use torse::develop::shop::thickness::Sheet;
use torse::develop::unfold::allowance::KFactor;
use torse::io::marks::{chosen, do_not_cut, MOST_NAMED};
use torse::io::words;
use torse::pipeline::deliver;
use torse::pipeline::workshop::{self, WorkshopError, WorkshopOptions};
use torse::search::cover::Limits;

/// The folder that results will be in, and the terminal that tells of the job.
pub struct Job<'a> {
    output: Output,
    terminal: Rc<Terminal>,
    files: &'a Files,
    shop: WorkshopOptions,
}

impl<'a> Job<'a> {
    /// Prepares the folder and the terminal; `input` is the file that the job reads, `limit` the time that it may take.
    /// Sheet has no thickness here but the one that is given.
    pub fn begin(files: &'a Files, input: &Path, limit: Option<Duration>) -> Result<Self, Failure> {
        shop::fibre_in_sheet(&files.shop)?;
        let terminal = Rc::new(Terminal::new(files.quiet, limit)?);
        Self::within(files, input, &terminal)
    }

    /// One of several jobs that share a terminal.
    pub fn within(files: &'a Files, input: &Path, terminal: &Rc<Terminal>) -> Result<Self, Failure> {
        let shop = shop::workshop(&files.shop)?;
        let output = Output::prepare(&files.out, input, files.force)?;
        let terminal = Rc::clone(terminal);
        terminal.guard(Some(output.workspace().to_path_buf()));
        Ok(Self { output, terminal, files, shop })
    }

    /// The control to hand to the library.
    pub fn control(&self) -> &Control {
        self.terminal.control()
    }

    /// Has flat patterns of the neutral fibre keep the limits of the sheet, too.
    pub fn keep(&mut self, limits: Limits) {
        self.shop.limits = limits;
    }

    /// What sheet and material say of panels: the least radius that they can follow, mm.
    pub fn least_panel_radius(&self) -> Option<f64> {
        self.shop.least_panel_radius()
    }

    /// Where the neutral fibre lies, as asked for or as the material says.
    pub fn k(&self) -> Option<KFactor> {
        let of_material = || self.shop.material.as_ref().and_then(|m| m.k.clone());
        self.shop.k.clone().or_else(of_material)
    }

    /// The sheet that surfaces are made of, if a thickness was given.
    pub fn sheet(&self) -> Option<Sheet> {
        self.shop.sheet()
    }

    /// Shows what the program itself is doing.
    pub fn say(&self, message: &'static str) {
        self.terminal.say(message);
    }

    /// Writes further files.
    pub fn write(&self, files: Vec<(String, Vec<u8>)>) -> Result<(), Failure> {
        files.into_iter().try_for_each(|(name, bytes)| self.output.write(&name, &bytes))
    }

    /// Writes the files of an answer, which are judged with it.
    pub fn deliver(&self, answer: &mut Answer) -> Result<(), Failure> {
        self.say("writing");
        answer.cut = self.files.cut();
        workshop::prepare(answer, &self.shop).map_err(|e| {
            let help = match e {
                WorkshopError::NoSheet => shop::OF_SHEET,
                _ => "'torse info' tells unit and size of the model",
            };
            Failure::new(e.to_string(), help)
        })?;
        // The maps of many parts are large, and nobody asks for them any more.
        answer.laid_faces = Vec::new();
        self.write_answer(answer, |name| name)
    }

    /// Writes the files of an answer, which are judged with it, each under the name that `named` gives it.
    pub fn write_answer(&self, answer: &mut Answer, named: impl Fn(String) -> String + Sync) -> Result<(), Failure> {
        let output = &self.output;
        deliver::each_file(answer, &crate::clock::stamp(), &|name, contents| {
            output.write_by(&named(name.to_owned()), contents)
        })
    }

    /// Moves the folder into place and tells the result; `Ok(true)` means certified.
    pub fn finish(self, answer: &Answer, tolerance: &str) -> Result<bool, Failure> {
        self.terminal.guard(None);
        self.terminal.finish();
        let interrupted = self.terminal.interrupted();
        let folder = self.output.finish()?;
        if !self.files.quiet {
            // A closed pipe is no reason to fail after the work is done.
            let _ = tell(answer, tolerance, &folder, interrupted);
        }
        Ok(answer.status() == Status::Certified)
    }
}

/// `--strict`: anything that is left out, by the reader or by the job, is an error.
pub fn refuse_left_out(file: &Path, left_out: &[Skipped]) -> Result<(), Failure> {
    let Some(first) = left_out.first() else { return Ok(()) };
    let more = match left_out.len() {
        1 => String::new(),
        n => format!(" (and {} more)", n - 1),
    };
    let first = match first.entity {
        Some(entity) => format!("#{entity} cannot be used: {}", words::why(&first.reason)),
        None => words::why(&first.reason),
    };
    Err(Failure::new(
        format!("{}: {first}{more}", file.display()),
        "repair it in CAD, or leave out --strict to go on with the rest",
    ))
}

/// Tells the result in a few lines: status with what was made, reason, claims of the whole, what was left out, notes.
fn tell(answer: &Answer, tolerance: &str, folder: &Path, interrupted: bool) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let curves: Vec<String> = answer.guides.iter().map(|g| g.name.clone()).collect();
    let made = format!("{}, tolerance {tolerance}, {:.1} s", words::made(answer), answer.seconds);
    match answer.status() {
        Status::Certified => writeln!(out, "certified: {made}")?,
        Status::Uncertified => {
            let in_part = answer.claims().iter().any(|c| c.what() == What::InPart);
            let reason = words::reason(answer.claims(), &curves);
            let [head, why] = uncertified(&made, (&reason, in_part), &warning(answer));
            writeln!(out, "{head}")?;
            writeln!(out, "  {why}")?;
        }
    }
    if interrupted {
        writeln!(out, "  stopped early, as asked")?;
    }
    for (c, name) in words::whole(answer) {
        // Of parts that have panels, the whole is covered.
        let beside =
            if c.what() == What::Coverage && !answer.skipped.is_empty() { " beside what is left out" } else { "" };
        let how = if c.is_unknown() { String::new() } else { format!(" ({})", words::evidence(c.evidence())) };
        writeln!(out, "  {name}{beside}: {}{how}", words::value(c))?;
    }
    for face in answer.patchwork().faces.iter().filter(|f| !f.parts.is_empty()) {
        let parts: Vec<String> = face.parts.iter().map(|p| format!("#{}", p.entity)).collect();
        writeln!(out, "  covered as one: {}", parts.join(" + "))?;
    }
    for skipped in answer.skipped.iter().take(MOST_LEFT_OUT) {
        writeln!(out, "  left out: {}", words::left_out(skipped))?;
    }
    if answer.skipped.len() > MOST_LEFT_OUT {
        writeln!(out, "  left out: {} more, all named in the report", answer.skipped.len() - MOST_LEFT_OUT)?;
    }
    for note in words::notes(&answer.notes) {
        writeln!(out, "  note: {note}")?;
    }
    writeln!(out, "  open {}", folder.join("report.html").display())
}

/// The first lines of a result that is not certified: what must not be cut, and why; where a part is certified, how much of
/// the whole that is comes first.
fn uncertified(made: &str, (reason, in_part): (&str, bool), warning: &str) -> [String; 2] {
    if in_part {
        return [format!("{reason}: {made}"), format!("NOT certified as a whole, {warning}")];
    }
    [format!("NOT certified, {warning}: {made}"), format!("reason: {reason}")]
}

/// Lines about what is left out, at most: the report has all.
const MOST_LEFT_OUT: usize = 40;

/// What must not be cut of a result that is not certified, in words.
fn warning(answer: &Answer) -> String {
    if answer.parts.is_empty() {
        return "there is nothing to cut".into();
    }
    let names = answer.parts.iter().map(|p| p.name.as_str());
    do_not_cut(&chosen(names, &Marks::of(answer).parts), answer.parts.len(), MOST_NAMED)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_certified_in_part_is_told_with_its_share_first() {
        let told = uncertified("1 strip", ("certified in part: 62.5 % of low.csv", true), "do not cut A");
        assert_eq!(told[0], "certified in part: 62.5 % of low.csv: 1 strip");
        assert_eq!(told[1], "NOT certified as a whole, do not cut A");
        assert_eq!(
            uncertified("1 strip", ("no proof", false), "do not cut A")[0],
            "NOT certified, do not cut A: 1 strip"
        );
    }
}
