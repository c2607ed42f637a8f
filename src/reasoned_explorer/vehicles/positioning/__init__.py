"""Where a real machine is: fixes of a satellite receiver, corrections for it, what a filter makes of all sensors."""
