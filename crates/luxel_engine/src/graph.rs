//! Which passes of the render graph a scene would run, and why.
use luxel_flat::FeatureSet;
use luxel_render::NODES;
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

/// Every node, in the order in which it would run.
pub fn nodes(features: FeatureSet) -> Vec<NodeFacts> {
    let facts = NODES.iter().map(|node| {
        let row = node.feature.map(|feature| &luxel_flat::FEATURES[feature as usize]);
        let runs = row.is_none_or(|row| features.has(row.feature));
        let because = if runs { node.because } else { row.map_or("", |row| row.unused) };
        NodeFacts { name: node.name, stage: format!("{:?}", node.set), kernels: node.kernels, runs, because }
    });
    facts.collect()
}
