#!/usr/bin/env python3
"""scripts/dev/check_readme.py on pages written by hand and a program that copies a file."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "dev" / "check_readme.py"
PROGRAM = """#!/bin/sh
case "$*" in
  *--help*) printf 'Options:\\n  --out TEXT\\n  --size WxH\\n\\nSubcommands:\\n  sub  More\\n' ;;
  *--size\\ 16x12*) cp "$1" "$3" && echo run >> "$0.log" ;;
  *) exit 3 ;;
esac
"""
GOOD = "lte_tool assets/in.txt --out copy.txt \\\n    --size 64x48   # a comment"


def page(*lines, fence="sh"):
    return "\n".join(["Text.", "", f"```{fence}", *lines, "```", ""])


class CheckReadme(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for name in ("docs", "assets", "build/bin"):
            (self.root / name).mkdir(parents=True)
        (self.root / "assets/in.txt").write_text("in\n")
        tool = self.root / "build/bin/lte_tool"
        tool.write_text(PROGRAM)
        tool.chmod(0o755)

    def check(self, readme, *options, docs="", code=0):
        (self.root / "README.md").write_text(readme)
        (self.root / "docs/page.md").write_text(docs)
        done = subprocess.run([sys.executable, SCRIPT, "--root", str(self.root), *options],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout

    def runs(self):
        log = self.root / "build/bin/lte_tool.log"
        return log.read_text().count("run") if log.exists() else 0

    def test_commands_of_all_pages_are_counted_and_run_small(self):
        second = "lte_tool copy.txt --out more.txt --size 64x48"
        out = self.check(page(GOOD, second), "--run", docs=page(GOOD))
        self.assertIn("0 faults in 3 commands", out)
        self.assertEqual(self.runs(), 3)

    def test_nothing_runs_without_the_flag(self):
        self.check(page(GOOD))
        self.assertEqual(self.runs(), 0)

    def test_a_flag_that_does_not_exist_is_named(self):
        out = self.check(page("lte_tool assets/in.txt --oat copy.txt"), code=1)
        self.assertIn("README.md: lte_tool assets/in.txt --oat copy.txt: "
                      "lte_tool has no flag --oat", out)

    def test_a_file_that_nothing_wrote_is_named(self):
        self.assertIn("assets/gone.txt is neither",
                      self.check(page(GOOD), docs=page("lte_tool assets/gone.txt"), code=1))
        # What another page wrote does not count.
        self.assertIn("copy.txt is neither",
                      self.check(page(GOOD), docs=page("lte_tool copy.txt"), code=1))

    def test_a_program_that_does_not_exist_is_named(self):
        self.assertIn("lte_toll is no program", self.check(page("lte_toll x"), code=1))
        self.assertIn("make is no program", self.check(page("make all"), code=1))

    def test_a_command_that_fails_is_named_with_its_exit_code(self):
        out = self.check(page("lte_tool assets/in.txt --out copy.txt"), "--run", code=1)
        self.assertIn("exit code 3", out)

    def test_blocks_that_are_not_to_run_have_their_flags_checked_alone(self):
        out = self.check(page(GOOD), "--run",
                         docs=page("lte_tool your.txt --out x.txt", "make all", fence="sh no-run"))
        self.assertIn("0 faults in 3 commands", out)
        self.assertEqual(self.runs(), 1)
        self.assertIn("has no flag --oat",
                      self.check(page("lte_tool your.txt --oat x", fence="sh no-run"), code=1))

    def test_an_unknown_mark_is_a_fault(self):
        self.assertIn('"sh no-run"', self.check(page(GOOD, fence="sh norun"), code=1))

    def test_flags_of_a_subcommand_count(self):
        self.check(page("lte_tool sub --size 16x12"))

    def test_programs_in_c_are_compiled(self):
        self.check(page(GOOD) + page("#include <stddef.h>", "size_t x;", fence="c"))
        out = self.check(page(GOOD) + page("#include <stddef.h>", "size_t x = y;", fence="c"),
                         code=1)
        self.assertIn("does not compile", out)

    def test_pages_without_a_command_are_a_fault(self):
        self.check("Text.\n", code=1)


if __name__ == "__main__":
    unittest.main()
