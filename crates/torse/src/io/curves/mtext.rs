//! Texts of several lines (MTEXT) as the lines that their file has them in \[DXF2000\]. How letters are formatted is left out, and so
//! are breaks where a line is wider than the text's box, which depend on the letters of a program.

use super::dxf::{unescaped, Entity, Fault};
use crate::develop::refold::artwork::Words;
use crate::geom::Vec3;

/// Distance of lines in heights of their letters, by the format.
const LINES_APART: f64 = 5.0 / 3.0;
/// Places of a text that are held at the top of its letters, as drawings number these.
const TOP: i32 = 3;

/// The lines of a text, top down, mm; those without letters are left out.
pub(super) fn lines(e: &Entity, unit: f64) -> Result<Vec<Words>, Fault> {
    let frame = e.frame()?;
    let height = e.positive(40)? * unit;
    // A direction, or an angle: what the file has last counts.
    let way = match e.last_of([11, 50]) {
        Some(11) => e.point(11)?.try_normalize(0.0),
        _ => None,
    };
    let (sin, cos) = e.number(50)?.unwrap_or(0.0).to_radians().sin_cos();
    let way = way.unwrap_or_else(|| frame.vector_to_world(&Vec3::new(cos, sin, 0.0)));
    let up = frame.z.cross(&way);
    // From top left to bottom right in three rows.
    let held = (e.number(71)?.unwrap_or(1.0) as i32 - 1).clamp(0, 8);
    let step = height * LINES_APART * e.number(44)?.unwrap_or(1.0);
    let text: String = e.all_texts(3).chain([e.text(1)]).collect();
    let all = plain(&unescaped(&text));
    let whole = step * (all.len() - 1) as f64 + height;
    let top = e.point(10)? * unit + up * (whole * f64::from(held / 3) * 0.5);
    let line = |(k, text): (usize, String)| Words {
        text,
        at: top - up * (step * k as f64),
        way,
        normal: frame.z,
        height,
        stretch: 1.0,
        slant: 0.0,
        held: [held % 3, TOP],
    };
    Ok(all.into_iter().enumerate().filter(|l| !l.1.trim().is_empty()).map(line).collect())
}

/// The lines without the codes that format them.
fn plain(text: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut letters = text.chars();
    let mut put = |c: Option<char>| match (c, out.last_mut()) {
        (Some(c), Some(line)) => line.push(c),
        _ => out.push(String::new()),
    };
    while let Some(c) = letters.next() {
        match c {
            '{' | '}' => {}
            '^' => match letters.next() {
                Some('J') => put(None),
                Some('I') => put(Some(' ')),
                Some(' ') | None => put(Some('^')),
                Some(_) => {}
            },
            '\\' => match letters.next() {
                Some('P' | 'N') => put(None),
                Some('~') => put(Some('\u{a0}')),
                Some('L' | 'l' | 'O' | 'o' | 'K' | 'k') => {}
                Some('A' | 'C' | 'c' | 'F' | 'f' | 'H' | 'p' | 'Q' | 'T' | 'W') => {
                    letters.by_ref().take_while(|c| *c != ';').for_each(drop);
                }
                // A fraction or tolerances.
                Some('S') => {
                    let stacked = letters.by_ref().take_while(|c| *c != ';').filter(|c| *c != ' ');
                    stacked.for_each(|c| put(Some(if matches!(c, '^' | '#') { '/' } else { c })));
                }
                Some(other) => {
                    // What is escaped, and codes that the format does not have.
                    if !matches!(other, '\\' | '{' | '}') {
                        put(Some('\\'));
                    }
                    put(Some(other));
                }
                None => put(Some('\\')),
            },
            _ => put(Some(c)),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn codes_that_format_letters_are_left_out() {
        let text = r"{\fArial|b0|i0;\H2.5;Frame} \L12\l\Pa\~b \{c\\d\} \S1#2; \S+0.1^ -0.2;^Jend^ \q";
        assert_eq!(plain(text), ["Frame 12", "a\u{a0}b {c\\d} 1/2 +0.1/-0.2", "end^\\q"]);
    }
}
