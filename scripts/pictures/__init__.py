"""Functions that draw the pictures of the documentation, one module per subject. `scripts/draw_docs.py` calls these
functions.
"""
