"""A live window on a suite: look around, and change what is drawn."""
