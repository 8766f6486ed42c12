"""The mesh: its record, files, checks, surfaces, integration rules, generators of simple bodies."""
