"""Element kernels of solids, and what they feed: stiffness, stresses, loads."""
