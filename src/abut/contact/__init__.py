"""The mortar contact operator: segments, multiplier spaces, laws, for surfaces; independent of solids, so that other codes
may call it."""
