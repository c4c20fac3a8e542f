//! The render graph: nodes as systems in a bevy_ecs schedule
