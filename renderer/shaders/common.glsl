// Constants. Directions are unit vectors in the tangent frame (n = +z) unless a name says world.
const float PI = 3.14159265358979;
const float INV_PI = 0.318309886183791;
// 1 - u of the last float32 below 1: only u = 1, which rounding can make, falls short of it.
const float LEAST_REST = 1.0 / 16777216.0;
