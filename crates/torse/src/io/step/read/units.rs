//! Units of a representation context.

use super::records::{as_number, as_reference, Fault, Records};
use super::token::Value;

/// Factors from the numbers of a file to millimetres and radians.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Units {
    /// Millimetres per length unit.
    pub length: f64,
    /// Radians per plane angle unit.
    pub angle: f64,
    /// Name of the length unit, empty if none is given.
    pub name: String,
    /// Distance (mm) below which the context calls points the same; 0 if it does not say.
    pub uncertainty: f64,
    /// What is wrong with a unit that the context assigns: sizes are not known then.
    pub fault: Option<Fault>,
}

impl Default for Units {
    fn default() -> Self {
        Self { length: 1.0, angle: 1.0, name: String::new(), uncertainty: 0.0, fault: None }
    }
}

/// Millimetres in a metre.
const MILLIMETRES: f64 = 1e3;

/// The SI units that are known, and their multiples with powers of ten.
const METRE: &str = "METRE";
const RADIAN: &str = "RADIAN";
const PREFIXES: [(&str, i32); 16] = [
    ("EXA", 18),
    ("PETA", 15),
    ("TERA", 12),
    ("GIGA", 9),
    ("MEGA", 6),
    ("KILO", 3),
    ("HECTO", 2),
    ("DECA", 1),
    ("DECI", -1),
    ("CENTI", -2),
    ("MILLI", -3),
    ("MICRO", -6),
    ("NANO", -9),
    ("PICO", -12),
    ("FEMTO", -15),
    ("ATTO", -18),
];

/// Units of conversions in units of conversions…: real files have one step.
const DEEPEST_CONVERSION: usize = 6;

/// The units that the context `#id` assigns; what is not assigned stays millimetre and radian.
pub(super) fn of_context(records: &Records, id: u64) -> Units {
    let mut out = Units { uncertainty: uncertainty(records, id), ..Units::default() };
    let Ok(args) = records.args(id, "GLOBAL_UNIT_ASSIGNED_CONTEXT") else { return out };
    // In a simple instance the list is the last argument, in a complex one the only.
    let list = args.values.len().saturating_sub(1);
    for unit in args.references(list).unwrap_or_default() {
        let Ok(record) = records.get(unit) else { continue };
        let is = |name: &str| record.part(name).is_some();
        let base = base_name(records, unit, 0);
        let read = |si: &str| factor(records, unit, si, 0);
        if is("LENGTH_UNIT") || (!is("PLANE_ANGLE_UNIT") && base.is_some_and(|b| b.eq_ignore_ascii_case(METRE))) {
            match read(METRE) {
                Ok((factor, name)) => (out.length, out.name) = (MILLIMETRES * factor, name),
                Err(fault) => out.fault = Some(fault),
            }
        } else if is("PLANE_ANGLE_UNIT") || base.is_some_and(|b| b.eq_ignore_ascii_case(RADIAN)) {
            match read(RADIAN) {
                Ok((factor, _)) => out.angle = factor,
                Err(fault) => out.fault = Some(fault),
            }
        }
    }
    out
}

/// The largest of the length uncertainties of a context, mm.
fn uncertainty(records: &Records, context: u64) -> f64 {
    let Ok(args) = records.args(context, "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT") else { return 0.0 };
    let list = args.values.len().saturating_sub(1);
    let one = |id: u64| -> Option<f64> {
        let parts = &records.get(id).ok()?.parts;
        let part = parts.iter().find(|p| p.args.len() >= 2)?;
        let value = part.args.first().and_then(as_number).filter(|x| x.is_finite() && *x > 0.0)?;
        let unit = part.args.get(1).and_then(as_reference)?;
        let (factor, _) = factor(records, unit, METRE, 0).ok()?;
        Some(value * factor * MILLIMETRES)
    };
    args.references(list).unwrap_or_default().into_iter().filter_map(one).fold(0.0, f64::max)
}

/// Name of the SI unit at the end of the conversions.
fn base_name<'a>(records: &Records<'a>, id: u64, depth: usize) -> Option<&'a str> {
    if depth > DEEPEST_CONVERSION {
        return None;
    }
    if let Ok(a) = records.args(id, "SI_UNIT") {
        return match a.values.last() {
            Some(Value::Enumeration(name)) => Some(name),
            _ => None,
        };
    }
    let conversion = records.args(id, "CONVERSION_BASED_UNIT").ok()?;
    let measure = conversion.references(conversion.values.len().checked_sub(1)?).ok();
    let measure =
        measure.and_then(|m| m.first().copied()).or_else(|| conversion.reference(conversion.values.len() - 1).ok())?;
    base_name(records, records.simple(measure).ok()?.reference(1).ok()?, depth + 1)
}

/// Factor to the SI unit `si` and name.
fn factor(records: &Records, id: u64, si: &str, depth: usize) -> Result<(f64, String), Fault> {
    if depth > DEEPEST_CONVERSION {
        return Err(Fault::new(id, format!("the unit #{id} is defined in a circle")));
    }
    if let Ok(a) = records.args(id, "SI_UNIT") {
        let n = a.values.len();
        let word = |k: usize| match n.checked_sub(k).and_then(|i| a.values.get(i)) {
            Some(Value::Enumeration(w)) => *w,
            _ => "",
        };
        let (prefix, name) = (word(2), word(1));
        if !name.eq_ignore_ascii_case(si) {
            let si = si.to_lowercase();
            return Err(Fault::new(id, format!("the unit #{id} is '{}', not a {si}", name.to_lowercase())));
        }
        let power = match PREFIXES.iter().find(|p| prefix.eq_ignore_ascii_case(p.0)) {
            Some((_, power)) => *power,
            None if prefix.is_empty() => 0,
            None => return Err(Fault::new(id, format!("'{prefix}' of the unit #{id} is no prefix of SI units"))),
        };
        return Ok((10.0_f64.powi(power), format!("{prefix}{name}").to_ascii_lowercase()));
    }
    let conversion = records.args(id, "CONVERSION_BASED_UNIT")?;
    let last = conversion.values.len().saturating_sub(1);
    let name = conversion.text(last.saturating_sub(1)).trim().to_lowercase();
    let measure = conversion.reference(last)?;
    let record = records.get(measure)?;
    // LENGTH_MEASURE_WITH_UNIT(value, unit), simple or as a part of a complex instance.
    let part = record
        .parts
        .iter()
        .find(|p| p.args.len() == 2)
        .ok_or_else(|| Fault::new(measure, format!("#{measure} is not a measure")))?;
    let value = part.args.first().and_then(as_number).filter(|x| x.is_finite() && *x > 0.0);
    let value = value.ok_or_else(|| Fault::new(measure, format!("the measure #{measure} is not a positive number")))?;
    let unit = match part.args.get(1) {
        Some(Value::Reference(u)) => *u,
        _ => return Err(Fault::new(measure, format!("the measure #{measure} names no unit"))),
    };
    Ok((value * factor(records, unit, si, depth + 1)?.0, name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn units(data: &str) -> Units {
        let text = format!("DATA;{data}ENDSEC;");
        of_context(&Records::parse(&text).expect("records"), 1)
    }

    #[test]
    fn length_units_in_every_form() {
        let si = |p: &str| {
            units(&format!(
                "#1=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#2,#3))REPRESENTATION_CONTEXT('',''));\
                 #2=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({p},.METRE.));#3=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));"
            ))
        };
        for (p, mm, name) in [(".MILLI.", 1.0, "millimetre"), ("$", 1000.0, "metre"), (".CENTI.", 10.0, "centimetre")] {
            let u = si(p);
            assert!((u.length - mm).abs() < 1e-12 && u.name == name && u.angle == 1.0, "{u:?}");
        }
        let foot = units(
            "#1=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#9,#13)));#6=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\
             #7=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#6);#9=(CONVERSION_BASED_UNIT('INCH',#7)LENGTH_UNIT()NAMED_UNIT(#8));\
             #11=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\
             #12=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.0174532925199433),#11);\
             #13=(CONVERSION_BASED_UNIT('DEGREE',#12)NAMED_UNIT(#5)PLANE_ANGLE_UNIT());",
        );
        assert!((foot.length - 25.4).abs() < 1e-12 && foot.name == "inch");
        assert!((foot.angle - 1f64.to_radians()).abs() < 1e-12);
        let circle = units("#1=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#2)));#2=(CONVERSION_BASED_UNIT('X',#3)LENGTH_UNIT());#3=M(LENGTH_MEASURE(2.),#2);");
        assert!(circle.fault.is_some_and(|f| f.reason.contains("circle")));
    }

    #[test]
    fn words_of_units_are_told_in_any_case_and_unknown_ones_are_faults() {
        let si = |p: &str, of: &str, name: &str| {
            units(&format!("#1=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#2)));#2=({of}()NAMED_UNIT(*)SI_UNIT({p},{name}));"))
        };
        for (p, name) in [(".milli.", ".metre."), (".Milli.", ".METRE."), (".MILLI.", ".Metre.")] {
            let u = si(p, "LENGTH_UNIT", name);
            assert!((u.length - 1.0).abs() < 1e-12 && u.name == "millimetre" && u.fault.is_none(), "{u:?}");
        }
        let reason = |p: &str, of: &str, name: &str| si(p, of, name).fault.expect("a fault").reason;
        assert_eq!(reason(".MILI.", "LENGTH_UNIT", ".METRE."), "'MILI' of the unit #2 is no prefix of SI units");
        assert_eq!(reason(".MILLI.", "LENGTH_UNIT", ".INCH."), "the unit #2 is 'inch', not a metre");
        assert_eq!(reason("$", "PLANE_ANGLE_UNIT", ".DEGREE."), "the unit #2 is 'degree', not a radian");
        // Units of other kinds do not matter.
        assert!(si("$", "SOLID_ANGLE_UNIT", ".STERADIAN.").fault.is_none());
    }
}
