"""The rows of docs/paper.md. scripts/figures/paper.py runs them."""
