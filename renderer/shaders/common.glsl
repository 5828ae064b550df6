// Constants. Directions are unit vectors in the tangent frame (n = +z) unless a name says world.
const float PI = 3.14159265358979;
const float INV_PI = 0.318309886183791;
