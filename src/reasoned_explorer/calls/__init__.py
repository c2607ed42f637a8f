"""Calls to language and vision models: what is asked, what comes back, and what it costs."""
