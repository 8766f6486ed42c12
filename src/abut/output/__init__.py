"""The output directory: results, fields, restart files."""
