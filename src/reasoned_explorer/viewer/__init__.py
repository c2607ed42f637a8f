"""The page on which missions are watched, replayed and judged: a server of runs, and what it serves.

It reads what runs leave behind and changes none of it. Web packages are imported by `app` and `serving` alone, so that
the rest can be used without the extra ``view``.
"""
