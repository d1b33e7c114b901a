"""The programs of lte that need LibTorch. The package `lte` finds and runs them."""

import pathlib

from lte_torch._built import torch as torch

#: Has `lte train`, `lte export` and `lte bench`.
program = pathlib.Path(__file__).parent / "bin" / "lte"
