//! What is drawn of a scenario, and its static figures.

use super::block::Picture;
use super::figures::{self, Marks};
use super::numbers::brief_time;
use super::words;
use crate::findings::{CascadeFindings, CaseFindings, CouplerFindings, Evidence, Field, ScenarioFindings};
use crate::train::{Event, Pulse, Scenario, Train};

/// A scenario that has something to show: of many cases, the one with the worst coupler.
pub struct Shown<'a> {
    /// The train.
    pub train: &'a Train,
    /// What was found.
    pub findings: &'a ScenarioFindings,
    /// The scenario's index in the train.
    pub index: usize,
    /// What the train file says.
    pub scenario: &'a Scenario,
    /// The case whose forces are drawn over time.
    pub case: &'a CaseFindings,
    /// Its coupler with the largest utilisation.
    pub worst: &'a CouplerFindings,
    /// What is drawn over time.
    pub evidence: &'a Evidence,
    /// Utilisation of the strongest colour of the wave figures, the same in all of a report.
    pub most: f64,
}

impl<'a> Shown<'a> {
    /// Follows the worst case's wave; `None` for a scenario in which no coupler is left to watch.
    fn new(train: &'a Train, findings: &'a ScenarioFindings) -> Option<Shown<'a>> {
        let (index, scenario) = words::source(train, findings)?;
        let (case, worst) = words::worst_case(findings)?;
        let evidence = findings.evidence(train)?;
        let fields = [&evidence.wave, &evidence.rod, &evidence.cascade].into_iter().flatten();
        let most = fields.map(|field| f64::from(field.largest())).fold(0.0, f64::max);
        Some(Shown { train, findings, index, scenario, case, worst, evidence, most })
    }

    /// Those of a report, with one scale of colours.
    pub fn all(train: &'a Train, findings: &'a [ScenarioFindings]) -> Vec<Option<Shown<'a>>> {
        let mut all: Vec<Option<Shown>> = findings.iter().map(|s| Shown::new(train, s)).collect();
        let most = all.iter().flatten().map(|shown| shown.most).fold(0.0, f64::max);
        all.iter_mut().flatten().for_each(|shown| shown.most = most);
        all
    }

    /// Its figures.
    pub fn pictures(&self) -> Vec<Picture> {
        let Shown { train, findings, index, case, worst, evidence, .. } = *self;
        let number = index + 1;
        let picture = |kind: &'static str, caption: String, draw: &dyn Fn(&str) -> String| {
            let name = format!("figure-{number}-{kind}");
            Picture { svg: draw(&name), file: format!("{name}.svg"), alt: caption.clone(), caption }
        };
        let several = findings.cases.len() > 1;
        let mut all = Vec::new();
        if let Some((field, cascade)) = evidence.cascade.as_ref().zip(case.cascade.as_ref()) {
            let caption = self.wave_caption("What breaks next: force in every coupler over time", field, None);
            all.push(picture("cascade", caption, &|n| self.draw_wave(field, None, Some(cascade), n)));
        }
        if several {
            let caption =
                "Largest utilisation after each break; the horizontal axis has the coupler that breaks.".to_owned();
            all.push(picture("breaks", caption, &|n| figures::breaks(findings, train.couplers().len(), n)));
        }
        if findings.cases.iter().any(|c| !c.couplers.is_empty()) {
            let over = if several { ", over all breaks" } else { "" };
            let shared = match figures::couplers_per_place(train.couplers().len()) {
                1 => String::new(),
                n => format!(" Of every {n} neighbours the extremes and the weakest rating are drawn."),
            };
            let caption = format!("Largest draft and buff of every coupler{over}, against the ratings.{shared}");
            all.push(picture("envelope", caption, &|n| figures::envelope(train, findings, n)));
        }
        if let Some(map) = &findings.map {
            let what = if map.over == "duration_s" {
                "The smallest force, of this pulse's shape and sense, that overloads a coupler, against its duration"
            } else {
                "Largest safe factor on the load, for each coupler that breaks"
            };
            let caption = format!("{what}; the numbers are in map-{number}.csv.");
            all.push(picture("map", caption, &|n| figures::map(map, &self.scenario.event, train.origin().units, n)));
        }
        let when = self.when();
        if let Some(field) = &evidence.wave {
            let rod = evidence.rod.as_ref();
            let caption = self.wave_caption(&format!("Force in every coupler over time{when}"), field, rod);
            all.push(picture("wave", caption, &|n| self.draw_wave(field, rod, None, n)));
        }
        let shown = match evidence.window_s {
            (from, to) if to - from < case.horizon_s => {
                format!(", from {} to {} of {}", brief_time(from), brief_time(to), brief_time(case.horizon_s))
            }
            _ => String::new(),
        };
        let others = if evidence.wave_left_out {
            " To follow all couplers over time would take long, and is left out."
        } else {
            ""
        };
        let caption = format!("Force in the worst coupler, {}{when}{shown}.{others}", words::place(worst));
        all.push(picture("force", caption, &|n| figures::history(train, case, worst, evidence, n)));
        let name = format!("figure-{number}-loop");
        if let Some(svg) = figures::hysteresis(train, worst, &evidence.way, &name) {
            let caption =
                format!("Force against elongation of {}{when}, with the curves of its law.", words::place(worst));
            all.push(Picture { svg, file: format!("{name}.svg"), alt: caption.clone(), caption });
        }
        all
    }

    /// Which break, if there are many.
    pub fn when(&self) -> String {
        match self.case.broken_coupler.filter(|_| self.findings.cases.len() > 1) {
            Some(b) => format!(", when coupler {b} breaks"),
            None => String::new(),
        }
    }

    fn wave_caption(&self, what: &str, field: &Field, rod: Option<&Field>) -> String {
        let until = field.times_s[field.times_s.len() - 1];
        let part = if until < 0.99 * self.case.horizon_s {
            format!(" (the first {} of {})", brief_time(until), brief_time(self.case.horizon_s))
        } else {
            String::new()
        };
        let rod = if rod.is_some() { " Below it the elastic rod on the same scale." } else { "" };
        let open = if field.opens() { ", grey where it is open" } else { "" };
        format!(
            "{what}{part}, as a share of its rating: draft blue, buff orange{open}, outlined in black and marked where the \
             force exceeds the rating. Each pixel shows the largest share among the couplers and instants that it covers.{rod}"
        )
    }

    fn draw_wave(&self, field: &Field, rod: Option<&Field>, cascade: Option<&CascadeFindings>, name: &str) -> String {
        let (event, acts_s) = match &self.scenario.event {
            Event::Break { .. } => (self.case.broken_coupler.map(|b| b as f64), 0.0),
            Event::Pulse(Pulse { vehicle, duration_s, .. }) => (Some(*vehicle as f64 + 0.5), *duration_s),
            Event::Brake { from, .. } => (from.first().map(|v| *v as f64 + 0.5), 0.0),
            Event::Impact { vehicles, at_head: true, .. } => (Some(*vehicles as f64), 0.0),
            Event::Impact { vehicles, .. } => (Some((self.train.vehicles().len() - vehicles) as f64), 0.0),
        };
        let breaks = cascade.map_or(&[][..], |c| &c.breaks);
        let marks = Marks { event, acts_s, broken: self.case.broken_coupler, breaks };
        figures::wave((field, rod), self.most, &marks, words::time_axis(self.case), self.train.couplers().len(), name)
    }
}
