// One object's material, as scenes.schema.Material resolves it.
struct Material {
    vec3 albedo;   // of the diffuse lobe, already scaled by 1 - metallic
    vec3 f0;       // of the whole surface, mixed by metallic
    float alpha;   // roughness squared
    vec2 weight_d; // shares of GGX and Beckmann in D
    vec2 weight_g; // and of their maskings in G
};
