"""What is drawn: scenes, materials, environments and meshes, as both renderers read them."""
