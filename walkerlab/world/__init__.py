"""The compiled world: ground, obstacles, robot and loads, as a MuJoCo model."""
