"""docs/paper.md: every table and figure of the paper, and what was measured beside it."""
import json

from . import growth
from .rows import ROWS
from .words import digits

HEAD = """# The paper's tables and figures, measured here

`scripts/figures/paper.py ROW` measures a row, `--list` says what each costs, and `--keep ROW
--page` puts it here.

```sh no-run
scripts/figures/paper.py all --quick        # small data: 20 minutes of two cores
scripts/figures/paper.py all                # within a day of two cores
```

**What differs.** The paper trained 42 M parameters on 13,900 scenes for a week of four GPUs. Here
networks are lte-base (the model before lte; light solved on its scene points) or were trained for
minutes at width 32, with its stages; the paper's have a sixth more error after as many steps
([why](lab/learning.md#choices-in-the-network)). MSE is over the mean emission: not errors compare
with the paper's, but the order of rows. *Quick*: by `--quick`, few scenes, short trainings; ± is
half the distance of two seeds.

| paper | there | here | row |
|---|---|---|---|
"""

# Items without a row: what the paper has, where ours stands or why it does not, the command.
OTHERS = (
    ("Figures 4 to 6: pipeline, data", "diagrams",
     "[architecture.md](architecture.md), [dataset.md](dataset.md)", ""),
    ("Figure 3: attention", "picture", "drawn on demand",
     "`experiment_attention SCENE.glb --point X,Y,Z --out a.png`"),
    ("Our own parts, each taken out", "", "[lab](lab/learning.md)", "`experiments/ablation`"),
    ("Figure 8: full renderings", "pictures", "[README](../README.md)", "`lte_render`"),
    ("Table 2: structure", "42 M parameters", "41,932,803",
     "`lte_train --config configs/model/paper.yaml --dry-run`"),
    ("Radiance, spherical harmonics by degree", "curve", "[lab](lab/radiance.md)",
     "`experiment_directions`"),
    ("Glossy surfaces", "pictures", "[lab](lab/radiance.md)", "`lte_eval`"),
    ("Path guiding", "picture at 2 paths", "[lab](lab/radiance.md)", "`experiment_guiding`"),
    ("RenderFormer's scenes", "pictures", "[outside](../assets/scenes/outside/README.md)",
     "`scripts/assets/get_outside_scenes.py`"),
    ("Time by points, to a million", "linear", "[benchmarks](benchmarks.md#the-network)",
     "`lte_bench encoder`"),
    ("Time on a GPU", "208 + 368 ms", "[lab](lab/gpu.md)",
     "`lte_bench encoder`"),
)

PICTURE = """
![The living room at 2688x1152, gathered over lte-base's light, shown at a third]\
(images/paper_teaser.jpg)
"""

GROWTH = """
![Error of lte-paper by steps, a power law through one run whose rate falls, the paper's steps]\
(images/paper_growth.svg)
"""

AFTER = {"table1": """
Pictures of 256 x 192; MSE without the references' noise, SSIM and FLIP of denoised ones. The
rivals learnt for half an hour of one core, lte-base 52 times as long. lte-demo stood before
[lte-paper](lab/learning.md#one-run-from-nothing). By SSIM the order is the paper's. Sixteen paths
or gathered rays, denoised, are ahead of all networks: in pictures ours
[gathers](benchmarks.md#rooms-from-elsewhere).
"""}  # shown in full, and what follows


def cell(value):
    if value is None:
        return ""
    if isinstance(value, list):
        return "–".join(cell(each) for each in value)
    if isinstance(value, (int, float)):
        return f"{value:,}" if isinstance(value, int) else digits(value)
    return str(value)


def table(row, rows):
    """Without columns that an earlier run of the row had not."""
    columns = [(head, key) for head, key in row.columns
               if any(each.get(key) is not None for each in rows)]
    lines = ["|" + "|".join(head for head, _ in columns) + "|",
             "|---|" + "---:|" * (len(columns) - 1)]
    lines += ["|" + "|".join(cell(each.get(key)) for _, key in columns) + "|" for each in rows]
    return "\n".join(lines) + "\n"


def page(folder):
    """@param folder  of the rows' JSON, as paper.py writes it"""
    files = {row.name: json.loads((folder / f"{row.name}.json").read_text())
             for row in ROWS if (folder / f"{row.name}.json").exists()}
    text = HEAD
    for row in ROWS:
        found = files.get(row.name)
        here = row.line(found["rows"]) + (" *quick*" if found["quick"] else "") if found \
            else "not run, for want of time: {}; by `--quick` {}".format(*row.cost.split("; "))
        text += f"|{row.items}|{row.theirs}|{here}|{row.name}|\n"
    for item, there, here, command in OTHERS:
        text += f"|{item}|{there}|{here}|{command}|\n"
    for row in ROWS:
        if row.name in AFTER and row.name in files:
            found = files[row.name]
            text += (f"\n## {row.items}\n\n`{found['command']}`, {found['date']}, "
                     f"{found['machine']}.\n\n{table(row, found['rows'])}"
                     f"{'' if found['quick'] else AFTER[row.name]}")
    return text + (GROWTH if "growth" in files else "") + PICTURE


def charts(folder):
    """Pictures that the page shows of the rows, by name in docs/images."""
    path = folder / "growth.json"
    return {"paper_growth.svg": growth.chart(json.loads(path.read_text())["rows"])} \
        if path.exists() else {}
