"""Linear systems: direct and iterative solvers, static condensation, preconditioners."""
