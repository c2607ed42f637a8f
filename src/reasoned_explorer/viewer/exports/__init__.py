"""Missions for other programs: Rerun, Foxglove, and maps of the earth.

`formats` knows which suffix is written by what; `mission` finds the mission that a person means. What a file shows,
and when, is worked out once, in `moments`, `told` and `scenery`, so that all formats say the same. The library of a
format is imported when it is written.
"""
