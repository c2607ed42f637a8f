"""How rarely garbage cycles are looked for: this program makes few, and looking goes through all that is there."""

#: As `gc.set_threshold` takes it.
RARELY = (50_000, 50, 1_000)
