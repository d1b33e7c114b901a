#!/usr/bin/env python3
"""Fails when a test was skipped that had no reason to be.

    scripts/dev/check_skips.py build/test-results

Reads the JSON files that GoogleTest leaves behind under GTEST_OUTPUT. The tests below may skip, as
what they need depends on the machine.
"""
import fnmatch
import json
import pathlib
import sys

# Tests that may skip, by name: GoogleTest before 1.13 leaves the reason out of its JSON.
WARRANTED = {
    "*Cuda*": "no CUDA device",  # only a build with CUDA has such tests
    "*FullDisk*": "no /dev/full",
    "*Passive*": "one processor, or the sanitizer takes all addresses",
    "CanStartThreads.*": "the sanitizer takes all addresses",
    "CApi.ThreadsSleepBetweenCalls": "one processor",
    "Engines.Blender*": "no Python with bpy (LTE_BPY_PYTHON)",
    "Engines.Three*": "no Chromium, or no three.js",  # scripts/setup.sh --tests takes the latter
    "Ktx2Files.PyKtx2*": "no pyktx2",  # scripts/setup.sh --tests installs it
    "OidnLibrary.*": "no Open Image Denoise",  # scripts/setup.sh installs it
    "NcclGroup.*": "no CUDA device",
    "Videos.Ffmpeg*": "no ffmpeg",
    "TorchscriptExample.PythonGivesTheAnswersOfCpp": "no Python with PyTorch (LTE_TORCH_PYTHON)",
}


def tests(folder: pathlib.Path):
    """(name, whether it was skipped) of every test that has run."""
    for file in sorted(folder.glob("*.json")):
        for suite in json.loads(file.read_text())["testsuites"]:
            for test in suite["testsuite"]:
                if test.get("result") in ("SKIPPED", "COMPLETED"):
                    yield f"{suite['name']}.{test['name']}", test["result"] == "SKIPPED"


def main() -> int:
    if len(sys.argv) != 2 or not (found := list(tests(pathlib.Path(sys.argv[1])))):
        print("check_skips: no results; usage: scripts/dev/check_skips.py build/test-results")
        return 2
    skipped = sorted({name for name, was_skipped in found if was_skipped})
    unwarranted = []
    for name in skipped:
        reason = next((r for known, r in WARRANTED.items() if fnmatch.fnmatch(name, known)), None)
        print(f"check_skips: {name} was skipped: {reason or 'for no known reason'}")
        if reason is None:
            unwarranted.append(name)
    print(f"check_skips: {len(found)} tests, {len(skipped)} skipped, "
          f"{len(unwarranted)} of them without a known reason")
    return 1 if unwarranted else 0


if __name__ == "__main__":
    sys.exit(main())
