"""Interfaces to other software: optimisers, reinforcement learning, MuJoCo without walkerlab."""
