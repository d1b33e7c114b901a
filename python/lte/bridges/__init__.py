"""Scenes of other programs: each becomes a .glb, which lte reads as any other file."""
