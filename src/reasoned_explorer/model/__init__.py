"""The nouns that all rooms share, and the errors."""

from reasoned_explorer.model.answer import LIKERT_LEVELS, Assessment, Verdict, likert_from_score
from reasoned_explorer.model.errors import (
    Fault,
    Gathering,
    GoalError,
    InputError,
    MissingDependencyError,
    PartError,
    ReasonedExplorerError,
    RecordError,
    RecordWriteError,
    SettingsError,
    StartError,
    UnknownNameError,
    WorldError,
)
from reasoned_explorer.model.goal import Goal
from reasoned_explorer.model.track import Leg, LegOutcome, TrackPoint
from reasoned_explorer.model.view import Camera, Scene, Undescribed, View

__all__ = [
    "LIKERT_LEVELS",
    "Assessment",
    "Camera",
    "Fault",
    "Gathering",
    "Goal",
    "GoalError",
    "InputError",
    "Leg",
    "LegOutcome",
    "MissingDependencyError",
    "PartError",
    "ReasonedExplorerError",
    "RecordError",
    "RecordWriteError",
    "Scene",
    "SettingsError",
    "StartError",
    "TrackPoint",
    "Undescribed",
    "UnknownNameError",
    "Verdict",
    "View",
    "WorldError",
    "likert_from_score",
]
