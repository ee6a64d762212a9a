//! Whether the tables of a part say the same of its bend lines: an operator bends by the angles, but where the sheet lies
//! follows from the turns up to the lines, or from the table of its bends, so that wrong angles would go unseen.

use super::tables::{TableBend, TableLine, PRINTED_ANGLE};
use crate::develop::unfold::bends::BendKind;
use crate::io::bends::BendRecord;
use crate::patchwork::pattern::BendSense;

/// What would help.
const HELP: &str = "take the tables as they were written, or change both numbers alike";

/// A line of `bends.csv` in degrees.
struct Said {
    sense: BendSense,
    angle: f64,
    turned: f64,
}

impl Said {
    fn of(row: &TableLine) -> Self {
        let b = &row.bend;
        Self { sense: b.sense, angle: b.angle.to_degrees(), turned: b.turned.to_degrees() }
    }
}

/// Lines of a sheet's bends against `bend_table.csv` and against their own turns.
///
/// The lines of a bend, fold or hem turn as far as the table says. At lines with a radius the sheet has turned by half of the
/// angle. The lines of a rolled face share its turn evenly, or some shares are halved, again and again: at each line it has turned by a
/// whole number and a half of the line's own share, after what the row before turned where the face goes on from there.
///
/// # Errors
/// In words: the line, both numbers, and what would help.
pub(super) fn sheet(lines: &[TableLine], bends: &[TableBend]) -> Result<(), String> {
    // Where the row before ends, which may be of the same face, bent the other way.
    let mut before = 0.0;
    for (k, bend) in bends.iter().enumerate() {
        let row = format!("bend {} of bend_table.csv", k + 1);
        let own: Vec<(usize, Said)> =
            bend.lines.clone().filter_map(|l| Some((l + 1, Said::of(lines.get(l)?)))).collect();
        match bend.kind {
            BendKind::Rolled => rolled(&own, bend, (&row, before))?,
            BendKind::Bend | BendKind::Fold | BendKind::Hem => bent(&own, bend, &row)?,
        }
        before = own.last().map_or(0.0, |(_, s)| match s.sense {
            BendSense::Down => s.turned - 0.5 * s.angle,
            _ => s.turned + 0.5 * s.angle,
        });
    }
    Ok(())
}

/// Lines of a bend, a fold or a hem.
fn bent(own: &[(usize, Said)], bend: &TableBend, row: &str) -> Result<(), String> {
    let whole = bend.angle.to_degrees();
    for (number, said) in own {
        if said.sense != bend.sense {
            return Err(ways(*number, said.sense, row, bend.sense));
        }
        // Bends that are one in the table may differ by its last digit.
        if differ(said.angle, whole, 2.0 * PRINTED_ANGLE) {
            return Err(angles(*number, said.angle, &format!("{row} says {whole:.4}")));
        }
        // Folds have no turn up to them: each is a bend of its own.
        if said.turned != 0.0 && differ(2.0 * said.turned.abs(), said.angle, 2.0 * PRINTED_ANGLE) {
            return Err(angles(*number, said.angle, &halves(said.turned)));
        }
        if said.turned != 0.0 && (said.turned > 0.0) != (said.sense == BendSense::Up) {
            let turned = format!("turned_deg {:.4}", said.turned);
            return Err(format!("line {number} of bends.csv bends {}, but has {turned}; {HELP}", said.sense.name()));
        }
    }
    Ok(())
}

/// Lines of a rolled face, after a turn (degrees) by the row before if it goes on from there.
fn rolled(own: &[(usize, Said)], bend: &TableBend, (row, before): (&str, f64)) -> Result<(), String> {
    let Some(first) = own.first().map(|(n, _)| *n) else { return Ok(()) };
    let whole = bend.angle.to_degrees();
    if own.iter().all(|(_, s)| s.sense != bend.sense) {
        return Err(ways(first, own[0].1.sense, row, bend.sense));
    }
    for (number, said) in own {
        let share = said.angle;
        // Every share that it has turned by adds what its last digit leaves open, and the row before another two.
        let is_half = |from: f64, more: f64| {
            let shares = (said.turned - from).abs() / share.max(PRINTED_ANGLE) - 0.5;
            let open = (shares.abs() + 2.0 + more) * PRINTED_ANGLE;
            !differ(shares, shares.round(), open / share.max(PRINTED_ANGLE))
        };
        if !is_half(0.0, 0.0) && !is_half(before, 2.0) {
            return Err(angles(*number, said.angle, &halves(said.turned)));
        }
        // A face that is as good as plane has a line without an angle.
        let count = if share > PRINTED_ANGLE { (whole / share).round() } else { own.len() as f64 };
        if differ(whole, count * share, (count + 1.0) * PRINTED_ANGLE) {
            return Err(angles(*number, share, &format!("{row} says {whole:.4}, no whole number of such lines")));
        }
    }
    Ok(())
}

/// Lines against those of `report.json`: where the sheet has turned as far as the report says, the line has its angle.
///
/// The report's numbers are those that were proven; a table that was changed throughout has other turns, and it is used.
/// `bent` says whether the part has a table of its bends: folds of these have no turn, and are measured by that table.
///
/// # Errors
/// As [`sheet`].
pub(super) fn report(lines: &[TableLine], records: &[BendRecord], bent: bool) -> Result<(), String> {
    if lines.len() != records.len() {
        return Ok(());
    }
    for (k, (line, told)) in lines.iter().zip(records).enumerate() {
        let said = Said::of(line);
        if differ(said.turned, told.turned_deg, PRINTED_ANGLE) || (bent && said.turned == 0.0) {
            continue;
        }
        if differ(said.angle, told.angle_deg, PRINTED_ANGLE) {
            let other = format!("report.json has {:.4} at the same turned_deg {:.4}", told.angle_deg, told.turned_deg);
            return Err(angles(k + 1, said.angle, &other));
        }
        if said.sense.name() != told.sense {
            let sense = said.sense.name();
            return Err(format!(
                "line {} of bends.csv bends {sense}, but report.json says {}; {HELP}",
                k + 1,
                told.sense
            ));
        }
    }
    Ok(())
}

/// Whether two numbers are farther apart than what is left open, or one is none.
fn differ(a: f64, b: f64, open: f64) -> bool {
    let off = (a - b).abs();
    off.is_nan() || off > open
}

fn angles(number: usize, angle: f64, other: &str) -> String {
    format!("line {number} of bends.csv has angle_deg {angle:.4}, but {other}; {HELP}")
}

fn halves(turned: f64) -> String {
    format!("its turned_deg {turned:.4} is not that up to the middle of such a line")
}

fn ways(number: usize, sense: BendSense, row: &str, other: BendSense) -> String {
    format!("line {number} of bends.csv bends {}, but {row} says {}; {HELP}", sense.name(), other.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patchwork::pattern::Bend;

    fn line(sense: BendSense, angle: f64, turned: f64) -> TableLine {
        let bend = Bend { turned: turned.to_radians(), ..Bend::of(sense, angle.to_radians(), [3.0; 2]) };
        TableLine { bend, length: 80.0 }
    }

    fn bend(kind: BendKind, sense: BendSense, angle: f64, count: usize) -> TableBend {
        let none = f64::NAN;
        let angle = angle.to_radians();
        TableBend { kind, sense, angle, inside_radius: none, allowance: none, k: none, lines: 0..count }
    }

    use BendSense::{Down, Up};

    #[test]
    fn lines_of_bends_and_folds_turn_as_the_table_says() {
        let table = [bend(BendKind::Bend, Down, 90.0, 2)];
        // Holes cut a line in pieces; bends in line that differ by the last digit are one.
        assert_eq!(sheet(&[line(Down, 90.0, -45.0), line(Down, 90.0001, -45.0)], &table), Ok(()));
        assert_eq!(sheet(&[line(Up, 60.0, 0.0)], &[bend(BendKind::Fold, Up, 60.0, 1)]), Ok(()));
        let fault = |lines: &[TableLine]| sheet(lines, &table).expect_err("another angle");
        let edited = fault(&[line(Down, 180.0, -45.0), line(Down, 90.0, -45.0)]);
        assert!(edited.contains("line 1 of bends.csv") && edited.contains("180.0000"), "{edited}");
        assert!(edited.contains("bend 1 of bend_table.csv says 90.0000"), "{edited}");
        assert!(fault(&[line(Down, 90.0, -45.0), line(Down, 90.0, -44.0)]).contains("turned_deg -44.0000"));
        assert!(fault(&[line(Down, 90.0, -45.0), line(Down, 90.4, -45.2)]).contains("line 2 of bends.csv"));
        assert!(fault(&[line(Down, 90.001, -45.0005)]).contains("says 90.0000"));
        assert!(fault(&[line(Up, 90.0, 45.0)]).contains("bends up, but bend 1 of bend_table.csv says down"));
        assert!(fault(&[line(Down, 90.0, 45.0)]).contains("has turned_deg 45.0000"));
        assert!(sheet(&[line(Up, 5.0, 0.0)], &[bend(BendKind::Fold, Up, 60.0, 1)]).is_err());
    }

    #[test]
    fn lines_of_a_rolled_face_share_its_turn() {
        // 187.9385° in 38 lines, of which holes leave some out.
        let at = |k: usize| line(Down, 4.9458, -((k as f64 + 0.5) * 187.9385 / 38.0 * 1e4).round() / 1e4);
        let lines: Vec<TableLine> = [0, 1, 2, 7, 7, 8, 30, 37].map(at).into();
        let table = |sense, angle| [bend(BendKind::Rolled, sense, angle, lines.len())];
        assert_eq!(sheet(&lines, &table(Down, 187.9385)), Ok(()));
        assert!(sheet(&lines, &table(Up, 187.9385)).expect_err("the other way").contains("says up"));
        assert!(sheet(&lines, &table(Down, 186.0)).expect_err("another turn").contains("186.0000"));
        let mut one = lines.clone();
        one[3].bend.angle *= 1.1;
        assert!(sheet(&one, &table(Down, 187.9385)).expect_err("one").contains("line 4 of bends.csv"));
        let mut all = lines.clone();
        all.iter_mut().for_each(|l| l.bend.angle *= 2.0);
        assert!(sheet(&all, &table(Down, 187.9385)).expect_err("all").contains("line 1 of bends.csv"));
        all.iter_mut().for_each(|l| l.bend.angle = 0.0);
        assert!(sheet(&all, &table(Down, 187.9385)).is_err());
        // The third share is halved, and the second half of that again.
        let parts = [(0.0, 8.0), (8.0, 8.0), (16.0, 4.0), (20.0, 2.0), (22.0, 2.0), (24.0, 8.0)];
        let halved: Vec<TableLine> = parts.iter().map(|(from, share)| line(Up, *share, from + 0.5 * share)).collect();
        let row = [bend(BendKind::Rolled, Up, 32.0, halved.len())];
        assert_eq!(sheet(&halved, &row), Ok(()));
        for (k, factor) in [(2, 2.0), (2, 0.5), (3, 2.0), (0, 0.5)] {
            let mut other = halved.clone();
            other[k].bend.angle *= factor;
            let fault = sheet(&other, &row).expect_err("another angle");
            assert!(fault.contains(&format!("line {} of bends.csv", k + 1)), "{fault}");
        }
        assert_eq!(sheet(&[line(Down, 0.0, 0.0)], &[bend(BendKind::Rolled, Down, 0.0, 1)]), Ok(()));
    }

    #[test]
    fn lines_of_other_parts_turn_as_the_report_says() {
        let told = line(Up, 5.0, 2.5);
        let of = |l: &TableLine| BendRecord {
            sense: l.bend.sense.name().into(),
            angle_deg: l.bend.angle.to_degrees(),
            radii: [None; 2],
            length: 80.0,
            turned_deg: l.bend.turned.to_degrees(),
            radii_before: None,
        };
        let record = [of(&told)];
        assert_eq!(report(&[told], &record, false), Ok(()));
        // A table that was changed throughout is used.
        assert_eq!(report(&[line(Up, 5.5, 2.75)], &record, false), Ok(()));
        let fault = report(&[line(Up, 10.0, 2.5)], &record, false).expect_err("twice the angle");
        assert!(fault.contains("10.0000") && fault.contains("report.json has 5.0000"), "{fault}");
        assert!(report(&[line(Down, 5.0, 2.5)], &record, false).expect_err("down").contains("says up"));
    }
}
