//! Systems that turn changes in the world into an up-to-date FlatScene
