"""The sections of a model file, one a file: frozen values in SI with parsed expressions."""
