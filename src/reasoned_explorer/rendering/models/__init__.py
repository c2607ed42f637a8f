"""What every class of things looks like: models made in code."""
