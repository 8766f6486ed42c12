"""The contact operator: segments, multiplier spaces, laws. It knows surfaces only, no solids; other codes may call it."""
