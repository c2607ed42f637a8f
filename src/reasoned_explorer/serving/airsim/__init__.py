"""The embedded simulator, answering as AirSim does."""
