"""What is solved: constraints, loads, contact pairs on the free displacements, put together."""
