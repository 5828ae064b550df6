"""The real-time side: a GLSL physically-based renderer on moderngl."""
