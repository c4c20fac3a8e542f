//! How a tree is built: the settings, and presets of them.
use luxel_flat::MAX_LEAF_SIZE;

/// Most bins along an axis that can be asked for.
pub const MAX_BINS: u32 = 64;

/// Where a node is cut in two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BvhSplit {
    /// Where the surface area heuristic over bins expects the fewest tests.
    #[default]
    Sah,
    /// At the median of the centres along the axis in which they spread most (seed 2, 2.6.2, "the normal way").
    LargestAxis,
}

/// How a finished tree is improved: subtrees are moved to where they enlarge fewer boxes (Meister, Bittner 2018,
/// "Parallel Reinsertion for Bounding Volume Hierarchy Optimization").
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reinsertion {
    /// Number of passes; it ends before where nothing is gained any more.
    pub rounds: u32,
    /// Share of the nodes, those of the largest boxes, that a pass looks at.
    pub share: f32,
}

/// How a tree is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BvhOptions {
    /// Where a node is cut.
    pub split: BvhSplit,
    /// Bins along each axis of the heuristic; held inside 2 to [`MAX_BINS`].
    pub bins: u32,
    /// Largest number of primitives in a leaf; held inside 1 to `MAX_LEAF_SIZE`.
    pub max_leaf_size: u32,
    /// Cost of a step through an inner node in units of one primitive test.
    pub traversal_cost: f32,
    /// Rounds of reinsertion among the largest boxes, what is below them moving as a whole. With [`BvhSplit::Sah`] only:
    /// the other split is there to be compared with.
    pub top_rounds: u32,
    /// What is done after that.
    pub reinsertion: Reinsertion,
}

/// Presets: how much work a build puts into the tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BvhQuality {
    /// Few bins.
    Fast,
    /// The common binned build, and some reinsertion near the root.
    #[default]
    Medium,
    /// Some reinsertion everywhere.
    High,
    /// Reinsertion for as long as it gains.
    Best,
}

impl BvhOptions {
    /// The common binned build: [`BvhQuality::Medium`] without its reinsertion.
    pub const MEDIUM: Self = Self {
        split: BvhSplit::Sah,
        bins: 16,
        max_leaf_size: MAX_LEAF_SIZE,
        traversal_cost: 1.0,
        top_rounds: 0,
        reinsertion: Reinsertion { rounds: 0, share: 0.0 },
    };

    /// The options with every number inside its bounds.
    pub(super) fn bounded(&self) -> Self {
        Self {
            bins: self.bins.clamp(2, MAX_BINS),
            max_leaf_size: self.max_leaf_size.clamp(1, MAX_LEAF_SIZE),
            ..*self
        }
    }
}

impl Default for BvhOptions {
    fn default() -> Self {
        Self::MEDIUM
    }
}

impl BvhQuality {
    /// Every preset, in order of the work.
    pub const ALL: [Self; 4] = [Self::Fast, Self::Medium, Self::High, Self::Best];

    /// Its name on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Medium => "medium",
            Self::High => "high",
            Self::Best => "best",
        }
    }

    /// What it stands for.
    pub fn options(self) -> BvhOptions {
        let reinserted = |top_rounds, rounds, share| BvhOptions {
            bins: 32,
            top_rounds,
            reinsertion: Reinsertion { rounds, share },
            ..BvhOptions::MEDIUM
        };
        match self {
            Self::Fast => BvhOptions { bins: 8, ..BvhOptions::MEDIUM },
            Self::Medium => BvhOptions { top_rounds: 4, ..BvhOptions::MEDIUM },
            Self::High => reinserted(4, 2, 0.1),
            Self::Best => reinserted(0, 12, 0.5),
        }
    }
}
