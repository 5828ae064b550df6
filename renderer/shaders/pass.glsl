// What a pass over an object's pixels is told.
uniform float finest_alpha; // the least width of the object's lobes
uniform ivec2 turn; // which part of the pixels' shading points, or directions, it does, of how many
