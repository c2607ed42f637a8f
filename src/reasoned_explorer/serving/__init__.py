"""The embedded simulator as other machines and simulators: their wires, answered."""
