"""The seeded world generator."""
