"""The GLSL that users run, over every hard input: stability.json."""
