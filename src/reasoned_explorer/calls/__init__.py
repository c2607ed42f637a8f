"""Calls to language and vision models: what is asked and answered, by whom, for how many seconds, tokens and dollars."""
