"""Element integrals of solids: stiffness, stresses, loads."""
