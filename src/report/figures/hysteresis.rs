//! Force against elongation of one coupler with slack or a gear: its path in the event, and its law's curves.

use super::HEIGHT;
use crate::figures::{Axis, Color, Figure, Point, Sample, Shape, Stroke};
use crate::findings::CouplerFindings;
use crate::law::{Curve, GearRow, Law};
use crate::report::numbers::{force_unit, gap_unit};
use crate::train::Train;

const WAY: Stroke = Stroke::solid(Color::Ink, 1.6);
const LAW: Stroke = Stroke::solid(Color::Quiet, 2.4);

/// The path of a coupler, in elongations, m, and forces, N, as SVG; `None` for a linear coupler.
pub fn hysteresis(train: &Train, c: &CouplerFindings, way: &[[f64; 2]], name: &str) -> Option<String> {
    let law = train.extras().laws.get(c.coupler - 1).filter(|_| !way.is_empty())?;
    let span = |of: usize| {
        let values = || way.iter().map(|p| p[of]);
        let (low, high) = (values().fold(0.0, f64::min), values().fold(0.0, f64::max));
        let air = 0.08 * (high - low).max(f64::MIN_POSITIVE);
        (low - air, high + air)
    };
    let (x, y) = (span(0), span(1));
    let unit = force_unit(train.origin().units, y.1.max(-y.0));
    let length = gap_unit(train.origin().units);
    let x_label = format!("elongation from the middle of the slack, {}", length.name);
    let y_label = format!("force in coupler {}, {} (draft +, buff −)", c.coupler, unit.name);
    let x_axis = Axis::new(&x_label, (x.0 / length.size, x.1 / length.size));
    let mut figure = Figure::new(name);
    let mut panel = figure.panel(HEIGHT, x_axis, Axis::new(&y_label, (y.0 / unit.size, y.1 / unit.size)));
    let point = |p: &[f64; 2]| -> Point { (p[0] / length.size, p[1] / unit.size) };
    for curve in curves(law, x) {
        panel.line(&curve.iter().map(point).collect::<Vec<_>>(), LAW);
    }
    panel.line(&way.iter().map(point).collect::<Vec<_>>(), WAY);
    let largest = way.iter().max_by(|a, b| (a[1] * c.peak_force_n).total_cmp(&(b[1] * c.peak_force_n)));
    let color = if c.peak_force_n < 0.0 { Color::Buff } else { Color::Draft };
    panel.marks(&largest.map(point).into_iter().collect::<Vec<_>>(), Shape::Diamond, 5.5, color);
    figure.explain("its way in the event", Sample::Line(WAY));
    figure.explain("loading and unloading curves", Sample::Line(LAW));
    figure.explain("largest force", Sample::Mark(Shape::Diamond, color));
    figure.add(panel);
    Some(figure.svg())
}

/// The curves of a law, as elongations and forces; those of springs between two elongations.
fn curves(law: &Law, x: (f64, f64)) -> Vec<Vec<[f64; 2]>> {
    let half = 0.5 * law.slack_m();
    match law {
        Law::Elastic { draft_n_per_m, buff_n_per_m, .. } => {
            let ends = [[x.0, buff_n_per_m * (x.0 + half)], [x.1, draft_n_per_m * (x.1 - half)]];
            vec![vec![ends[0], [-half, 0.0], [half, 0.0], ends[1]]]
        }
        Law::Gear { solid_n_per_m, draft, buff, .. } => {
            let side = |curve: &Curve, sign: f64, force: fn(&GearRow) -> f64| -> Vec<[f64; 2]> {
                let row = |r: &GearRow| [sign * (half + r.travel_m + force(r) / solid_n_per_m), sign * force(r)];
                std::iter::once([sign * half, 0.0]).chain(curve.rows().iter().map(row)).collect()
            };
            let both = |force| [side(draft, 1.0, force), side(buff, -1.0, force)];
            let slack = vec![[-half, 0.0], [half, 0.0]];
            both(|r| r.loading_n).into_iter().chain(both(|r| r.unloading_n)).chain([slack]).collect()
        }
    }
}
