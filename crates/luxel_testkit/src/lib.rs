//! Dev-only: generators, oracles, comparers with negative controls
