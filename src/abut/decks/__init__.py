"""Abaqus and CalculiX decks: their cards (``cards``), and their translation into a model (``translation``)."""
