"""Many missions: what is run, who runs it, where it is kept, and what comes of it."""
