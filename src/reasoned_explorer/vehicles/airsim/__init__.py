"""AirSim, Colosseum and Cosys-AirSim: their wire, their conventions, and a drone that flies over it."""
