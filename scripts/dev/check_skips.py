#!/usr/bin/env python3
"""Fails when a test was skipped that had no reason to be.

    scripts/dev/check_skips.py build/test-results

Reads the JSON files that GoogleTest leaves behind under GTEST_OUTPUT. A test may skip for one of
the reasons below, which depend on the machine; it says so with GTEST_SKIP() << reason.
"""
import json
import pathlib
import sys

REASONS = (
    "no CUDA device",  # only a build with CUDA has such tests
    "no /dev/full",
    "has no PyTorch",  # LTE_TORCH_PYTHON names a Python that has
)


def tests(folder: pathlib.Path):
    """(name, reason or None) of every test that has run."""
    for file in sorted(folder.glob("*.json")):
        for suite in json.loads(file.read_text())["testsuites"]:
            for test in suite["testsuite"]:
                name = f"{suite['name']}.{test['name']}"
                skipped = test.get("skipped")
                if test.get("result") == "SKIPPED":
                    yield name, (skipped[0].get("message", "") if skipped else "no reason given")
                elif test.get("result") == "COMPLETED":
                    yield name, None


def main() -> int:
    if len(sys.argv) != 2 or not (found := list(tests(pathlib.Path(sys.argv[1])))):
        print("check_skips: no results; usage: scripts/dev/check_skips.py build/test-results")
        return 2
    skipped = [(name, reason) for name, reason in found if reason is not None]
    unwarranted = [(name, reason) for name, reason in skipped
                   if not any(known in reason for known in REASONS)]
    for name, reason in unwarranted:
        print(f"check_skips: {name} was skipped: {reason.strip().splitlines()[-1:]}")
    print(f"check_skips: {len(found)} tests, {len(skipped)} skipped, "
          f"{len(unwarranted)} of them without a known reason")
    return 1 if unwarranted else 0


if __name__ == "__main__":
    sys.exit(main())
