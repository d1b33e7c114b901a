#!/usr/bin/env python3
"""Infinigen's own infinigen_examples.generate_indoors without what cannot run off line: rocks that
need Blender's add-on extra_mesh_objects, and the attempts to install add-ons. Trinkets on shelves
are neither these rocks nor animals, which take a minute each. Takes the module's arguments.

usage: generate_home.py --seed N --task coarse --output_folder DIR ...
"""
import runpy

from infinigen.core import init


def no_addon(addon, fail="fatal", allow_online=False):
    if fail == "fatal":
        raise ValueError(f"Blender's add-on {addon} is not installed")
    return False


def main():
    init.require_blender_addon = no_addon
    from infinigen.assets.objects import creatures, rocks
    from infinigen.assets.objects.elements.nature_shelf_trinkets import generate
    trinkets = generate.NatureShelfTrinketsFactory
    left_out = (rocks.BlenderRockFactory, creatures.CarnivoreFactory, creatures.HerbivoreFactory)
    trinkets.probs = trinkets.probs * [kind not in left_out for kind in trinkets.factories]
    runpy.run_module("infinigen_examples.generate_indoors", run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main()
