// The solid angle of mirror directions that a shading point stands for where normals turn within a
// pixel; set before shading. A lobe narrower than that is blurred by it, or of a mirror's fine
// reflections a few would stand for all.
float mirror_share = 0.0;
