"""Small pictures that repeat, made by `python -m scenes.textures`."""
