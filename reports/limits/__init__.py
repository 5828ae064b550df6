"""How small an error the gate catches, and how often it fails what is right."""
