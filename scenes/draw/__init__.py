"""Cases at random from a seed, as ordinary suites, scenes, materials, meshes and environments."""
