//! `result.json`: everything that was found, for programs.

use std::sync::OnceLock;

use crate::findings::{Analysis, CaseFindings, ScenarioFindings};

/// The analysis as JSON, indented; the field names are those of [`crate::findings`].
///
/// The cases of a scenario with more than one have empty `couplers`: `couplers.csv` has them. JSON knows no
/// infinity, so a number that is not finite becomes `null`.
///
/// # Errors
/// None are known, but the serialiser returns a `Result`.
pub fn json(analysis: &Analysis) -> Result<String, serde_json::Error> {
    let shortened = Analysis {
        train: analysis.train.clone(),
        scenarios: analysis.scenarios.iter().map(shorten).collect(),
        program: analysis.program.clone(),
        date: analysis.date.clone(),
        inputs: analysis.inputs.clone(),
        options: analysis.options.clone(),
        doubts: analysis.doubts.clone(),
        ..*analysis
    };
    let mut text = serde_json::to_string_pretty(&serde_json::to_value(&shortened)?)?;
    text.push('\n');
    Ok(text)
}

/// The scenario without what is not printed: the couplers of one of many cases.
fn shorten(scenario: &ScenarioFindings) -> ScenarioFindings {
    let many = scenario.cases.len() > 1;
    let case = |c: &CaseFindings| CaseFindings {
        couplers: if many { Vec::new() } else { c.couplers.clone() },
        method_reason: c.method_reason.clone(),
        worst: c.worst.clone(),
        worst_first_passage: c.worst_first_passage.clone(),
        rod: c.rod.clone(),
        cascade: c.cascade.clone(),
        gap_closures: c.gap_closures.clone(),
        ..*c
    };
    ScenarioFindings {
        name: scenario.name.clone(),
        cases: scenario.cases.iter().map(case).collect(),
        left_out_in_buff: scenario.left_out_in_buff.clone(),
        map: scenario.map.clone(),
        damping: scenario.damping.clone(),
        variants: scenario.variants.clone(),
        evidence: OnceLock::new(),
        ..*scenario
    }
}
