"""What keeps a machine on its way: PID, waypoint follower, localization filter. Simulated and real drivers share it.

Import from the modules: `pid`, `follower` and `localization` load compiled code, which this package does not do by
itself.
"""
