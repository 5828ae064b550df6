"""How far apart the answers are, what each cost, and whether that is good enough."""
