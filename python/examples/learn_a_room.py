#!/usr/bin/env python3
"""A home, its light at points, and a toy network of PyTorch that learns it.

    learn_a_room.py [--seed 1] [--points 6000] [--rays 256] [--steps 600]

The network knows one room and its own lamps: lte_train's reads any scene. The arrays that lte
returns are PyTorch's without a copy.
"""
import argparse
import sys

import lte
import torch
from torch import nn

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("--seed", type=int, default=1)
parser.add_argument("--points", type=int, default=6000)
parser.add_argument("--rays", type=int, default=256)
parser.add_argument("--steps", type=int, default=600)
options = parser.parse_args([] if hasattr(sys, "ps1") else None)  # none in notebooks
torch.manual_seed(options.seed)

scene = lte.generate_scene("boxes", seed=options.seed)
points, normals = scene.sample(options.points, seed=1)
light = lte.trace.irradiance(scene, points, normals, rays=options.rays)
lit = light.indirect.mean(1) > 0.01 * light.indirect.mean()  # not what stands inside of furniture
at, side, target = (torch.from_numpy(array[lit]) for array in (points, normals, light.indirect))
low, high = (torch.from_numpy(corner) for corner in scene.bounds)
place = 2 * (at - low) / (high - low).max() - 1
# Sines of several frequencies let a small network follow light that changes fast.
waves = torch.cat([torch.sin(place * 2 ** k + turn) for k in range(4) for turn in (0, 1.57)], 1)
inputs, wanted = torch.cat([place, waves, side], 1), torch.log1p(target)

network = nn.Sequential(nn.Linear(inputs.shape[1], 64), nn.GELU(), nn.Linear(64, 64), nn.GELU(),
                        nn.Linear(64, 3))
optimizer = torch.optim.AdamW(network.parameters(), lr=1e-2)
schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, 1e-2, total_steps=options.steps)
train = len(inputs) * 9 // 10
for step in range(options.steps):
    chosen = torch.randint(train, (1024,))
    loss = nn.functional.mse_loss(network(inputs[chosen]), wanted[chosen])
    optimizer.zero_grad()
    loss.backward()
    optimizer.step()
    schedule.step()
with torch.no_grad():
    found = torch.expm1(network(inputs[train:]))


def median_error(answer):
    return ((answer - target[train:]).abs().mean(1) / target[train:].mean(1)).median()


print(f"{scene!r}: {train} points learned; median error at {len(found)} others "
      f"{100 * median_error(found):.1f} %, "
      f"of one constant {100 * median_error(target[:train].mean(0)):.1f} %")
