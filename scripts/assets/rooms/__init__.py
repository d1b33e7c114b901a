"""Interiors modelled by hand, for make_outside_rooms.py: the file (glb), meshes (shapes),
furniture, and the rooms themselves (homes, places, halls)."""
