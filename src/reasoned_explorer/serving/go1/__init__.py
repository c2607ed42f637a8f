"""The embedded simulator as a Unitree Go1 with a satellite receiver."""
