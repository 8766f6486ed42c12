"""abut check: what is wrong with a model, and the cure, before it is solved."""
