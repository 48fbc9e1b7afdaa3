"""How fast firmtouch is, as ratios measured in one run: `python -m tests.benchmarks` from the repository's root."""
