"""What the renderer's maps, tables and samples are by definition, in double precision.

The gate's figures hold a technique against the truth, and the split sum is wrong there by design: a
mistake of some percent would hide behind that. So what it precomputes is held against the integral
that it stands for, by quadrature, and how it puts them together against the formula.
"""
