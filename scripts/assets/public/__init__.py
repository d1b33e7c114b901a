"""Interiors published by others, for get_outside_scenes.py: where they are (sources), how a
repository is read, and what makes a .glb of other renderers' files (convert, gltf_edit)."""
