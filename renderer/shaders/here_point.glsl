// Where light is asked for, set before shading: the vertices around, the point's weights among them,
// and where rays start.
uint here_vertices[3];
vec3 here_weights;
vec3 here_point;
