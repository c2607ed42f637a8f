"""Why a guard steps in."""

from enum import StrEnum


class Cause(StrEnum):
    """Of what kind the reason of an intervention is."""

    OPERATOR = "operator"
    LINK = "link"
    POSITION = "position"
    COMPASS = "compass"
    BATTERY = "battery"
    CAMERA = "camera"
    OBSTACLE = "obstacle"
    FENCE = "fence"
    KEEP_OUT = "keep-out"
    HEIGHT = "height"
    SPEED = "speed"
    MODELS = "models"
    DECLINED = "declined"
    DRY_RUN = "dry run"
