"""MAVLink: autopilots of ArduPilot and PX4, and a drone or rover that is driven through one."""
