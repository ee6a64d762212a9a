//! Names in pictures, as data: on what they name where they fit, else on paper beside it with a line to it, else a number and
//! the name in a list.
//!
//! Pictures and the page of the report ask here, so that a name stands in the same place in both.

use super::flat::FlatPiece;
use super::label::{Place, SightMap};
use super::scene::NOT_CERTIFIED;
use super::stroke_font;
use crate::geom::Vec2;

/// Above this many panels, names would only cover the picture.
pub(crate) const MOST_NAMES: usize = 80;
/// Sizes of names, px.
const NAMES: std::ops::RangeInclusive<f64> = 9.0..=22.0;
/// Size of names beside what they name, px.
const BESIDE: f64 = 13.0;
/// Space about names, px.
const CLEAR: f64 = 3.0;
/// Distance of the base line of the words below a name from that of the name, against their size.
const WORDS_BELOW: f64 = 1.7;

/// A thing with a name, in a picture.
pub(crate) struct Named<'a> {
    /// Its number in the map of what is in sight.
    pub owner: u32,
    /// Its name.
    pub name: &'a str,
    /// Whether it must not be cut.
    pub marked: bool,
    /// Where there is most room on it.
    pub place: Place,
}

/// Where names may be that have no room on what they name.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Room {
    /// Names stand below this height, px.
    pub top: f64,
    /// How many stand beside what they name at most; of more none does.
    pub most: usize,
    /// Whether numbers stand for names whose lines would run across other things.
    pub numbers: bool,
}

/// A name as it is to be written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlacedName {
    /// Which of the things given.
    pub named: usize,
    /// The number in the list of names that stands for it here.
    pub number: Option<usize>,
    /// Middle of the name, px.
    pub middle: Vec2,
    /// Height of its capitals, px.
    pub size: f64,
    /// Size of the words below it that say that the thing must not be cut, and how far their base line is below that of the name.
    pub words: Option<(f64, f64)>,
    /// The line from the thing to a name beside it.
    pub leader: Option<[Vec2; 2]>,
}

impl PlacedName {
    /// What is written: the name, or the number that stands for it.
    pub fn text(&self, name: &str) -> String {
        self.number.map_or_else(|| name.to_owned(), |n| n.to_string())
    }
}

/// Enters flat parts into a map, `place` saying where they are in it, and answers those in sight.
pub(crate) fn of_pieces<'a>(
    map: &mut SightMap,
    pieces: &'a [FlatPiece],
    place: impl Fn(&Vec2) -> Vec2,
) -> Vec<Named<'a>> {
    for (k, piece) in pieces.iter().enumerate() {
        let outlines: Vec<Vec<Vec2>> = piece.outlines.iter().map(|o| o.iter().map(&place).collect()).collect();
        map.outlines(k as u32, &outlines);
    }
    let named = pieces.iter().zip(map.places(pieces.len())).enumerate();
    named
        .filter_map(|(k, (p, there))| Some(Named { owner: k as u32, name: &p.name, marked: p.marked, place: there? }))
        .collect()
}

/// How many names of so many parts stand beside them at most: of too many, those have names that have room for them.
pub(crate) fn most_beside(parts: usize) -> usize {
    if parts > MOST_NAMES {
        0
    } else {
        MOST_NAMES
    }
}

/// Names on what they name, else beside it with a line to it; where that would run across other things, numbers in the order of
/// the things, if the room has numbers. What must not be cut is called so, wherever its name is. Names for which there is no
/// room are left out.
pub(crate) fn placed(map: &mut SightMap, named: &[Named], room: Room) -> Vec<PlacedName> {
    let mut out = Vec::new();
    let mut narrow = Vec::new();
    let on = |k: usize, size: f64, words: bool| PlacedName {
        named: k,
        number: None,
        middle: named[k].place.middle,
        size,
        words: words.then(|| words_below(size)),
        leader: None,
    };
    for (k, n) in named.iter().enumerate().filter(|(_, n)| !n.name.is_empty()) {
        match fitting(map, n, n.marked) {
            Some(size) => out.push(on(k, size, n.marked)),
            None => narrow.push(k),
        }
    }
    let crowded = narrow.len() > room.most;
    let mut numbers = 0;
    for k in narrow {
        let n = &named[k];
        let beside_it = if crowded { None } else { beside(map, n, (room.top, !room.numbers)) };
        if let Some((middle, leader)) = beside_it {
            let words = n.marked.then(|| words_below(BESIDE));
            out.push(PlacedName { middle, words, leader: Some(leader), ..on(k, BESIDE, false) });
        } else if let Some(size) = fitting(map, n, false) {
            // Its colour says that it must not be cut.
            out.push(on(k, size, false));
        } else if room.numbers && !crowded {
            numbers += 1;
            out.push(PlacedName { number: Some(numbers), ..numbered(map, n, on(k, BESIDE, false), numbers, room.top) });
        }
    }
    out
}

/// A number in place of a name: on the thing where it fits, beside it if no line runs across anything, else over its border.
fn numbered(map: &mut SightMap, n: &Named, there: PlacedName, number: usize, top: f64) -> PlacedName {
    let digits = number.to_string();
    let short = Named { name: &digits, marked: false, ..*n };
    if let Some(size) = fitting(map, &short, false) {
        return PlacedName { size, ..there };
    }
    match beside(map, &short, (top, false)) {
        Some((middle, leader)) => PlacedName { middle, leader: Some(leader), ..there },
        None => PlacedName { size: *NAMES.start(), ..there },
    }
}

/// The names for which numbers stand, in their order, with which of the things given has each.
pub(crate) fn listed(names: &[PlacedName]) -> Vec<(usize, usize)> {
    let mut out: Vec<(usize, usize)> = names.iter().filter_map(|n| Some((n.number?, n.named))).collect();
    out.sort_unstable();
    out
}

/// Names of flat parts on a page.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct SheetNames {
    /// The names with their lengths in mm, y upwards.
    pub names: Vec<PlacedName>,
    /// Corners of the box around the parts and the names beside them.
    pub extent: [Vec2; 2],
}

/// Size (px) of the window in which pages show the flat parts.
const WINDOW: Vec2 = Vec2::new(1000.0, 640.0);
/// Paper around the parts on which names may stand, px.
const AROUND: f64 = 90.0;

/// The names of flat parts that lie within a box (mm), for a page that shows them as large as the window allows.
pub(crate) fn on_sheet(pieces: &[FlatPiece], [low, high]: [Vec2; 2]) -> SheetNames {
    let pixel = (high - low).component_div(&WINDOW).max();
    let mut out = SheetNames { names: Vec::new(), extent: [low, high] };
    if !(pixel > 0.0 && pixel.is_finite()) {
        return out;
    }
    let to_map = |p: &Vec2| Vec2::new(p.x - low.x, high.y - p.y) / pixel + Vec2::repeat(AROUND);
    let to_sheet = |p: Vec2| {
        let p = (p - Vec2::repeat(AROUND)) * pixel;
        Vec2::new(low.x + p.x, high.y - p.y)
    };
    let size = (high - low) / pixel + Vec2::repeat(2.0 * AROUND);
    let mut map = SightMap::new(size.x as usize, size.y as usize);
    let named = of_pieces(&mut map, pieces, to_map);
    let room = Room { top: 0.0, most: most_beside(pieces.len()), numbers: true };
    for mut name in placed(&mut map, &named, room) {
        if name.leader.is_some() {
            let n = &named[name.named];
            let (half, down) = name_box(&name.text(n.name), name.size, name.words.is_some());
            for p in [-half, half].map(|h| to_sheet(name.middle + Vec2::new(0.0, down) + h)) {
                out.extent = [out.extent[0].inf(&p), out.extent[1].sup(&p)];
            }
        }
        name.named = named[name.named].owner as usize;
        name.middle = to_sheet(name.middle);
        name.leader = name.leader.map(|l| l.map(to_sheet));
        name.size *= pixel;
        name.words = name.words.map(|(size, below)| (size * pixel, below * pixel));
        out.names.push(name);
    }
    out
}

/// Size of the words below a name, and how far their base line is below that of the name.
fn words_below(name: f64) -> (f64, f64) {
    let size = (0.6 * name).max(*NAMES.start());
    (size, WORDS_BELOW * size)
}

/// Half the size of the box of a name, with the words below it that it must not be cut, and how far the middle of the box is below
/// that of the name.
fn name_box(name: &str, size: f64, marked: bool) -> (Vec2, f64) {
    let wide = stroke_font::width(name, size);
    if !marked {
        return (Vec2::new(0.5 * wide, 0.5 * size), 0.0);
    }
    let (words, below) = words_below(size);
    (Vec2::new(0.5 * wide.max(stroke_font::width(NOT_CERTIFIED, words)), 0.5 * (size + below)), 0.5 * below)
}

/// The size in which a name, and the words below it where it has some, stays on what it names.
fn fitting(map: &SightMap, n: &Named, words: bool) -> Option<f64> {
    // A name takes this share of the room around its place; every try is smaller.
    const SHARE: f64 = 0.85;
    let (least, most) = (*NAMES.start(), *NAMES.end());
    let breadth = n.place.breadth / stroke_font::width(n.name, 1.0).max(1.0);
    let mut size = (SHARE * n.place.room.min(breadth)).clamp(least, most);
    loop {
        let (half, down) = name_box(n.name, size, words);
        if map.is_on(n.owner, n.place.middle + Vec2::new(0.0, down), half + Vec2::repeat(CLEAR)) {
            return Some(size);
        }
        if size <= least {
            return None;
        }
        size = (SHARE * size).max(least);
    }
}

/// Middle of a name on paper beside what it names, below `top`, and the line to it, across other things if it may go there, if there
/// is room.
fn beside(map: &mut SightMap, n: &Named, (top, across): (f64, bool)) -> Option<(Vec2, [Vec2; 2])> {
    let (half, down) = name_box(n.name, BESIDE, n.marked);
    let starts = map.starts(n.owner, n.place.middle);
    let [at, place] = map.beside(n.owner, &starts, half, (top, across))?;
    // From the thing to the nearest point of the name's box.
    let clear = half + Vec2::repeat(CLEAR);
    let end = place + (at - place).inf(&clear).sup(&-clear);
    Some((place - Vec2::new(0.0, down), [at, end]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_beside_say_that_a_part_must_not_be_cut() {
        let slim = [[0.0, 0.0], [400.0, 0.0], [400.0, 4.0], [0.0, 4.0]].map(Vec2::from);
        let mut map = SightMap::new(600, 300);
        let outline: Vec<Vec2> = slim.iter().map(|p| p + Vec2::new(100.0, 150.0)).collect();
        map.outlines(0, &[outline]);
        let place = map.places(1)[0].expect("a place");
        let mut named = Named { owner: 0, name: "A-01", marked: false, place };
        assert_eq!(fitting(&map, &named, false), None);
        let one = |named: &Named, most: usize| {
            placed(&mut map.clone(), std::slice::from_ref(named), Room { top: 20.0, most, numbers: false })
        };
        let plain = one(&named, 1);
        assert!(plain.len() == 1 && plain[0].leader.is_some() && plain[0].words.is_none(), "{plain:?}");
        named.marked = true;
        let marked = one(&named, 1);
        assert!(marked[0].words.is_some());
        // Both lie beside the part, not across it.
        for (p, words) in [(plain[0], false), (marked[0], true)] {
            let (half, down) = name_box("A-01", p.size, words);
            let middle = p.middle + Vec2::new(0.0, down);
            let (low, high) = (middle - half, middle + half);
            assert!(high.y < 150.0 || low.y > 154.0 || high.x < 100.0 || low.x > 500.0, "{p:?}");
        }
        // Where nothing may be beside, nothing lies across the part either.
        assert_eq!(one(&named, 0), []);
    }

    #[test]
    fn numbers_stand_for_names_whose_lines_would_run_across_other_parts() {
        let box_of = |name: &str, [x, y]: [f64; 2], [wide, high]: [f64; 2]| {
            let outline = [[x, y], [x + wide, y], [x + wide, y + high], [x, y + high]].map(Vec2::from).to_vec();
            FlatPiece { name: name.into(), outlines: vec![outline], ..FlatPiece::default() }
        };
        // Two small parts in the middle of large ones.
        let mut pieces: Vec<FlatPiece> = (0..5)
            .flat_map(|i| {
                (0..5).map(move |j| box_of("large", [250.0 * f64::from(i), 250.0 * f64::from(j)], [245.0; 2]))
            })
            .collect();
        pieces[12] = box_of("a long name", [500.0, 500.0], [245.0, 12.0]);
        pieces.push(box_of("another long name", [500.0, 518.0], [100.0, 8.0]));
        pieces.push(box_of("", [605.0, 518.0], [140.0, 8.0]));
        pieces.push(box_of("", [500.0, 532.0], [245.0, 213.0]));
        pieces[12].marked = true;
        let found = on_sheet(&pieces, [Vec2::zeros(), Vec2::repeat(1245.0)]).names;
        let texts: Vec<String> = found.iter().map(|n| n.text(&pieces[n.named].name)).collect();
        assert_eq!(texts.iter().filter(|t| *t == "large").count(), 24);
        assert_eq!(listed(&found), [(1, 12), (2, 25)]);
        assert!(texts.contains(&"1".to_owned()) && texts.contains(&"2".to_owned()), "{texts:?}");
        assert!(found.iter().all(|n| n.leader.is_none() || n.named >= 12));
    }

    /// Strips above each other, the middle ones hidden by their neighbours but for their ends.
    pub(crate) fn strips() -> Vec<FlatPiece> {
        let strip = |k: usize| {
            let y = 30.0 * k as f64;
            let outline = [[0.0, y], [2000.0, y], [2000.0, y + 8.0], [0.0, y + 8.0]].map(Vec2::from).to_vec();
            FlatPiece { panel: k, name: format!("A-{:02}", k + 1), outlines: vec![outline], ..FlatPiece::default() }
        };
        (0..8).map(strip).collect()
    }

    #[test]
    fn names_of_narrow_parts_on_a_page_are_apart_and_off_all_parts() {
        let pieces = strips();
        let found = on_sheet(&pieces, [Vec2::zeros(), Vec2::new(2000.0, 218.0)]);
        assert_eq!(found.names.len(), 8);
        let boxes: Vec<[Vec2; 2]> = found
            .names
            .iter()
            .map(|n| {
                let (half, _) = name_box(&pieces[n.named].name, n.size, false);
                [n.middle - half, n.middle + half]
            })
            .collect();
        let meet = |a: &[Vec2; 2], b: &[Vec2; 2]| (0..2).all(|k| a[0][k] <= b[1][k] && b[0][k] <= a[1][k]);
        for (k, b) in boxes.iter().enumerate() {
            assert!(boxes[..k].iter().all(|other| !meet(b, other)));
            assert!(pieces.iter().all(|p| !meet(b, &[p.outlines[0][0], p.outlines[0][2]])));
            assert!((0..2).all(|i| b[0][i] >= found.extent[0][i] - 1e-9 && b[1][i] <= found.extent[1][i] + 1e-9));
            // The line begins on the part and crosses no other.
            let n = found.names[k];
            let [from, to] = n.leader.expect("a line");
            let crossed = |p: &FlatPiece| {
                (0..=1000).any(|s| {
                    let x = from + (to - from) * (f64::from(s) / 1000.0);
                    meet(&[x, x], &[p.outlines[0][0], p.outlines[0][2]])
                })
            };
            assert!(pieces.iter().all(|p| p.panel == n.named || !crossed(p)), "{n:?}");
        }
    }
}
