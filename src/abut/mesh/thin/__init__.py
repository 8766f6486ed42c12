"""Shells and beams expanded into solid cells."""
