"""Shells and beams of job files and of Python: surface and line meshes with sections, made solid."""
