"""One job on many processes: MPI between them, PETSc for matrices and solvers."""
