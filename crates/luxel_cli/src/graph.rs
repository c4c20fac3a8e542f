//! `luxel graph`: the passes that a scene would run, in order, and why each does or does not.
use luxel_engine::graph::{self, NodeFacts};
use luxel_engine::{ExitCode, Feature};
use serde::Serialize;

use crate::args::GraphArgs;
use crate::error::CliError;
use crate::reply;

#[derive(Serialize)]
struct Answer {
    scene: String,
    nodes: Vec<NodeFacts>,
}

/// Shows the render graph of a scene.
pub(crate) fn graph(args: &GraphArgs) -> Result<ExitCode, CliError> {
    let mut engine = args.scene.open()?;
    args.scene.ask(&mut engine);
    let features = engine.bake()?.features;
    let features = features.with(Feature::Aovs, args.aov || features.has(Feature::Aovs));
    let nodes = graph::nodes(features, &engine.sphere_accel());
    if args.json {
        reply::print_json(&Answer { scene: args.scene.file.display().to_string(), nodes })?;
    } else {
        reply::print_text(&table(&nodes))?;
    }
    Ok(ExitCode::Done)
}

fn table(nodes: &[NodeFacts]) -> String {
    let width = |of: fn(&NodeFacts) -> usize| nodes.iter().map(of).max().unwrap_or(0);
    let (stages, names) = (width(|node| node.stage.len()), width(|node| node.name.len()));
    let line = |node: &NodeFacts| {
        let verdict = if node.runs { "runs" } else { "left out" };
        let kernels = match node.kernels {
            [] => String::new(),
            kernels => format!("  [{}]", kernels.join(" ")),
        };
        format!(
            "{:stages$}  {:names$}  {verdict:8}  because {}{kernels}\n",
            node.stage, node.name, node.because
        )
    };
    nodes.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_what_runs_and_why() {
        let node = |name, runs| NodeFacts {
            name,
            stage: "Trace".to_owned(),
            kernels: if runs { &["shade"] } else { &[] },
            runs,
            because: "it must".to_owned(),
        };
        let text = table(&[node("shade", true), node("longer name", false)]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "Trace  shade        runs      because it must  [shade]");
        assert_eq!(lines[1], "Trace  longer name  left out  because it must");
    }
}
