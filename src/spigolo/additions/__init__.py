"""Our additions to the paper, each switched on by a model in `settings.additions`. The paper's presets use no
additions.
"""
