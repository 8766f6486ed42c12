"""Frequencies and linear buckling of an assembly about a converged state."""
