"""The embedded simulator, answering as an autopilot that speaks MAVLink does."""
