//! Which passes of the render graph a scene would run, and why.
use luxel_flat::{Feature, FeatureSet};
use luxel_render::{GraphSet, NODES, NodeRow};
use serde::Serialize;

use crate::SphereAccelFacts;

/// The kernel that finds what a ray meets.
const INTERSECT: &str = "intersect";

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
    pub because: String,
}

/// Every node, in the order in which it would run in a render to a file. Where rays meet spheres, the reason names the
/// structure over them.
pub fn nodes(features: FeatureSet, spheres: &SphereAccelFacts) -> Vec<NodeFacts> {
    let facts = NODES.iter().map(|node| {
        let row = node.feature.map(|feature| &luxel_flat::FEATURES[feature as usize]);
        let called_for = row.is_none_or(|row| features.has(row.feature));
        let runs = called_for && node.set != GraphSet::Resolve;
        let because = match row {
            _ if runs => reason(node, features, spheres),
            Some(row) if !called_for => row.unused.to_owned(),
            _ => "no window shows the picture; files are made from the film".to_owned(),
        };
        NodeFacts { name: node.name, stage: format!("{:?}", node.set), kernels: node.kernels, runs, because }
    });
    facts.collect()
}

fn reason(node: &NodeRow, features: FeatureSet, spheres: &SphereAccelFacts) -> String {
    if !(node.kernels.contains(&INTERSECT) && features.has(Feature::Spheres)) {
        return node.because.to_owned();
    }
    let SphereAccelFacts { name, because, .. } = spheres;
    format!("{}; spheres are found by {name}, because {because}", node.because)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pass_that_meets_spheres_names_their_structure() {
        let facts = SphereAccelFacts {
            name: "bvh",
            because: "it was asked for".to_owned(),
            nodes: 3,
            depth: 1,
            bytes: 0,
            cut_off: false,
        };
        let naming = |features| {
            let nodes = nodes(features, &facts).into_iter();
            let with = nodes
                .filter(|node| node.because.ends_with("spheres are found by bvh, because it was asked for"));
            with.map(|node| node.name).collect::<Vec<_>>()
        };
        assert_eq!(naming(FeatureSet::NONE.with(Feature::Spheres, true)), ["camera_rays", "bounces"]);
        assert_eq!(naming(FeatureSet::NONE), Vec::<&str>::new());
    }
}
