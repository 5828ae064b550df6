"""What is wrong with an outside renderer, in words."""
