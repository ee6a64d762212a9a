//! A single-stroke alphabet of our own for legends: letters as line and spline strokes.
//!
//! Glyphs are drawn on a grid: baseline y = 2, small letters reach y = 6, capitals y = 8, descenders y = 0.
//! A stroke is written as a letter and two-digit points (x, y): `L` a polyline, `S` a quadratic B-spline with
//! clamped ends, `O` a closed quadratic B-spline.

use crate::geom::Vec2;

/// Height of capitals on the grid.
const CAP: f64 = 6.0;
/// Height of the baseline on the grid.
const BASELINE: f64 = 2.0;
/// Space between glyphs on the grid.
const SPACING: f64 = 1.9;
/// Segments per piece of a spline stroke: below a tenth of a pixel of chord error at legend sizes.
const PIECES: usize = 6;

/// Strokes of `text` as polylines: x to the right from 0, y upwards from the baseline, capitals `height` tall.
/// Characters outside the alphabet appear as a box.
pub(crate) fn strokes(text: &str, height: f64) -> Vec<Vec<Vec2>> {
    let scale = height / CAP;
    let mut pen = 0.0;
    let mut all = Vec::new();
    for c in text.chars() {
        let (letter, accent) = parted(c);
        let (advance, glyph) = glyph(letter);
        let raised = if letter.is_uppercase() { CAPITAL_RISE } else { 0.0 };
        let over = Vec2::new(0.5 * advance - ACCENT_MIDDLE, raised);
        let strokes = glyph.split_whitespace().map(|s| (s, Vec2::zeros()));
        for (stroke, moved) in strokes.chain(accent.split_whitespace().map(|s| (s, over))) {
            let place = |p: &Vec2| Vec2::new((p.x + moved.x + pen) * scale, (p.y + moved.y - BASELINE) * scale);
            all.push(stroke_points(stroke).iter().map(place).collect());
        }
        pen += advance + SPACING;
    }
    all
}

/// Width of `text` with capitals `height` tall.
pub fn width(text: &str, height: f64) -> f64 {
    let grid: f64 = text.chars().map(|c| glyph(parted(c).0).0 + SPACING).sum();
    (grid - SPACING).max(0.0) * height / CAP
}

/// Every character with where it begins and ends along the line.
pub(crate) fn extents(text: &str, height: f64) -> Vec<(char, [f64; 2])> {
    let mut pen = 0.0;
    let extent = |c: char| {
        let from = pen;
        pen += glyph(parted(c).0).0 + SPACING;
        (c, [from, pen - SPACING].map(|x| x * height / CAP))
    };
    text.chars().map(extent).collect()
}

/// Points of one stroke on the grid.
fn stroke_points(stroke: &str) -> Vec<Vec2> {
    let mut digits = stroke.bytes().skip(1).map(|b| f64::from(b.wrapping_sub(b'0')));
    let mut control = Vec::new();
    while let (Some(x), Some(y)) = (digits.next(), digits.next()) {
        control.push(Vec2::new(x, y));
    }
    match stroke.as_bytes().first() {
        Some(b'S') => spline(&control, false),
        Some(b'O') => spline(&control, true),
        _ => control,
    }
}

/// Quadratic B-spline through the middles of its control polygon; an open one starts and ends at the end points.
fn spline(control: &[Vec2], closed: bool) -> Vec<Vec2> {
    let n = control.len();
    let middle = |i: usize, j: usize| (control[i] + control[j]) * 0.5;
    let mut points = Vec::new();
    let mut piece = |a: Vec2, b: Vec2, c: Vec2| {
        for k in 0..=PIECES {
            let t = k as f64 / PIECES as f64;
            points.push(a * (1.0 - t).powi(2) + b * (2.0 * t * (1.0 - t)) + c * (t * t));
        }
    };
    if closed {
        for i in 0..n {
            piece(middle((i + n - 1) % n, i), control[i], middle(i, (i + 1) % n));
        }
    } else {
        for i in 1..n.saturating_sub(1) {
            let a = if i == 1 { control[0] } else { middle(i - 1, i) };
            let c = if i + 2 == n { control[n - 1] } else { middle(i, i + 1) };
            piece(a, control[i], c);
        }
    }
    points
}

/// Middle of accents on their own grid.
const ACCENT_MIDDLE: f64 = 2.0;
/// How much higher accents stand on capitals.
const CAPITAL_RISE: f64 = 1.8;

/// A letter with an accent as both; other characters as they are.
fn parted(c: char) -> (char, &'static str) {
    const DIAERESIS: &str = "L1717 L3737";
    const ACUTE: &str = "L1738";
    const GRAVE: &str = "L1827";
    const CIRCUMFLEX: &str = "L172837";
    const TILDE: &str = "S07182738";
    const RING: &str = "O17283726";
    const CARON: &str = "L182738";
    const CEDILLA: &str = "S2221312010";
    const SLASH: &str = "L0147";
    const BAR: &str = "L1436";
    const LOW_BAR: &str = "L0224";
    let pairs = [
        ("\u{e4}\u{eb}\u{ef}\u{f6}\u{fc}\u{ff}\u{c4}\u{cb}\u{cf}\u{d6}\u{dc}", "aeiouyAEIOU", DIAERESIS),
        ("\u{e1}\u{e9}\u{ed}\u{f3}\u{fa}\u{fd}\u{c1}\u{c9}\u{cd}\u{d3}\u{da}", "aeiouyAEIOU", ACUTE),
        ("\u{107}\u{144}\u{15b}\u{17a}\u{106}\u{143}\u{15a}\u{179}", "cnszCNSZ", ACUTE),
        ("\u{e0}\u{e8}\u{ec}\u{f2}\u{f9}\u{c0}\u{c8}\u{cc}\u{d2}\u{d9}", "aeiouAEIOU", GRAVE),
        ("\u{e2}\u{ea}\u{ee}\u{f4}\u{fb}\u{c2}\u{ca}\u{ce}\u{d4}\u{db}", "aeiouAEIOU", CIRCUMFLEX),
        ("\u{e3}\u{f1}\u{f5}\u{c3}\u{d1}\u{d5}", "anoANO", TILDE),
        ("\u{e5}\u{c5}", "aA", RING),
        ("\u{10d}\u{11b}\u{159}\u{161}\u{17e}\u{10c}\u{158}\u{160}\u{17d}", "cerszCRSZ", CARON),
        ("\u{e7}\u{c7}", "cC", CEDILLA),
        ("\u{f8}\u{d8}", "oO", SLASH),
        ("\u{142}", "l", BAR),
        ("\u{141}", "L", LOW_BAR),
    ];
    for (accented, letters, accent) in pairs {
        if let Some(letter) = accented.chars().zip(letters.chars()).find(|p| p.0 == c).map(|p| p.1) {
            return (letter, accent);
        }
    }
    (c, "")
}

/// Width on the grid and strokes of a character.
#[expect(clippy::too_many_lines, reason = "a table of letters")]
fn glyph(c: char) -> (f64, &'static str) {
    match c {
        ' ' => (1.8, ""),
        '0' => (4.0, "O02424808"),
        '1' => (2.4, "L062822"),
        '2' => (4.0, "S0708484502 L0242"),
        '3' => (4.0, "S0708484525 S2545420203"),
        '4' => (4.0, "L380444 L3832"),
        '5' => (4.0, "L380805 S0546420203"),
        '6' => (4.0, "O02424606 S380804"),
        '7' => (4.0, "L084812"),
        '8' => (4.0, "O05454808 O02424505"),
        '9' => (4.0, "O04444808 S124246"),
        'A' => (4.6, "L022842 L1434"),
        'B' => (4.0, "L28080222 L0525 S28484525 S25454222"),
        'C' => (4.4, "S4748480802424243"),
        'D' => (4.6, "L18080212 S18484212"),
        'E' => (3.4, "L38080232 L0535"),
        'F' => (3.2, "L380802 L0535"),
        'G' => (4.6, "S474808024244 L254544"),
        'H' => (4.0, "L0802 L4842 L0545"),
        'I' => (0.0, "L0802"),
        'J' => (3.0, "L3834 S34320203"),
        'K' => (4.0, "L0802 L480542"),
        'L' => (3.2, "L080232"),
        'M' => (6.0, "L0208346862"),
        'N' => (4.4, "L02084248"),
        'O' => (5.0, "O02525808"),
        'P' => (3.8, "L280802 L0525 S28484525"),
        'Q' => (5.0, "O02525808 L3452"),
        'R' => (4.0, "L280802 L0525 S28484525 L2542"),
        'S' => (4.0, "S4748080545420203"),
        'T' => (4.0, "L0848 L2822"),
        'U' => (4.2, "L0804 S04024244 L4448"),
        'V' => (4.2, "L082248"),
        'W' => (6.0, "L0822374268"),
        'X' => (4.0, "L0842 L0248"),
        'Y' => (4.0, "L082548 L2522"),
        'Z' => (4.0, "L08480242"),
        'a' => (3.8, "O02424606 L4642"),
        'b' => (3.8, "O02424606 L0802"),
        'c' => (3.4, "S454606024243"),
        'd' => (3.8, "O02424606 L4842"),
        'e' => (3.8, "L0444 S444606024243"),
        'f' => (2.4, "S381816 L1612 L0626"),
        'g' => (3.8, "O02424606 L4641 S41400001"),
        'h' => (3.6, "L0802 S04064644 L4442"),
        'i' => (0.0, "L0602 L0808"),
        'j' => (1.2, "L1612 S121000 L1818"),
        'k' => (3.2, "L0802 L360432"),
        'l' => (0.0, "L0802"),
        'm' => (6.0, "L0602 S04063634 L3432 S34366664 L6462"),
        'n' => (3.6, "L0602 S04064644 L4442"),
        'o' => (3.9, "O02424606"),
        'p' => (3.8, "O02424606 L0600"),
        'q' => (3.8, "O02424606 L4640"),
        'r' => (2.4, "L0602 S040626"),
        's' => (3.0, "S3536060434320203"),
        't' => (2.4, "L1814 S141232 L0626"),
        'u' => (3.6, "L0604 S04024244 L4642"),
        'v' => (3.8, "L062246"),
        'w' => (5.8, "L0622364266"),
        'x' => (3.2, "L0632 L0236"),
        'y' => (3.8, "L0622 L4610"),
        'z' => (3.2, "L06360232"),
        '.' => (0.2, "L0202"),
        ',' => (0.6, "L1201"),
        ':' => (0.2, "L0202 L0606"),
        ';' => (0.6, "L1201 L1616"),
        '\'' => (0.0, "L0807"),
        '"' => (1.4, "L0807 L1817"),
        '!' => (0.0, "L0804 L0202"),
        '-' => (2.2, "L0424"),
        '_' => (4.0, "L0141"),
        '+' => (4.0, "L0545 L2723"),
        '\u{2212}' | '\u{2013}' => (3.6, "L0545"),
        '\u{b1}' => (4.0, "L0646 L2824 L0242"),
        '=' => (4.0, "L0646 L0444"),
        '<' => (4.0, "L470543"),
        '>' => (4.0, "L074503"),
        '\u{2264}' => (4.0, "L480644 L0242"),
        '\u{2265}' => (4.0, "L084604 L0242"),
        '/' => (2.6, "L0138"),
        '(' => (1.4, "S29060421"),
        ')' => (1.4, "S09262401"),
        '[' => (1.4, "L19090111"),
        ']' => (1.4, "L09191101"),
        '%' => (5.0, "O06262808 O32525434 L4812"),
        '#' => (4.6, "L1812 L3832 L0646 L0444"),
        '*' => (2.4, "L1915 L0826 L0628"),
        '\u{b7}' => (0.8, "L0505"),
        '\u{d7}' => (3.2, "L0733 L0337"),
        '\u{b0}' => (2.0, "O06262808"),
        '\u{b2}' => (2.0, "S0809292806 L0626"),
        '&' => (5.0, "S522617283847360402325354"),
        '\u{e6}' => (6.0, "O02323606 L3632 L3464 S646636326263"),
        '\u{153}' => (6.0, "O02323606 L3464 S646636326263"),
        '\u{c6}' => (7.0, "L78484272 L4565 L0248 L1444"),
        '\u{152}' => (7.0, "L78484272 L4565 O02424808"),
        '\u{df}' => (4.0, "L0207 S07183847362545433222"),
        '?' => (4.0, "S0718384736252324 L2222"),
        '@' => (5.4, "O25354443 S4543525658382814225152"),
        '|' => (0.0, "L0901"),
        '~' => (4.0, "S04152546"),
        _ => (4.0, "L0242480802"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printable_text_of_reports_has_glyphs_of_its_own() {
        let tofu = glyph('\u{fffd}').1;
        let known =
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789 .,:;-_+\u{b1}=<>\u{2264}\u{2265}/()%#";
        // Names of people's files.
        let names = "&\u{e4}\u{f6}\u{fc}\u{c4}\u{d6}\u{dc}\u{df}\u{e9}\u{e8}\u{ea}\u{e7}\u{f1}\u{e5}\u{f8}\u{161}?@|~\u{152}\u{153}\u{c6}\u{e6}\u{141}\u{142}\u{144}";
        for c in known.chars().chain(names.chars()).map(|c| parted(c).0) {
            assert_ne!(glyph(c).1, tofu, "{c} has no glyph");
        }
    }

    #[test]
    fn an_accent_stands_over_its_letter() {
        let (plain, accented) = (strokes("u", 6.0), strokes("\u{fc}", 6.0));
        assert_eq!((accented.len(), width("\u{fc}", 6.0)), (plain.len() + 2, width("u", 6.0)));
        let top = plain.iter().flatten().map(|p| p.y).fold(0.0, f64::max);
        let w = width("u", 6.0);
        assert!(accented[plain.len()..].iter().flatten().all(|p| p.y > top && p.x > 0.0 && p.x < w));
        let capital = strokes("\u{dc}", 6.0);
        assert!(capital.iter().flatten().map(|p| p.y).fold(0.0, f64::max) > 6.0);
    }

    #[test]
    fn strokes_stay_inside_the_stated_box() {
        let text = "Hqg(0)";
        let w = width(text, 12.0);
        for p in strokes(text, 12.0).iter().flatten() {
            assert!(p.x >= -1e-9 && p.x <= w + 2.0 && p.y >= -4.0 && p.y <= 14.5, "{p}");
        }
    }
}
