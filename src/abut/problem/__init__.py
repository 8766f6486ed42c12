"""The discrete problem: constraints, bodies, loads and contact pairs on the free displacements."""
