"""Proofs for finished gains, in ball arithmetic."""
