"""What a scene's surfaces do to one another's light: what blocks it, and what shines instead."""
