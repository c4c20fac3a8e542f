//! Which passes of the render graph a scene would run, and why.
use luxel_flat::FeatureSet;
use luxel_render::{GraphSet, NODES};
use serde::Serialize;

/// A node of the graph as `luxel graph` shows it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct NodeFacts {
    /// Name.
    pub name: &'static str,
    /// Stage.
    pub stage: String,
    /// Kernels that it dispatches.
    pub kernels: &'static [&'static str],
    /// Whether it runs.
    pub runs: bool,
    /// Why it does or does not, as the end of a sentence that begins with "because".
    pub because: &'static str,
}

/// Every node, in the order in which it would run in a render to a file.
pub fn nodes(features: FeatureSet) -> Vec<NodeFacts> {
    let facts = NODES.iter().map(|node| {
        let row = node.feature.map(|feature| &luxel_flat::FEATURES[feature as usize]);
        let called_for = row.is_none_or(|row| features.has(row.feature));
        let runs = called_for && node.set != GraphSet::Resolve;
        let because = match row {
            _ if runs => node.because,
            Some(row) if !called_for => row.unused,
            _ => "no window shows the picture; files are made from the film",
        };
        NodeFacts { name: node.name, stage: format!("{:?}", node.set), kernels: node.kernels, runs, because }
    });
    facts.collect()
}
