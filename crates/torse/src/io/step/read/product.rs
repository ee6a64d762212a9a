//! Which faces a file holds and where its assemblies put them: representations, relationships, mapped items.

use super::curves::Geometry;
use super::records::{as_reference, Args, Fault, Records};
use super::token::Value;
use super::units;
use super::walk::{Census, Child, Here, Walk, DEEPEST_ASSEMBLY, MOST_OCCURRENCES, MOST_STEPS};
use crate::answer::note::reader::ReaderNote;
use crate::geom::placement::Placement;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Follows every representation of a file down to its faces.
pub(super) fn census(records: &Records) -> Census {
    let mut w = Walk {
        records,
        group: HashMap::new(),
        members: HashMap::new(),
        children: HashMap::new(),
        part: HashMap::new(),
        units_of: HashMap::new(),
        visited: HashSet::new(),
        shown: HashMap::new(),
        filled: HashSet::new(),
        copies: 0,
        repeats_count: true,
        steps: 0,
        bodies: 0,
        body: 0,
        out: Census::default(),
    };
    w.name_parts();
    w.relate();
    w.walk_roots();
    w.strays();
    w.out
}

/// Whether `#id` is a representation: its last keyword says so, and it has items and a context.
fn is_representation(name: &str) -> bool {
    name.ends_with("REPRESENTATION")
        && !matches!(
            name,
            "SHAPE_DEFINITION_REPRESENTATION"
                | "PROPERTY_DEFINITION_REPRESENTATION"
                | "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"
                | "DEFINITIONAL_REPRESENTATION"
                | "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION"
                | "DRAUGHTING_MODEL"
        )
}

impl<'r, 'a> Walk<'r, 'a> {
    /// Names of parts by representation.
    fn name_parts(&mut self) {
        for id in self.records.all(&["PRODUCT"]) {
            if let Ok(a) = self.records.args(id, "PRODUCT") {
                self.out.products.push(product_name(&a));
            }
        }
        for id in self.records.all(&["SHAPE_DEFINITION_REPRESENTATION"]) {
            let Ok(a) = self.records.simple(id) else { continue };
            let (Ok(shape), Ok(rep)) = (a.reference(0), a.reference(1)) else { continue };
            if let Some(name) = self.product_of_shape(shape) {
                self.part.entry(rep).or_insert(name);
            }
        }
    }

    /// Product definition that a shape describes.
    fn definition_of_shape(&self, shape: u64) -> Option<u64> {
        self.records.args(shape, "PRODUCT_DEFINITION_SHAPE").ok()?.reference(2).ok()
    }

    fn product_of_shape(&self, shape: u64) -> Option<String> {
        let definition = self.records.simple(self.definition_of_shape(shape)?).ok()?;
        let formation = self.records.simple(definition.reference(2).ok()?).ok()?;
        let product = self.records.args(formation.reference(2).ok()?, "PRODUCT").ok()?;
        Some(product_name(&product))
    }

    pub(super) fn is_drawing(&self, rep: u64) -> bool {
        self.records.get(rep).is_ok_and(|r| r.part("DRAUGHTING_MODEL").is_some())
    }

    /// Items and context of a representation: they stand in the part with the list. `None` for what only sounds like
    /// one, such as the link between a dimension and its value.
    fn items(&self, rep: u64) -> Option<Args<'r, 'a>> {
        let parts = &self.records.get(rep).ok()?.parts;
        let body = parts.iter().find(|p| matches!(p.args.get(1), Some(Value::List(_))))?;
        Some(Args { id: rep, values: &body.args })
    }

    pub(super) fn find(&self, rep: u64) -> u64 {
        let mut r = rep;
        // Chains of groups are shortened by `join`; the bound is the number of representations.
        for _ in 0..=self.group.len() {
            match self.group.get(&r) {
                Some(&g) if g != r => r = g,
                _ => break,
            }
        }
        r
    }

    /// Groups representations of one space and collects the edges of the assembly.
    fn relate(&mut self) {
        // A drawing of the model shows what others hold.
        let shape = |id: &u64| is_representation(self.records.name(*id)) && !self.is_drawing(*id);
        let reps: Vec<u64> = self.records.order.iter().copied().filter(shape).collect();
        let parents = self.parents();
        // Several representations of one shape share its space.
        let shapes: BTreeMap<u64, Vec<u64>> = self.representations().into_iter().collect();
        shapes.values().flat_map(|all| all.windows(2)).for_each(|w| self.share(w[0], w[1]));
        let relations = self.records.all(&[
            "SHAPE_REPRESENTATION_RELATIONSHIP",
            "REPRESENTATION_RELATIONSHIP",
            "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION",
        ]);
        let mut placed = Vec::new();
        for id in relations {
            let Ok(record) = self.records.get(id) else { continue };
            let with = record.part("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION");
            let plain = ["REPRESENTATION_RELATIONSHIP", "SHAPE_REPRESENTATION_RELATIONSHIP"];
            // Written on its own, the transformation stands behind both ends.
            let base = plain.iter().find_map(|name| record.part(name)).or(with);
            let Some(base) = base else { continue };
            let ends: Vec<u64> = base.args.iter().filter_map(as_reference).collect();
            let &[one, two, ..] = ends.as_slice() else { continue };
            match with {
                Some(t) => match t.args.iter().rev().find_map(as_reference) {
                    Some(t) => placed.push((id, one, two, Some(t))),
                    None => self.out.faults.push(Fault::new(id, format!("#{id} names no transformation"))),
                },
                // A part that is used where it was drawn.
                None if parents.contains_key(&id) => placed.push((id, one, two, None)),
                None => self.share(one, two),
            }
        }
        for r in reps {
            let g = self.find(r);
            self.members.entry(g).or_default().push(r);
        }
        for (id, one, two, transformation) in placed {
            if let Err(fault) = self.place(one, two, transformation, parents.get(&id).copied()) {
                self.out.faults.push(fault);
            }
        }
    }

    /// Two representations of one space.
    fn share(&mut self, one: u64, two: u64) {
        let (a, b) = (self.find(one), self.find(two));
        self.group.insert(a, a);
        self.group.insert(b, a);
    }

    /// One edge of the assembly: representation `one` placed in `two`, or the other way round; without a transformation where
    /// it was drawn.
    fn place(&mut self, one: u64, two: u64, transformation: Option<u64>, assembly: Option<u64>) -> Result<(), Fault> {
        let reversed = assembly.is_some_and(|parent| {
            let parent = self.find(parent);
            self.find(one) == parent && self.find(two) != parent
        });
        let (child, parent) = if reversed { (two, one) } else { (one, two) };
        let Some(transformation) = transformation else {
            // Already in the same space it is there.
            if self.find(child) != self.find(parent) {
                self.add_child(parent, Child { representation: child, placement: Placement::identity() });
            }
            return Ok(());
        };
        let r = self.records.get(transformation)?;
        let placement = if r.part("ITEM_DEFINED_TRANSFORMATION").is_some() {
            let a = self.records.args(transformation, "ITEM_DEFINED_TRANSFORMATION")?;
            let items = [a.reference(2)?, a.reference(3)?];
            // The first item is one of representation `one`, the second of `two`, but some writers exchange them: where
            // the representations list them, that decides.
            let lists = |rep: u64, item: u64| {
                self.items(rep).and_then(|a| a.references(1).ok()).is_some_and(|l| l.contains(&item))
            };
            let exchanged =
                lists(one, items[1]) && lists(two, items[0]) && !(lists(one, items[0]) && lists(two, items[1]));
            let [in_one, in_two] = if exchanged { [items[1], items[0]] } else { items };
            let (u1, u2) = (self.units_index(one), self.units_index(two));
            let first = self.geometry(u1).placement(in_one)?;
            let second = self.geometry(u2).placement(in_two)?;
            let (from, to) = if reversed { (second, first) } else { (first, second) };
            let back = from
                .inverse()
                .ok_or_else(|| Fault::new(transformation, format!("#{transformation} cannot be inverted")))?;
            to.after(&back)
        } else {
            let u = self.units_index(parent);
            self.geometry(u).placement(transformation)?
        };
        self.add_child(parent, Child { representation: child, placement });
        Ok(())
    }

    /// What the group of a representation holds besides.
    fn add_child(&mut self, parent: u64, child: Child) {
        let group = self.find(parent);
        self.children.entry(group).or_default().push(child);
    }

    /// The representations of shapes of every product definition.
    fn representations(&self) -> HashMap<u64, Vec<u64>> {
        let mut shown: HashMap<u64, Vec<u64>> = HashMap::new();
        for s in self.records.all(&["SHAPE_DEFINITION_REPRESENTATION"]) {
            let Ok(a) = self.records.simple(s) else { continue };
            let (Ok(shape), Ok(rep)) = (a.reference(0), a.reference(1)) else { continue };
            if let Some(definition) =
                self.definition_of_shape(shape).filter(|_| is_representation(self.records.name(rep)))
            {
                shown.entry(definition).or_default().push(rep);
            }
        }
        shown
    }

    /// The usage occurrence that something in context belongs to.
    fn usage_of(&self, context: u64) -> Option<u64> {
        self.definition_of_shape(self.records.simple(context).ok()?.reference(1).ok()?)
    }

    /// Uses of parts with faces that nothing places: a part with one of them only is read where it was drawn, else uses are
    /// missed.
    fn unplaced_usages(&mut self) {
        let contexts = self.records.all(&["CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"]);
        let placed: HashSet<u64> = contexts.into_iter().filter_map(|c| self.usage_of(c)).collect();
        let shown = self.representations();
        let maps = self.records.all(&["REPRESENTATION_MAP"]);
        let copied = maps.into_iter().filter_map(|m| self.records.simple(m).ok()?.reference(1).ok());
        let copied: HashSet<u64> = copied.map(|r| self.find(r)).collect();
        let mut uses: HashMap<u64, Vec<u64>> = HashMap::new();
        for usage in self.records.all(&["NEXT_ASSEMBLY_USAGE_OCCURRENCE"]) {
            let related = self.records.simple(usage).ok().and_then(|a| a.reference(4).ok());
            let Some(&rep) = related.and_then(|d| shown.get(&d)?.first()) else { continue };
            let group = self.find(rep);
            if self.filled.contains(&group) && !copied.contains(&group) {
                uses.entry(group).or_default().push(usage);
            }
        }
        let mut uses: Vec<(u64, Vec<u64>)> = uses.into_iter().collect();
        uses.sort_unstable();
        for (group, usages) in uses {
            let places = self.children.values().flatten().filter(|c| self.find(c.representation) == group).count();
            if usages.len() <= places {
                continue;
            }
            let name = self.members.get(&group).and_then(|all| all.iter().find_map(|m| self.part.get(m)));
            if usages.len() == 1 {
                self.out.notes.push(ReaderNote::Unplaced { part: name.cloned() });
                continue;
            }
            let name = name.map_or("a part", String::as_str);
            let fault = |u: u64| Fault::new(u, format!("nothing says where this use of {name} goes"));
            self.out.faults.extend(usages.into_iter().filter(|u| !placed.contains(u)).map(fault));
        }
    }

    /// The representation of the assembly that each relationship belongs to, from the usage occurrences.
    fn parents(&self) -> HashMap<u64, u64> {
        let shown = self.representations();
        let parent = |context: u64| -> Option<(u64, u64)> {
            let relation = self.records.simple(context).ok()?.reference(0).ok()?;
            let usage = self.records.simple(self.usage_of(context)?).ok()?;
            Some((relation, *shown.get(&usage.reference(3).ok()?)?.first()?))
        };
        self.records.all(&["CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"]).into_iter().filter_map(parent).collect()
    }

    pub(super) fn geometry<'s>(&'s self, units: usize) -> Geometry<'s, 'a> {
        Geometry { records: self.records, units: &self.out.units[units] }
    }

    /// Units of a representation's context, by index.
    pub(super) fn units_index(&mut self, rep: u64) -> usize {
        let context = self.items(rep).and_then(|a| a.reference(2).ok()).unwrap_or(0);
        if let Some(&i) = self.units_of.get(&context) {
            return i;
        }
        let u = units::of_context(self.records, context);
        let i = self.out.units.len();
        self.out.units.push(u);
        self.units_of.insert(context, i);
        i
    }

    /// Starts at every group that nothing contains.
    fn walk_roots(&mut self) {
        let mut inner: HashSet<u64> = self.children.values().flatten().map(|c| self.find(c.representation)).collect();
        // Representations that are only mapped into others are not roots either.
        for id in self.records.all(&["REPRESENTATION_MAP"]) {
            if let Some(r) = self.records.simple(id).ok().and_then(|a| a.reference(1).ok()) {
                inner.insert(self.find(r));
            }
        }
        let mut roots: Vec<u64> = self.members.keys().copied().filter(|g| !inner.contains(g)).collect();
        if roots.is_empty() {
            if !self.members.is_empty() {
                self.out.notes.push(ReaderNote::NoTop);
            }
            roots = self.members.keys().copied().collect();
        }
        // Parts and assemblies first: what else shows the same solids (materials, validation) adds nothing.
        let described = |w: &Self, g: u64| {
            w.children.contains_key(&g) || w.members.get(&g).is_some_and(|m| m.iter().any(|r| w.part.contains_key(r)))
        };
        roots.sort_unstable_by_key(|&g| (!described(self, g), g));
        for g in roots {
            self.repeats_count = described(self, g);
            self.walk(g, &Placement::identity(), "", 0);
        }
        self.unplaced_usages();
    }

    pub(super) fn walk(&mut self, group: u64, placement: &Placement, part: &str, depth: u32) {
        self.steps += 1;
        if depth > DEEPEST_ASSEMBLY || self.steps > MOST_STEPS || self.out.occurrences.len() > MOST_OCCURRENCES {
            if self.out.faults.last().is_none_or(|f| f.entity != group) {
                self.out.faults.push(Fault::new(group, "the assembly contains itself or is too large"));
            }
            return;
        }
        let outer = self.body;
        self.begin_body();
        let before = self.out.occurrences.len();
        let members = self.members.get(&group).cloned().unwrap_or_default();
        let name = members.iter().find_map(|m| self.part.get(m)).cloned().unwrap_or_else(|| part.to_string());
        // What several representations of one space list is there once.
        let mut listed = HashSet::new();
        for m in members {
            let units = self.units_index(m);
            let Some(items) = self.items(m) else {
                // A shape whose items cannot be read may have held faces.
                if self.records.name(m).ends_with("SHAPE_REPRESENTATION") {
                    self.out.faults.push(Fault::new(m, format!("the shape representation #{m} lists no items")));
                }
                continue;
            };
            let items = items.references(1).unwrap_or_default();
            for item in items.into_iter().filter(|i| listed.insert(*i)) {
                self.item(item, Here { flipped: false, units, placement, part: &name, depth, of_faces: false });
            }
        }
        let children: Vec<(u64, Placement)> = self
            .children
            .get(&group)
            .map_or(Vec::new(), |c| c.iter().map(|c| (c.representation, c.placement)).collect());
        for (rep, inner) in children {
            self.walk(self.find(rep), &placement.after(&inner), &name, depth + 1);
        }
        if self.out.occurrences.len() > before {
            self.filled.insert(group);
        }
        self.body = outer;
    }

    /// What follows belongs to a body of its own.
    pub(super) fn begin_body(&mut self) {
        self.bodies += 1;
        self.body = self.bodies;
    }
}

fn product_name(a: &Args) -> String {
    let name = a.text(1);
    if name.is_empty() { a.text(0) } else { name }.to_string()
}
