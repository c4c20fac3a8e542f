//! `cargo xtask test`: every test of the workspace on a machine that has only Rust, gcc and git.

use std::io::{BufRead as _, BufReader, Read, Write};
use std::process::{Child, Stdio};

use anyhow::{Context, Result, anyhow, bail};

use crate::summary::Summary;
use crate::{machine, vulkan};

/// Sets the machine up, runs all tests while their output streams by, and ends with one line of totals.
pub(crate) fn run() -> Result<()> {
    vulkan::ensure()?;
    // Output of passing tests is shown because that is where a test says what it skipped.
    let mut command = machine::cargo(&["test", "--workspace", "--no-fail-fast", "--", "--show-output"])?;
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().context("cannot start cargo test")?;
    let mut summary = relay_output(&mut child).context("cannot read the output of cargo test")?;
    let status = child.wait().context("cannot wait for cargo test")?;
    if !status.success() && summary.failed == 0 {
        println!(
            "xtask: cargo test ended with {status} without a failed test: it did not build, or a test died"
        );
        summary.failed = 1;
    }
    println!("\n{summary}");
    if summary.failed > 0 {
        bail!("tests failed");
    }
    Ok(())
}

/// Passes both streams of `child` on to ours, line by line, and counts what they report.
fn relay_output(child: &mut Child) -> Result<Summary> {
    let (out, err) = (child.stdout.take(), child.stderr.take());
    let (out, err) = std::thread::scope(|scope| {
        let err = scope.spawn(|| relay(err, std::io::stderr()));
        let out = relay(out, std::io::stdout());
        (out, err.join())
    });
    Ok(out? + err.map_err(|_| anyhow!("the thread that reads stderr died"))??)
}

fn relay(source: Option<impl Read>, mut sink: impl Write) -> std::io::Result<Summary> {
    let mut summary = Summary::default();
    let lines = source.into_iter().flat_map(|source| BufReader::new(source).split(b'\n'));
    for line in lines {
        let mut line = line?;
        summary.read(&String::from_utf8_lossy(&line));
        line.push(b'\n');
        sink.write_all(&line)?;
        sink.flush()?;
    }
    Ok(summary)
}
