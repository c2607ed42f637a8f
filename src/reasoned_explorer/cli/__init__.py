"""`rex`, the command line."""


def main() -> None:
    """Run `rex`; the process ends with its exit code.

    0: done (for a mission: found), 1: the mission ended without, 2: bad input, 3: a part failed, 130: stopped by a
    person.
    """
    import atexit
    import gc

    from reasoned_explorer.model.garbage import RARELY
    from reasoned_explorer.model.stopping import end_listening, listen

    # From the very beginning: loading the commands takes a moment, too.
    listen()
    # What is loaded stays: looking for garbage in it costs a twentieth of the start.
    gc.set_threshold(*RARELY)
    # Nor is it looked for at the very end, which takes half a second where numba is loaded: all of it goes anyhow.
    atexit.register(gc.freeze)
    from reasoned_explorer.cli.app import app

    try:
        app()
    finally:
        end_listening()
