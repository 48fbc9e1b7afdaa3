"""Thermal touch: a heated film, a thermistor and layers that feel what is touched. Knows nothing of mechanisms."""
