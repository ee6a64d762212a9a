//! What must not be cut, in words: the first line of reports, the captions of pictures, the names of products.

use crate::answer::marks::Marks;
use crate::draw::scene::{titled, NOT_CERTIFIED};

/// Names told in captions and on terminals; reports tell all.
pub const MOST_NAMED: usize = 8;

/// What must not be cut of so many parts; at most `most` names are told.
pub fn do_not_cut(marked: &[&str], parts: usize, most: usize) -> String {
    match marked {
        [] => "its parts may be cut, but they are not the whole".into(),
        [one] => format!("do not cut {one}"),
        all if all.len() == parts => format!("do not cut any of the {parts} parts"),
        some => {
            let told = some.iter().take(most).copied().collect::<Vec<_>>().join(", ");
            let more = if some.len() > most { format!(" and {} more", some.len() - most) } else { String::new() };
            format!("do not cut {told}{more} ({} of {parts} parts)", some.len())
        }
    }
}

/// Those names of `names` that are marked.
pub fn chosen<'a>(names: impl Iterator<Item = &'a str>, marked: &[bool]) -> Vec<&'a str> {
    names.zip(marked).filter(|(_, m)| **m).map(|(n, _)| n).collect()
}

/// The name of the whole in CAD files.
pub(super) fn product(name: &str, marks: &Marks) -> String {
    let (count, all) = (marks.panels.iter().filter(|m| **m).count(), marks.panels.len());
    if count == 0 || count == all {
        return titled(name, count > 0);
    }
    format!("{name} ({count} of {all} {NOT_CERTIFIED})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_not_to_cut_are_named() {
        assert_eq!(do_not_cut(&["A-01"], 1, 3), "do not cut A-01");
        assert_eq!(do_not_cut(&["A-01", "A-02"], 2, 3), "do not cut any of the 2 parts");
        assert_eq!(do_not_cut(&["A-01", "A-03"], 4, 3), "do not cut A-01, A-03 (2 of 4 parts)");
        assert_eq!(do_not_cut(&["A", "B", "C"], 4, 1), "do not cut A and 2 more (3 of 4 parts)");
        assert!(do_not_cut(&[], 4, 3).contains("may be cut"));
        assert_eq!(chosen(["A", "B"].into_iter(), &[false, true]), ["B"]);
        let marks = |m: [bool; 2]| Marks { panels: m.into(), ..Marks::default() };
        assert_eq!(product("hull", &marks([false, false])), "hull");
        assert_eq!(product("hull", &marks([true, false])), "hull (1 of 2 NOT CERTIFIED)");
        assert_eq!(product("hull", &marks([true, true])), "hull NOT CERTIFIED");
    }
}
