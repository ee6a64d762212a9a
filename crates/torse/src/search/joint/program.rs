//! One step: the linear changes of all distances and gaps, and the program that chooses it.

use super::columns::Columns;
use super::fleet::Fleet;
use super::form::{Foot, Tie};
use super::line::{slide_functions, slide_knots, LinePoint, SLIDES};
use super::network::{lean, Member, Network};
use crate::geom::Vec3;
use crate::num::minimax_program::{MinimaxProgram, Minimum};
use crate::num::runs::Runs;

/// Samples count where their distance is above this share of their strip's largest.
pub(super) const COUNTS: f64 = 0.3;
/// Samples whose regularity is below this multiple of the least must keep it; the share of what is left that a step may
/// take, and what is left at least.
const ROOM: (f64, f64, f64) = (4.0, 0.8, 0.002);
/// Prices of uneven changes of strips and of slides, and of every unknown: one largest distance stands against the first two of
/// all strips, so these are shares of their sum.
const EVEN: (f64, f64) = (5e-3, 5e-3);
/// See [`EVEN`].
const RIDGE: f64 = 1e-4;
/// Price of the mean square of the logarithms of what widths are of those wanted. The hull at 5 mm: least width of a strip over
/// its median 0.21 without, 0.74 with 1 to 20; with 20 edges are lost, with 5 those of the monkey saddle at 10 mm.
const WIDTHS: f64 = 2.0;

/// Largest distance (tolerances) below which nothing is gained: what is left helps neighbours to become equally high. Processor
/// seconds on a fuselage at 10 mm 11 for 20, on the hull at 5 mm 22 for 28.
pub(super) const LOW_ENOUGH: f64 = 0.85;

/// What a step pays, and how far it goes.
pub(super) struct Prices {
    /// Of gaps along lines.
    pub gaps: f64,
    /// Factor on what damps strips.
    pub damping: f64,
    /// How far lines may slide, as a multiple of their unit's limit.
    pub reach: f64,
}

/// A step and what it should lead to.
pub(super) struct Step {
    /// Unknowns, in tolerances and units of slides.
    pub x: Vec<f64>,
    /// Largest distance and largest gap, tolerances.
    pub expected: [f64; 2],
    /// Newton matrices of the program.
    pub iterations: usize,
}

/// The step for prices and limits.
pub(super) fn step(fleet: &Fleet, columns: &[Columns], prices: &Prices) -> Option<Step> {
    let mut tie = Tie { damping: prices.damping, ..Tie::none() };
    let mut program = distances(fleet, columns, prices.gaps, &mut tie)?;
    columns.iter().for_each(|c| c.slide_limits(prices.reach, &mut program.limits));
    // A distance that nothing changes.
    program.hard.end();
    program.distances.push(LOW_ENOUGH);
    let gaps = tie.price.len();
    let share = (fleet.strips() as f64).recip();
    let (all, knots): (Vec<usize>, _) = ((0..SLIDES).collect(), slide_knots()?);
    for (network, columns) in fleet.networks.iter().zip(columns) {
        for (m, &column) in network.members.iter().zip(&columns.strips) {
            m.strip.damping(column, network.tolerance, &mut tie);
            m.strip.sequences().iter().for_each(|s| tie.uneven(column, s, share * EVEN.0));
        }
        columns.slides.iter().for_each(|&column| tie.uneven(column, &all, share * EVEN.1));
        network.pay_widths(columns, &knots, WIDTHS, &mut tie);
    }
    (program.soft, program.price) = (tie.rows, tie.price);
    let Minimum { x, largest, iterations } = program.solve()?;
    let gap = |i: usize| (program.price[i].1 + program.soft.dot(i, &x)).abs();
    let gap = (0..gaps).map(gap).fold(0.0, f64::max);
    Some(Step { x, expected: [largest, gap], iterations })
}

/// Begins the row that keeps a strip regular at the foot of a point, where little is left; how it changes with the way of the
/// point.
fn keep_regular(
    member: &Member,
    column: usize,
    (x, foot): (&Vec3, &Foot),
    tolerance: f64,
    program: &mut MinimaxProgram,
) -> Option<Vec3> {
    let (room, sign) = member.room(foot);
    if room >= ROOM.0 {
        return None;
    }
    program.room.push(ROOM.1 * room.max(ROOM.2));
    Some(member.strip.regular_row(column, x, foot, -sign * tolerance, &mut program.bounded))
}

/// The program of distances and of what strips must keep; the rows of gaps go to `tie`.
pub(super) fn distances(fleet: &Fleet, columns: &[Columns], weight: f64, tie: &mut Tie) -> Option<MinimaxProgram> {
    let mut program = MinimaxProgram {
        groups: columns.iter().flat_map(|c| c.groups.iter().copied()).collect(),
        limits: columns.iter().flat_map(|c| c.limits.iter().copied()).collect(),
        ridge: RIDGE,
        ..MinimaxProgram::default()
    };
    for (network, columns) in fleet.networks.iter().zip(columns) {
        rows(network, columns, weight, (&mut program, tie))?;
    }
    fleet.meeting_rows(columns, weight, (&mut program, tie));
    Some(program)
}

/// The rows of one face.
fn rows(
    network: &Network,
    columns: &Columns,
    weight: f64,
    (program, tie): (&mut MinimaxProgram, &mut Tie),
) -> Option<()> {
    let tolerance = network.tolerance;
    let knots = slide_knots()?;
    let unit = network.unit / tolerance;
    let ways = |l: usize, p: &LinePoint, direction: &Vec3, out: &mut Runs| {
        let (first, slide) = slide_functions(&knots, p.share);
        let along = unit * direction.dot(&p.slide);
        out.run(columns.slides[l] + first, slide.map(|s| s * along));
        for (v, axes) in network.lines[l].vertex_ways(p) {
            out.run(columns.vertices[v], axes.map(|a| unit * direction.dot(&a)));
        }
    };
    // 1. Samples.
    let largest = network.largest_of_strips();
    for s in &network.samples {
        let (Some(foot), m, column) = (s.foot, &network.members[s.strip], columns.strips[s.strip]) else { continue };
        let lean = s.lean(&foot);
        if lean * foot.distance.abs() > COUNTS * largest[s.strip] {
            m.strip.row(column, &s.x, &foot, lean, &mut program.hard);
            if let Some((l, p, share)) = network.carried(s) {
                ways(l, p, &(foot.normal * (lean * share)), &mut program.hard);
            }
            program.hard.end();
            program.distances.push(lean * foot.distance / tolerance);
        }
        if keep_regular(m, column, (&s.x, &foot), tolerance, program).is_some() {
            program.bounded.end();
        }
    }
    // 2. Lines: distances of both strips, gaps.
    for (l, line) in network.lines.iter().enumerate() {
        for p in &line.points {
            for (&k, foot) in line.strips.iter().zip(&p.feet) {
                let Some(foot) = foot else { continue };
                let (m, lean) = (&network.members[k], lean(&p.normal, foot));
                if let Some(way) = keep_regular(m, columns.strips[k], (&p.x, foot), tolerance, program) {
                    ways(l, p, &way, &mut program.bounded);
                    program.bounded.end();
                }
                m.strip.row(columns.strips[k], &p.x, foot, lean, &mut program.hard);
                ways(l, p, &(foot.normal * lean), &mut program.hard);
                program.hard.end();
                program.distances.push(lean * foot.distance / tolerance);
            }
            let Some(middle) = &p.middle else { continue };
            let mut direction = Vec3::zeros();
            for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
                let (k, foot) = (line.strips[side], &middle.feet[side]);
                let scale = sign / foot.normal.dot(&middle.up);
                network.members[k].strip.row(columns.strips[k], &middle.z, foot, scale, &mut tie.rows);
                direction += foot.normal * scale;
            }
            ways(l, p, &direction, &mut tie.rows);
            tie.end(weight / line.points.len() as f64, middle.gap() / tolerance);
        }
    }
    Some(())
}
