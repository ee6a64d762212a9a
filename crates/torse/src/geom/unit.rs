//! Units of length: those that files are read in, and those in which drawings and figures are written.

/// Square metres in a square millimetre.
pub(crate) const SQUARE_METRES: f64 = 1e-6;

/// A unit of length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LengthUnit {
    /// Millimetre.
    #[default]
    Millimetre,
    /// Inch of 25.4 mm.
    Inch,
}

impl LengthUnit {
    /// Its length, mm.
    pub fn mm(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Inch => 25.4,
        }
    }

    /// Its sign in files and headings.
    pub fn sign(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Inch => "in",
        }
    }

    /// A length in this unit, from mm.
    pub fn of(self, mm: f64) -> f64 {
        mm / self.mm()
    }

    /// Decimals that are as fine as so many of millimetres, or finer.
    pub(crate) fn decimals(self, of_mm: usize) -> usize {
        match self {
            Self::Millimetre => of_mm,
            Self::Inch => of_mm + 2,
        }
    }
}

/// A unit of length that files may name.
#[derive(Debug)]
pub(crate) struct NamedUnit {
    /// Its length, mm.
    pub mm: f64,
    /// Its name, in full.
    pub name: &'static str,
    /// What else it is called, in small letters.
    short: &'static [&'static str],
}

/// The units that files name, once for all readers.
const NAMED: [NamedUnit; 24] = [
    NamedUnit { mm: 1.0, name: "millimetre", short: &["mm", "millimeter", "millimetres"] },
    NamedUnit { mm: 10.0, name: "centimetre", short: &["cm", "centimeter", "centimetres"] },
    NamedUnit { mm: 100.0, name: "decimetre", short: &["dm", "decimeter"] },
    NamedUnit { mm: 1e3, name: "metre", short: &["m", "meter", "metres"] },
    NamedUnit { mm: 1e6, name: "kilometre", short: &["km", "kilometer"] },
    NamedUnit { mm: 1e-3, name: "micrometre", short: &["um", "micron", "micrometer"] },
    NamedUnit { mm: 25.4, name: "inch", short: &["in", "inches"] },
    NamedUnit { mm: 304.8, name: "foot", short: &["ft", "feet"] },
    NamedUnit { mm: 914.4, name: "yard", short: &["yd", "yards"] },
    NamedUnit { mm: 1_609_344.0, name: "mile", short: &["mi", "miles"] },
    NamedUnit { mm: 25.4e-3, name: "mil", short: &["mils", "thou"] },
    NamedUnit { mm: 25.4e-6, name: "microinch", short: &["uin"] },
    NamedUnit { mm: 1e-7, name: "angstrom", short: &[] },
    NamedUnit { mm: 1e-6, name: "nanometre", short: &[] },
    NamedUnit { mm: 1e4, name: "dekametre", short: &[] },
    NamedUnit { mm: 1e5, name: "hectometre", short: &[] },
    NamedUnit { mm: 1e9, name: "megametre", short: &[] },
    NamedUnit { mm: 1e12, name: "gigametre", short: &[] },
    NamedUnit { mm: 25.4 / 72.0, name: "printer point", short: &[] },
    NamedUnit { mm: 25.4 / 6.0, name: "printer pica", short: &[] },
    NamedUnit { mm: 1_852_000.0, name: "nautical mile", short: &[] },
    NamedUnit { mm: 1.495_978_707e14, name: "astronomical unit", short: &[] },
    NamedUnit { mm: 9.460_730_472_580_8e18, name: "light year", short: &[] },
    NamedUnit { mm: 3.085_677_58e19, name: "parsec", short: &[] },
];

/// The unit of a name, in full or short, in small or large letters.
pub(crate) fn named(name: &str) -> Option<&'static NamedUnit> {
    let small = name.trim().to_ascii_lowercase();
    NAMED.iter().find(|u| u.name == small || u.short.contains(&small.as_str()))
}

/// The length of a unit by its name, mm: `mm`, `cm`, `m`, `in`, `ft` and others that have a short name, or their names in full.
///
/// # Example
/// ```
/// use torse::geom::unit::millimetres;
/// assert_eq!((millimetres("Inch"), millimetres("m"), millimetres("ell")), (Some(25.4), Some(1000.0), None));
/// ```
pub fn millimetres(name: &str) -> Option<f64> {
    named(name).filter(|u| !u.short.is_empty()).map(|u| u.mm)
}

/// The length (mm) of the unit of a file that may name one, where the user may name one: the one that is named, `None` where
/// neither is, or they differ, or the name is not known.
pub(crate) fn agreed(said: Option<&str>, given: Option<f64>) -> Option<f64> {
    match said {
        None => given,
        Some(name) => millimetres(name).filter(|own| given.is_none_or(|g| g == *own)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_one_unit() {
        let all = NAMED.iter().flat_map(|u| u.short.iter().chain([&u.name]).map(move |n| (*n, u.mm)));
        for (name, mm) in all {
            assert_eq!(named(&name.to_ascii_uppercase()).map(|u| u.mm), Some(mm), "{name}");
        }
        assert_eq!((millimetres("MM"), millimetres("furlong"), millimetres("parsec")), (Some(1.0), None, None));
        assert_eq!(agreed(Some("in"), Some(1.0)), None);
        assert_eq!((agreed(Some("in"), None), agreed(None, Some(1.0))), (Some(25.4), Some(1.0)));
    }
}
