//! Optimisation of a tree by reinsertion.
//!
//! Theory: Meister, Bittner 2018, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization". For each of the
//! nodes with the largest boxes the place is sought, in parallel, where its subtree enlarges the other boxes least;
//! then the moves are made one after the other, the most profitable first, passing over those that touch nodes of an
//! earlier one. Deviations: the moves are made by one thread in a fixed order (the paper's threads race for locks), so
//! that the result is the same for any number of threads; a search ends after [`MAX_VISITS`] nodes, so that no input
//! makes it quadratic; no move takes the tree below its depth bound.
use rayon::prelude::*;

use super::linked::{LinkedTree, ROOT, sibling};
use super::{BvhOptions, Reinsertion, collapse};

/// Most nodes that a search looks at.
const MAX_VISITS: u32 = 4096;

/// A subtree and the better place for it.
#[derive(Clone, Copy)]
struct Move {
    from: u32,
    to: u32,
    /// By how much the sum of areas shrinks.
    gain: f32,
}

/// Moves subtrees until the rounds are over or a round gains nothing. What a round of moves gains together is less
/// certain than what each gains alone, so one that makes the tree dearer is taken back.
pub(super) fn optimize(tree: &mut LinkedTree, options: &BvhOptions) {
    let Reinsertion { rounds, share } = options.reinsertion;
    let count = (share * tree.nodes.len() as f32) as usize;
    let mut is_touched = vec![false; tree.nodes.len()];
    let mut cost = collapse::cost(tree, options);
    for _ in 0..rounds {
        let before = tree.nodes.clone();
        let new_cost = if round(tree, count, &mut is_touched) { collapse::cost(tree, options) } else { cost };
        if new_cost >= cost || !new_cost.is_finite() {
            tree.nodes = before;
            return;
        }
        cost = new_cost;
    }
}

/// Looks for moves of so many subtrees and makes them. False if there was none to make.
fn round(tree: &mut LinkedTree, count: usize, is_touched: &mut [bool]) -> bool {
    let mut moves: Vec<Move> = largest(tree, count)
        .par_iter()
        .map_init(Vec::new, |open, &node| best_move(tree, node, open))
        .flatten()
        .collect();
    moves.sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.from.cmp(&b.from)));
    is_touched.fill(false);
    moves.iter().filter(|one| make(tree, one, is_touched)).count() > 0
}

/// The nodes of the largest boxes, the root excepted; equal ones by their place.
fn largest(tree: &LinkedTree, count: usize) -> Vec<u32> {
    let mut all: Vec<u32> = (1..tree.nodes.len() as u32).collect();
    if count < all.len() {
        let by_area = |a: &u32, b: &u32| tree.node(*b).area.total_cmp(&tree.node(*a).area).then(a.cmp(b));
        all.select_nth_unstable_by(count, by_area);
        all.truncate(count);
    }
    all
}

/// Makes a move, unless one of its nodes was touched by another or it would go too deep.
fn make(tree: &mut LinkedTree, one: &Move, is_touched: &mut [bool]) -> bool {
    let Move { from, to, .. } = *one;
    let (parent, target) = (tree.node(from).parent, tree.node(to).parent);
    let nodes = [from, sibling(from), parent, to, target];
    let is_free = nodes.iter().all(|&node| !is_touched[node as usize]);
    // Moves made before may have brought the target below the subtree.
    let may = is_free && !tree.is_above(from, to) && tree.has_room(from, to);
    if may {
        nodes.iter().for_each(|&node| is_touched[node as usize] = true);
        tree.reinsert(from, to);
    }
    may
}

/// The best new place for a subtree, if any is better than where it is. `open` is room for the search.
fn best_move(tree: &LinkedTree, from: u32, open: &mut Vec<(f32, u32)>) -> Option<Move> {
    let (node, parent) = (tree.node(from), tree.node(from).parent);
    let mut best = Move { from, to: from, gain: 0.0 };
    let mut visits = 0;
    // Boxes shrink where the subtree is taken out: the parent goes, and the ancestors are left with what `rest` holds.
    let mut freed = tree.node(parent).area;
    let mut rest = tree.node(sibling(from)).bounds;
    let (mut pivot, mut beside) = (parent, sibling(from));
    loop {
        open.push((freed, beside));
        while let Some((freed, to)) = open.pop() {
            // At the best, the new parent is no larger than the subtree.
            if freed - node.area <= best.gain || visits == MAX_VISITS {
                continue;
            }
            visits += 1;
            let target = tree.node(to);
            let gain = freed - target.bounds.with(&node.bounds).half_area(tree.unit);
            if gain > best.gain {
                best = Move { to, gain, ..best };
            }
            if let Some(first) = target.first_child() {
                // Further down the target's box grows, but stays.
                open.extend([first, first + 1].map(|child| (gain + target.area, child)));
            }
        }
        if pivot == ROOT {
            break;
        }
        if pivot != parent {
            rest = rest.with(&tree.node(beside).bounds);
            freed += tree.node(pivot).area - rest.half_area(tree.unit);
        }
        (beside, pivot) = (sibling(pivot), tree.node(pivot).parent);
    }
    let is_new_place = best.to != from && best.to != sibling(from) && best.to != parent;
    is_new_place.then_some(best)
}
