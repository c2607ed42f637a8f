"""Machines that look and move, and what keeps them on their way."""

from reasoned_explorer.vehicles.profile import PROFILES, VehicleProfile
from reasoned_explorer.vehicles.vehicle import Vehicle

__all__ = ["PROFILES", "Vehicle", "VehicleProfile"]
