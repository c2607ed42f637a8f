"""Draws worlds: models of everything that can stand in one, and a software renderer on numba and numpy alone."""
