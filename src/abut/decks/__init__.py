"""Abaqus and CalculiX decks: what they say (``cards``), and the model that is meant (``translation``)."""
