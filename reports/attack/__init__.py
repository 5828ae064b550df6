"""The gate under attack: shader bugs injected into copies of the renderer, each through the gate."""
