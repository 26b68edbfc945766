"""Our additions to the paper's method, switched on by the classes of `settings.additions`.

The presets SHELF, TABLE and CLUTTER of the paper use no additions.
"""
