"""Somebody who walks about at random and now and then says "Found Goal": the least that learns nothing."""

import gymnasium

env = gymnasium.make("reasoned_explorer.gym:reasoned_explorer/Outdoor-v0", world="plaza:3@200", goal="Find me a bench")
env.action_space.seed(7)
observation, info = env.reset(seed=7)
over = False
while not over:
    observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
    over = terminated or truncated
print(f"{info['steps']} steps, {info['path_length_m']:.0f} m, success {info['success']}, SPL {info['spl']:.2f}")
env.close()
