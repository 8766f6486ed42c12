"""Newton iterations, searches for the contact status, load steps."""
