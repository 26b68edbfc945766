"""The pictures of the docs, by subject. `scripts/draw_docs.py` draws them."""
