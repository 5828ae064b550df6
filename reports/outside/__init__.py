"""Two renderers from outside, as examples of candidates: VTK's and three.js's PBR."""
