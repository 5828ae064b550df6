"""Does the GLSL compute the model? Per direction, beside Mitsuba and double precision."""
