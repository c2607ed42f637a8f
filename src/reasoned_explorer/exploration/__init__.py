"""The agent: what it remembers, how it chooses, how it goes on."""
