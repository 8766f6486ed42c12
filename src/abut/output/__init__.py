"""What a run leaves behind: results, fields, restart files."""
