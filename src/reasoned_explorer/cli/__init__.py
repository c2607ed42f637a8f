"""`rex`, the command line."""


def main() -> None:
    """Run `rex`; the process ends with its exit code.

    0: done (for a mission: found), 1: the mission ended without, 2: bad input, 3: a part failed, 130: stopped by a
    person.
    """
    from reasoned_explorer.cli.app import app

    app()
