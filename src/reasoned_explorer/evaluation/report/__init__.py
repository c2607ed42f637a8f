"""The report of a run: one self-contained page, and its figures and tables as files beside it.

Everything is made from the rows of the run's store (`evaluation.row.MissionRow`); only the trajectories need records.
"""

from reasoned_explorer.evaluation.report.about import ReportAbout, TraceSource
from reasoned_explorer.evaluation.report.causes import Cause, cause_of
from reasoned_explorer.evaluation.report.writing import write_report

__all__ = ["Cause", "ReportAbout", "TraceSource", "cause_of", "write_report"]
