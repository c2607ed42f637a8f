"""Goals of levels 1 to 4, the judge of success, and episodes.

The judge reads a goal's sentence by itself and looks at the world's truth. It shares no words, tables or code with the
minds, so that it cannot agree with them by construction.
"""
