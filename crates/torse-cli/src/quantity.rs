//! Lengths and times as people write them: `2mm`, `1/16 in`, `60s`. A bare number is refused, because a tolerance in
//! the wrong unit costs material.

use std::time::Duration;
use torse::geom::{unit, Vec3};
use torse::pipeline::workshop::Stations;
use torse::torse::zone::Zone;

/// A length given on the command line.
#[derive(Clone, Debug, PartialEq)]
pub struct Length {
    /// Its size in millimetres.
    pub mm: f64,
    /// As it was written.
    pub text: String,
}

/// The length of a unit, mm; inches and feet have signs of their own on a command line.
fn size_of_unit(name: &str) -> Result<f64, String> {
    match name.trim() {
        "\"" => unit::millimetres("in"),
        "'" => unit::millimetres("ft"),
        name => unit::millimetres(name),
    }
    .ok_or_else(|| format!("unknown unit '{name}': use mm, cm, m, in or ft"))
}

/// Unit names and their length in seconds.
const TIME_UNITS: &[(&str, f64)] = &[("ms", 1e-3), ("s", 1.0), ("sec", 1.0), ("min", 60.0), ("h", 3600.0)];

/// Longest time limit: a year. Beyond it the number is a typing error.
const LONGEST_LIMIT: f64 = 3.2e7;

/// Splits `2.5mm` into number and unit. Fractions of the workshop (`1/16in`) are understood.
fn split(text: &str) -> Result<(f64, &str), String> {
    let text = text.trim();
    // The unit is what follows the last digit or point; an exponent (1e-3) is part of the number.
    let end = text.rfind(|c: char| c.is_ascii_digit() || c == '.' || c == ',').map_or(0, |i| i + 1);
    let (number, unit) = (text[..end].trim(), text[end..].trim());
    if number.is_empty() {
        return Err(if text.is_empty() {
            "nothing is given".to_string()
        } else {
            "there is no number in it".to_string()
        });
    }
    if number.contains(',') {
        return Err("write a decimal point instead of the comma".to_string());
    }
    let parse = |s: &str| s.trim().parse::<f64>().map_err(|_| format!("'{number}' is not a number"));
    let value = match number.split_once('/') {
        Some((a, b)) => parse(a)? / parse(b)?,
        None => parse(number)?,
    };
    if !value.is_finite() {
        return Err(format!("'{number}' is not a finite number"));
    }
    Ok((value, unit))
}

/// Reads a length that must be positive.
pub fn positive_length(text: &str) -> Result<Length, String> {
    let (value, unit) = split(text)?;
    if unit.is_empty() {
        return Err(if value > 0.0 {
            format!("it has no unit, and guessing one could ruin material: write {value}mm (or cm, m, in, ft)")
        } else {
            "it must be greater than zero, and have a unit".to_string()
        });
    }
    let mm = value * size_of_unit(unit)?;
    if mm <= 0.0 || !mm.is_finite() {
        return Err("it must be greater than zero".to_string());
    }
    Ok(Length { mm, text: text.trim().to_string() })
}

/// Reads the sides of a sheet, in mm: two lengths with an x between them. A unit after the second is that of both; where
/// there is none, both are millimetres, as sheets are named.
pub fn sheet(text: &str) -> Result<[f64; 2], String> {
    let example = "write two lengths, such as 1250x2550 (mm), 1.25mx2.55m or 4ftx8ft";
    let (first, second) = text.trim().split_once(['x', 'X', '×']).ok_or_else(|| format!("'{text}': {example}"))?;
    let (value, unit) = split(second)?;
    let unit = if unit.is_empty() { "mm" } else { unit };
    let other = split(first)?;
    let other_unit = if other.1.is_empty() { unit } else { other.1 };
    Ok([positive_length(&format!("{}{other_unit}", other.0))?.mm, positive_length(&format!("{value}{unit}"))?.mm])
}

/// Reads the number of an entity, with or without its sign: #17.
pub fn entity(text: &str) -> Result<u64, String> {
    let number = text.trim().trim_start_matches('#');
    number.parse().map_err(|_| format!("'{text}' is no number of a face: write it as 'torse info' does, such as #17"))
}

/// A plane square to an axis of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Unit vector of the axis.
    pub axis: Vec3,
    /// Place on the axis, mm.
    pub at: f64,
}

/// Reads a zone: ranges of coordinates such as `x=0mm..1200mm`, separated by commas; axes not named are not bounded.
pub fn zone(text: &str) -> Result<Zone, String> {
    let example = "write ranges of coordinates, such as x=0mm..1200mm or x=0mm..1m,y=-50mm..50mm";
    let mut out = Zone::ALL;
    for part in text.split(',') {
        let (name, range) = part.split_once('=').ok_or_else(|| format!("'{part}': {example}"))?;
        let axis = axis(name).ok_or_else(|| format!("'{}' is no axis: {example}", name.trim()))?.iamax();
        let (from, to) = range.split_once("..").ok_or_else(|| format!("'{range}' is no range: {example}"))?;
        let (from, to) = (place(from)?, place(to)?);
        if from > to {
            return Err(format!("'{range}' ends before it begins"));
        }
        if out.ranges[axis] != Zone::ALL.ranges[axis] {
            return Err(format!("the axis '{}' is given twice", name.trim()));
        }
        out.ranges[axis] = (from, to);
    }
    Ok(out)
}

/// Reads a place on an axis: a length with or without a sign; nought needs no unit.
fn place(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let (sign, size) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
    let is_nought = split(size).is_ok_and(|(value, _)| value == 0.0);
    Ok(if is_nought { 0.0 } else { sign * positive_length(size)?.mm })
}

/// Reads a plane such as `x=1200mm`.
pub fn section(text: &str) -> Result<Section, String> {
    let example = "write an axis and a length, such as x=1200mm";
    let (name, at) = text.split_once('=').ok_or_else(|| format!("'{text}': {example}"))?;
    let axis = axis(name).ok_or_else(|| format!("'{}' is no axis: {example}", name.trim()))?;
    Ok(Section { axis, at: place(at)? })
}

/// Reads planes: `x=500mm`, `x=0mm..6m/500mm` (from, to, step), `x=0mm../500mm` (from there on), or all multiples of a step across
/// the model: `x=../500mm`, `x=500mm..` or `x=500mm..step`.
pub fn stations(text: &str) -> Result<Stations, String> {
    let example = "write x=500mm (one plane), x=0mm..6m/500mm (from, to, step) or x=500mm.. (every 500 mm)";
    let (name, places) = text.split_once('=').ok_or_else(|| format!("'{text}': {example}"))?;
    let normal = axis(name).ok_or_else(|| format!("'{}' is no axis: {example}", name.trim()))?;
    let name = name.trim().to_lowercase();
    let multiples = |step: f64| (f64::NEG_INFINITY, f64::INFINITY, step);
    let named = |(from, to, step): (f64, f64, f64)| Stations { normal, name: name.clone(), from, to, step };
    let Some((range, step)) = separated(places, example)? else {
        let Some((step, end)) = places.split_once("..") else {
            let at = place(places).map_err(|e| format!("{e}; {example}"))?;
            return Ok(named((at, at, 1.0)));
        };
        // A range without a step: who gives one length means every so many.
        return match (step.trim(), end.trim()) {
            ("", "" | "step") => Err(format!("'{places}' has no step: {example}")),
            (step, "" | "step") => {
                let step = positive_length(step).map_err(|e| format!("{e}; {example}"))?;
                Ok(named(multiples(step.mm)))
            }
            (from, to) => Err(format!("'{from}..{to}' has no step; write it behind: {name}={from}..{to}/500mm")),
        };
    };
    let (from, to) = range.split_once("..").ok_or_else(|| format!("'{range}' is no range: {example}"))?;
    let end = |text: &str, open: f64| if text.trim().is_empty() { Ok(open) } else { place(text) };
    let (from, to) = (end(from, f64::NEG_INFINITY)?, end(to, f64::INFINITY)?);
    if from > to {
        return Err(format!("'{range}' runs backwards: {example}"));
    }
    let step = positive_length(step).map_err(|e| format!("{e}; {example}"))?;
    Ok(named((from, to, step.mm)))
}

/// A range and its step, which follows a slash; slashes of fractions are before a unit.
fn separated<'a>(places: &'a str, example: &str) -> Result<Option<(&'a str, &'a str)>, String> {
    let Some(dots) = places.find("..") else {
        let step = places.rsplit_once('/').filter(|(at, _)| place(at).is_ok());
        return match step {
            Some((at, step)) => Err(format!("'{at}' is one plane, and has no step '{step}': {example}")),
            None => Ok(None),
        };
    };
    let behind = &places[dots + 2..];
    // Of 1/2in/1/4in the slash in the middle.
    let of = |at: usize| (&places[..dots + 2 + at], &behind[at + 1..]);
    let is_end = |text: &str| text.trim().is_empty() || place(text).is_ok();
    let mut slashes = behind.match_indices('/').map(|(at, _)| at);
    Ok(slashes.find(|at| is_end(&behind[..*at])).map(of))
}

/// Reads a direction: an axis with or without a sign, or three numbers.
pub fn direction(text: &str) -> Result<Vec3, String> {
    let text = text.trim();
    if let Some(d) = axis(text) {
        return Ok(d);
    }
    let numbers: Option<Vec<f64>> = text.split(',').map(|w| w.trim().parse::<f64>().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) if [x, y, z].iter().all(|v| v.is_finite()) && Vec3::new(x, y, z).norm() > 0.0 => {
            Ok(Vec3::new(x, y, z).normalize())
        }
        _ => Err(format!("'{text}' is no direction: write x, y, z or three numbers, such as 1,0,0.5")),
    }
}

/// The unit vector of an axis by its name.
fn axis(name: &str) -> Option<Vec3> {
    match name.trim() {
        "x" | "X" => Some(Vec3::x()),
        "y" | "Y" => Some(Vec3::y()),
        "z" | "Z" => Some(Vec3::z()),
        _ => None,
    }
}

/// Reads the name of a unit of length; the answer is its size in mm.
pub fn unit_of_length(text: &str) -> Result<f64, String> {
    size_of_unit(text)
}

/// Reads two numbers, separated by a comma.
pub fn two_numbers(text: &str) -> Result<[f64; 2], String> {
    let number = |s: &str| match s.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("'{s}' is not a finite number")),
    };
    let (a, b) = text.split_once(',').ok_or_else(|| format!("'{text}': write two numbers, for example 1.4,1.3"))?;
    Ok([number(a)?, number(b)?])
}

/// Reads two shares between 0 and 1, separated by a comma.
pub fn two_shares(text: &str) -> Result<[f64; 2], String> {
    let share = |s: &str| match s.trim().parse::<f64>() {
        Ok(x) if (0.0..=1.0).contains(&x) => Ok(x),
        _ => Err(format!("'{s}' is not a share between 0 and 1")),
    };
    let (a, b) = text.split_once(',').ok_or_else(|| format!("'{text}': write two shares, for example 0.25,0.3"))?;
    Ok([share(a)?, share(b)?])
}

/// Reads a time that must be positive.
pub fn positive_time(text: &str) -> Result<Duration, String> {
    let (value, unit) = split(text)?;
    if unit.is_empty() {
        return Err(format!("it has no unit: write {value}s (or min, h)"));
    }
    let Some(&(_, size)) = TIME_UNITS.iter().find(|(name, _)| unit.eq_ignore_ascii_case(name)) else {
        return Err(format!("unknown unit '{unit}': use s, min or h"));
    };
    let seconds = value * size;
    if seconds <= 0.0 {
        return Err("it must be greater than zero".to_string());
    }
    if seconds > LONGEST_LIMIT {
        return Err("it is more than a year".to_string());
    }
    Ok(Duration::from_secs_f64(seconds))
}

/// Reads a whole number of at least 1.
pub fn positive_count(text: &str) -> Result<u32, String> {
    match text.trim().parse::<u32>() {
        Ok(0) => Err("it must be at least 1".to_string()),
        Ok(n) => Ok(n),
        Err(_) if text.trim().starts_with('-') => Err("it must be at least 1".to_string()),
        Err(_) => Err(format!("it is not a whole number up to {}", u32::MAX)),
    }
}

/// Reads a positive share, such as 1e-6.
pub fn positive_share(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err("it must be a positive number without a unit, such as 1e-6".into()),
    }
}

/// Angle of a smooth edge in degrees, at least 0 and below 90.
pub fn smooth_angle(text: &str) -> Result<f64, String> {
    match text.trim().trim_end_matches("deg").trim_end().parse::<f64>() {
        Ok(degrees) if (0.0..90.0).contains(&degrees) => Ok(degrees),
        _ => Err("it must be a number of degrees from 0 to less than 90, such as 0.5".into()),
    }
}

/// Turn between bend lines in degrees.
pub fn bend_step(text: &str) -> Result<f64, String> {
    match text.trim().trim_end_matches("deg").trim_end().parse::<f64>() {
        Ok(degrees) if (0.01..=90.0).contains(&degrees) => Ok(degrees),
        _ => Err("it must be an angle from 0.01deg to 90deg, such as 5deg".into()),
    }
}

/// Centre and radius of a ball: four numbers, the last one positive.
pub fn ball(text: &str) -> Result<[f64; 4], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|w| w.trim().parse::<f64>().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z, r]) if [x, y, z, r].iter().all(|v| v.is_finite()) && r > 0.0 => Ok([x, y, z, r]),
        _ => Err("four numbers X,Y,Z,R with a positive radius R are needed, such as 0,0,0,500".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_one_or_many() {
        let of = |text: &str| stations(text).map(|s| (s.name.clone(), s.from, s.to, s.step));
        assert_eq!(of("x=500mm"), Ok(("x".into(), 500.0, 500.0, 1.0)));
        assert_eq!(of("Z=-1m..2m/25cm"), Ok(("z".into(), -1000.0, 2000.0, 250.0)));
        assert_eq!(of("y=../1in"), Ok(("y".into(), f64::NEG_INFINITY, f64::INFINITY, 25.4)));
        assert_eq!(of("y=0../1m"), Ok(("y".into(), 0.0, f64::INFINITY, 1000.0)));
        let every = Ok(("x".into(), f64::NEG_INFINITY, f64::INFINITY, 500.0));
        assert_eq!([of("x=500mm.."), of("x=500mm..step"), of("x = ../500mm")], [every.clone(), every.clone(), every]);
        assert_eq!(of("z=1/4in..1/2in/1/8in"), Ok(("z".into(), 6.35, 12.7, 3.175)));
        for bad in
            ["x", "w=1mm", "x=1", "x=2m..1m/1mm", "x=1mm/1mm", "x=../0mm", "x=../-1mm", "x=..", "x=0mm..", "x=..1m"]
        {
            assert!(stations(bad).is_err(), "{bad}");
        }
        for (bad, words) in [
            ("x=0mm..6m", "x=0mm..6m/500mm"),
            ("x=..step", "has no step"),
            ("x=500mm/100mm", "is one plane"),
            ("x=500..", "500mm"),
        ] {
            let said = stations(bad).expect_err(bad);
            assert!(said.contains(words), "{said}");
        }
    }

    #[test]
    fn sheets_have_two_sides_and_one_unit_or_two() {
        assert_eq!(sheet("1250x2550"), Ok([1250.0, 2550.0]));
        assert_eq!(sheet("1.25 x 2.5 m"), Ok([1250.0, 2500.0]));
        assert_eq!(sheet("4ftx8ft"), Ok([1219.2, 2438.4]));
        assert!(sheet("1250").is_err() && sheet("0x100").is_err() && sheet("1x2x3").is_err() && sheet("axb").is_err());
    }

    #[test]
    fn entities_may_carry_their_sign() {
        assert_eq!((entity("#17"), entity("17")), (Ok(17), Ok(17)));
        assert!(entity("face").is_err());
    }

    #[test]
    fn planes_and_directions_are_understood() {
        assert_eq!(section("x=1.2m"), Ok(Section { axis: Vec3::x(), at: 1200.0 }));
        assert_eq!(section(" Z = -5mm"), Ok(Section { axis: Vec3::z(), at: -5.0 }));
        assert_eq!(section("y=0"), Ok(Section { axis: Vec3::y(), at: 0.0 }));
        assert_eq!(section("z=0mm"), Ok(Section { axis: Vec3::z(), at: 0.0 }));
        for bad in ["x", "w=3mm", "x=12", "x=--3mm", "x=NaN", "=3mm"] {
            assert!(section(bad).is_err(), "{bad}");
        }
        assert_eq!(direction("y"), Ok(Vec3::y()));
        assert_eq!(direction("0,-2,0"), Ok(-Vec3::y()));
        for bad in ["", "1,0", "0,0,0", "inf,0,0", "north"] {
            assert!(direction(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn zones_are_understood() {
        let slab = zone("y=-5cm..1m").expect("a slab");
        assert_eq!(slab, Zone::slab(1, -50.0, 1000.0));
        let cube = zone("x=0..1mm, z=0mm..2mm,y=3mm..3mm").expect("a box");
        assert_eq!(cube.ranges, [(0.0, 1.0), (3.0, 3.0), (0.0, 2.0)]);
        for bad in ["", "x", "x=1mm", "x=2mm..1mm", "x=1..2", "w=1mm..2mm", "x=0..1mm,x=0..2mm", "x=0..nanmm"] {
            assert!(zone(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn units_are_understood() {
        for (text, mm) in [
            ("2mm", 2.0),
            (" 2 mm ", 2.0),
            ("1e-3m", 1.0),
            (".5cm", 5.0),
            ("2.MM", 2.0),
            ("1in", 25.4),
            ("1/16 in", 25.4 / 16.0),
            ("2\"", 50.8),
            ("1ft", 304.8),
        ] {
            let got = positive_length(text).expect(text).mm;
            assert!((got - mm).abs() <= 1e-12 * mm, "{text}: {got}");
        }
    }

    #[test]
    fn doubtful_lengths_are_refused_with_the_reason() {
        for (text, reason) in [
            ("2", "no unit"),
            ("0", "greater than zero"),
            ("mm", "no number"),
            ("", "nothing"),
            ("0mm", "greater than zero"),
            ("-1mm", "greater than zero"),
            ("2 parsec", "unknown unit"),
            ("0,5mm", "decimal point"),
            ("1e999m", "finite"),
            ("1/0in", "finite"),
            ("two2mm", "not a number"),
            ("nanmm", "no number"),
        ] {
            let message = positive_length(text).expect_err(text);
            assert!(message.contains(reason), "{text}: {message}");
        }
    }

    #[test]
    fn units_and_shares_are_understood() {
        assert!((unit_of_length("M").expect("metre") - 1000.0).abs() < 1e-12);
        assert!(unit_of_length("league").is_err());
        assert_eq!(two_shares("0.25, 1").expect("shares"), [0.25, 1.0]);
        assert!((smooth_angle("0.5").expect("degrees") - 0.5).abs() < 1e-15);
        assert!(smooth_angle("2 deg").is_ok() && smooth_angle("-1").is_err() && smooth_angle("nan").is_err());
        assert!(two_shares("0.5").is_err() && two_shares("0.5,2").is_err() && two_shares("nan,0").is_err());
    }

    #[test]
    fn times_are_understood() {
        assert_eq!(positive_time("60s").expect("time"), Duration::from_secs(60));
        assert_eq!(positive_time("1.5 min").expect("time"), Duration::from_secs(90));
        assert!(positive_time("60").expect_err("bare").contains("unit"));
        assert!(positive_time("1e300h").expect_err("long").contains("year"));
    }
}
