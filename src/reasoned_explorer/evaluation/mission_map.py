"""The picture of a mission: where it was looked for, what was thought of each way on, and where it ended."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.evaluation.mission_marks import MarkStyle, paint_mission
from reasoned_explorer.evaluation.mission_panel import write_panel
from reasoned_explorer.evaluation.mission_trace import FRONTIER_STATES, MapFrontier, MapGoal, MissionTrace
from reasoned_explorer.model.errors import Fault, RecordError
