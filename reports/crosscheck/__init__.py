"""The truth held against a second path tracer, Blender's Cycles, as a candidate from outside.

`python -m reports.crosscheck PYTHON CASE OUT` draws a case under a Python that has `bpy`.
docs/crosscheck.md tells how to run it and what came of it.
"""
