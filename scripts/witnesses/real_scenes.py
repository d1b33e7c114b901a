#!/usr/bin/env python3
"""Renders a folder of anyone's scenes by the network and by path tracing, and compares.

usage: scripts/witnesses/real_scenes.py FOLDER [--out out/real-scenes] [--size 160x120] [--spp 256]
           [-- FLAGS OF lte_render]

FOLDER is searched for .gltf, .glb, .obj, .ply and .pbrt files, in its folders too; a .pbrt without
WorldBegin and a .ply that a .pbrt names are parts of others and left out. Each scene is rendered
twice from the same camera. A scene without light gets some, by `--add-light auto` where lte_render
has it, else by `--environment 1,1,1`. One that is too large is shrunk by --rescale. The page says
so.

OUT gets index.html, one self-contained page with the worst scene first, and results.json. Started
again, it renders only what is missing or was rendered with other options. Python's standard library
suffices. docs/real-scenes.md explains the figures and says where scenes are published.
"""
import argparse
import base64
import hashlib
import html
import json
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from exr import png, read_exr

ROOT = pathlib.Path(__file__).resolve().parents[2]
SUFFIXES = (".gltf", ".glb", ".obj", ".ply", ".pbrt")
BLOCK = 8  # pixels of a block's side
CLOSE = 0.05  # of the reference's mean radiance


# ---- Scenes ----


def named_by_pbrt(text):
    return {pathlib.PurePath(name).name for name in re.findall(r'"([^"\n]+\.ply)"', text)}


def scenes_in(folder):
    """The scenes of a folder in order, and how many parts of scenes were left out."""
    files = sorted(path for path in folder.rglob("*")
                   if path.is_file() and path.suffix.lower() in SUFFIXES)
    texts = {path: path.read_text(errors="replace") for path in files
             if path.suffix.lower() == ".pbrt"}
    parts = {path.parent / name for path, text in texts.items() for name in named_by_pbrt(text)}
    part_names = {path.name for path in parts}
    scenes = [path for path in files if not (
        path in texts and "WorldBegin" not in texts[path]
        or path.suffix.lower() == ".ply" and path.name in part_names)]
    return scenes, len(files) - len(scenes)


# ---- Running the tool ----


def run(command, timeout):
    """What became of a command: code (None after `timeout` seconds), seconds, memory, stderr."""
    started = time.monotonic()
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   stderr=errors, start_new_session=True)
        late = False
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() - started > timeout and not late:
                late = True
                os.killpg(process.pid, signal.SIGKILL)
            time.sleep(0.02)
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        text = errors.read().decode(errors="replace")
    return {"rc": None if late else process.returncode,
            "seconds": round(time.monotonic() - started, 2),
            "peak_mb": round(usage.ru_maxrss / 1024), "stderr": text}


def warnings_of(text):
    return [line[len("warning: "):] for line in text.splitlines() if line.startswith("warning: ")]


def traced_of(text):
    """What the picture has of path tracing in the network's place: metal, suns, skies."""
    return [line for line in text.splitlines() if "path-traced" in line]


def error_of(result, timeout):
    """The line that says why a run failed; empty if it did not."""
    if result["rc"] == 0:
        return ""
    if result["rc"] is None:
        return f"no end within {timeout:g} s"
    lines = [line for line in result["stderr"].splitlines()
             if line.strip() and not line.startswith("warning: ")]
    said = lines[-1] if lines else "no message"
    return said if result["rc"] in (1, 2) else f"ended by {result['rc']}: {said}"


def light_for(scene, tool, has_add_light, timeout):
    """Flags that give light to a scene that has none, and the warnings of looking at it."""
    look = run([tool, str(scene), "--validate-only"], timeout)
    if look["rc"] != 0 or "nothing emits light" not in look["stderr"]:
        return []
    return ["--add-light", "auto"] if has_add_light else ["--environment", "1,1,1"]


# ---- Figures ----


def luminance(pixel):
    return 0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2]


def blocks(picture, width, height, side=BLOCK):
    """Means of side x side pixels; those at the right and lower edge may be smaller."""
    out = []
    for top in range(0, height, side):
        for left in range(0, width, side):
            inside = [picture[y * width + x] for y in range(top, min(top + side, height))
                      for x in range(left, min(left + side, width))]
            out.append(tuple(sum(channel) / len(inside) for channel in zip(*inside)))
    return out


def relative_rmse(found, wanted):
    """Root mean square difference over pixels and channels, over the mean of what is wanted."""
    mean = sum(map(sum, wanted)) / (3 * len(wanted))
    if mean <= 0:
        return None
    square = sum((a - b)**2 for p, q in zip(found, wanted) for a, b in zip(p, q))
    return math.sqrt(square / (3 * len(wanted))) / mean


def reflected(layers):
    """Indirect light as the picture has it, times π. Irradiance alone would not do: where the
    centre of a pixel sees nothing, the reference divides what the rest of it sees by almost 0."""
    return [tuple(a * e for a, e in zip(albedo, irradiance))
            for albedo, irradiance in zip(layers["albedo"], layers["indirect"])]


def compare(found, wanted, width, height):
    found_mean, wanted_mean = (sum(map(luminance, picture)) for picture in (found, wanted))
    return {
        "ratio": found_mean / wanted_mean if wanted_mean > 0 else None,
        "rmse": relative_rmse(found, wanted),
        "block_rmse": relative_rmse(blocks(found, width, height), blocks(wanted, width, height)),
    }


def displayed(picture, width, height, exposure):
    def byte(value):
        value = min(max(value * exposure, 0), 1)
        curve = 12.92 * value if value <= 0.0031308 else 1.055 * value**(1 / 2.4) - 0.055
        return round(255 * curve)

    return png(bytes(byte(v) for pixel in picture for v in pixel[:3]), width, height)


def exposure_of(picture):
    bright = sorted(map(luminance, picture))[int(0.97 * (len(picture) - 1))]
    return 0.9 / bright if bright > 0 else 1


# ---- A scene ----


def rendered(scene, folder, arguments, has_add_light):
    """Renders and compares one scene; the record that results.json keeps."""
    tool = str(arguments.build / "bin" / "lte_render")
    light = light_for(scene, tool, has_add_light, arguments.timeout)
    record = {"added": " ".join(light), "warnings": [], "traced": [], "error": ""}
    both = {"network": [], "reference": ["--mode", "reference", "--spp", str(arguments.spp)]}
    if arguments.checkpoint:
        both["network"] = ["--checkpoint", str(arguments.checkpoint)]
    extra = []
    for name, flags in both.items():
        def attempt():
            picture = folder / f"{name}.exr"
            return run([tool, str(scene), "--out", str(picture), "--size", arguments.size, *flags,
                        *light, *extra, *arguments.flags], arguments.timeout)

        result = attempt()
        if result["rc"] == 1 and "--rescale" in result["stderr"] and not extra:
            extra.append("--rescale")
            record["added"] = " ".join([*light, *extra])
            result = attempt()
        record[name] = {key: result[key] for key in ("rc", "seconds", "peak_mb")}
        for line in warnings_of(result["stderr"]):
            if line not in record["warnings"]:
                record["warnings"].append(line)
        if name == "network":
            record["traced"] = traced_of(result["stderr"])
        record["error"] = error_of(result, arguments.timeout).removeprefix("lte_render: ").replace(
            str(scene), scene.name)
        if record["error"]:
            return record
    width, height, network = read_exr(folder / "network.exr")
    reference = read_exr(folder / "reference.exr")[2]
    record.update(compare(network[""], reference[""], width, height))
    record["indirect"] = compare(*map(reflected, (network, reference)), width, height)
    exposure = exposure_of(reference[""])
    for name, layers in (("network", network), ("reference", reference)):
        (folder / f"{name}.png").write_bytes(displayed(layers[""], width, height, exposure))
        (folder / f"{name}.exr").unlink()
    return record


def key_of(scene, arguments):
    """Changes with whatever changes the result."""
    told = scene.stat()
    parts = (str(scene), told.st_size, told.st_mtime_ns, arguments.size, arguments.spp,
             str(arguments.checkpoint), arguments.flags, arguments.version, arguments.built,
             pathlib.Path(__file__).read_bytes())
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def record_of(scene, name, arguments, has_add_light):
    """The kept record of a scene, or a new one."""
    folder = arguments.out / "scenes" / hashlib.sha256(name.encode()).hexdigest()[:16]
    kept, key = folder / "record.json", key_of(scene, arguments)
    if kept.exists():
        record = json.loads(kept.read_text())
        if record.get("key") == key:
            return record, folder, True
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    record = {"scene": name, "key": key, **rendered(scene, folder, arguments, has_add_light)}
    kept.with_suffix(".part").write_text(json.dumps(record, indent=1))
    kept.with_suffix(".part").rename(kept)
    return record, folder, False


# ---- The page ----


def badness(record):
    """Worst first: failures, then by the error of blocks; black pictures, which have none, last."""
    if record["error"]:
        return (0, 0)
    return (1, -record["block_rmse"]) if record["block_rmse"] is not None else (2, 0)


def is_close(record):
    return not record["error"] and record["ratio"] is not None and abs(record["ratio"] - 1) <= CLOSE


def summary(records, left_out):
    drawn = [r for r in records if not r["error"]]
    black = sum(r["ratio"] is None for r in drawn)
    off = [r for r in drawn if r["ratio"] is not None and not is_close(r)]
    silent = sum(not r["warnings"] for r in off)
    text = (f"{len(records)} scenes: {sum(map(is_close, records))} within {CLOSE:.0%} of the "
            f"reference's mean radiance, {len(off)} farther off ({silent} of them without a "
            f"warning), {black} black in the reference, {len(records) - len(drawn)} refused or "
            f"failed; {sum(bool(r['warnings']) for r in drawn)} drawn with a warning, "
            f"{sum(bool(r['traced']) for r in drawn)} with paths for metal, suns or skies")
    return text + (f"; {left_out} files are parts of other scenes" if left_out else "")


def figure(value, pattern="{:.3f}"):
    return "–" if value is None else pattern.format(value)


def picture(path, caption):
    encoded = base64.b64encode(path.read_bytes()).decode()
    return (f'<figure><img alt="{caption}" src="data:image/png;base64,{encoded}">'
            f"<figcaption>{caption}</figcaption></figure>")


def failures_html(records):
    """Those that were not drawn, one line each."""
    if records:
        yield "<h2>Refused or failed</h2><div class=text><div class=scroll><table>"
        for record in records:
            code = record.get("reference", record["network"])["rc"]
            cells = (record["scene"], "timeout" if code is None else f"rc {code}", record["error"])
            yield "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>"
        yield "</table></div></div>"


def scene_html(record, folder):
    yield f"<h2>{html.escape(record['scene'])}</h2>"
    yield (f"<p>ratio <b>{figure(record['ratio'])}</b>, 8×8 blocks "
           f"<b>{figure(record['block_rmse'])}</b>, pixels {figure(record['rmse'])} · indirect "
           f"light {figure(record['indirect']['ratio'])}, "
           f"{figure(record['indirect']['block_rmse'])}, "
           f"{figure(record['indirect']['rmse'])} · network "
           f"{record['network']['seconds']:.1f} s, {record['network']['peak_mb']} MiB · "
           f"reference {record['reference']['seconds']:.1f} s, "
           f"{record['reference']['peak_mb']} MiB</p>")
    yield "<div class=grid>" + picture(folder / "network.png", "network") + picture(
        folder / "reference.png", "path tracing") + "</div>"
    if record["added"]:
        yield f"<p class=note>added: {html.escape(record['added'])}</p>"
    for line in record["traced"]:
        yield f"<p class=note>{html.escape(line)}</p>"
    if record["warnings"]:
        yield "<ul class=note>" + "".join(
            f"<li>{html.escape(line)}</li>" for line in record["warnings"]) + "</ul>"


def page(records, folders, head, note):
    style = (ROOT / "lte" / "report" / "style.css").read_text()
    yield "<!doctype html><html lang=en><meta charset=utf-8><title>Real scenes</title>"
    yield '<meta name=viewport content="width=device-width, initial-scale=1">'
    yield f"<style>{style}</style><h1>Network and path tracing on real scenes</h1>"
    yield f"<p class=headline>{html.escape(head)}</p><p class=note>{html.escape(note)}</p>"
    yield ("<p class=note>Ratio: mean luminance of the network's picture over the reference's. "
           "Blocks, pixels: root mean square difference over the mean of the reference, of means "
           "over 8×8 pixels and of pixels; then the same of reflected indirect light alone. "
           "Pictures of a scene share an exposure.</p>")
    yield from failures_html([record for record in records if record["error"]])
    for record in records:
        if not record["error"]:
            yield from scene_html(record, folders[record["scene"]])
    yield "</html>"


def table(records):
    """Markdown."""
    yield ("| scene | ratio | 8×8 | pixels | indirect: ratio | 8×8 | pixels | s | MiB | added | "
           "says |")
    yield "|---|---|---|---|---|---|---|---|---|---|---|"
    for r in records:
        says = r["error"] or ", ".join(
            ([f"{len(r['warnings'])} warnings"] if r["warnings"] else [])
            + (["paths"] if r["traced"] else []))
        yield (f"| {r['scene']} | {figure(r.get('ratio'))} | {figure(r.get('block_rmse'))} | "
               f"{figure(r.get('rmse'))} | "
               + "".join(f"{figure(r.get('indirect', {}).get(key))} | "
                         for key in ("ratio", "block_rmse", "rmse"))
               + f"{figure(r['network']['seconds'], '{:.1f}')} | "
               f"{r['network']['peak_mb']} | {r['added']} | {says} |")


def parsed():
    parser = argparse.ArgumentParser(description=__doc__,
                                     epilog="What stands after -- goes to lte_render, both times.",
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/real-scenes"))
    parser.add_argument("--size", default="160x120")
    parser.add_argument("--spp", type=int, default=256, help="paths a pixel of the reference")
    parser.add_argument("--timeout", type=float, default=300, help="seconds of each rendering")
    parser.add_argument("--checkpoint", type=pathlib.Path, help="model; by default the shipped one")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--markdown", action="store_true", help="print the table too")
    # By hand, as argparse gives a last positional nothing where flags stand between it and another.
    at = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    arguments = parser.parse_args(sys.argv[1:at])
    arguments.flags = sys.argv[at + 1:]
    if not arguments.folder.is_dir():
        parser.error(f"{arguments.folder}: no such folder")
    tool = arguments.build / "bin" / "lte_render"
    if not tool.exists():
        parser.error(f"{tool}: not there; build lte or name its folder with --build")
    return arguments


def main():
    arguments = parsed()
    tool = str(arguments.build / "bin" / "lte_render")
    said = lambda flag: subprocess.run([tool, flag], capture_output=True, text=True).stdout
    arguments.version = said("--version").strip()
    arguments.built = pathlib.Path(tool).stat().st_mtime_ns
    has_add_light = "--add-light" in said("--help")
    scenes, left_out = scenes_in(arguments.folder)
    if not scenes:
        sys.exit(f"{arguments.folder}: no {', '.join(SUFFIXES)} in it")
    records, folders = [], {}
    for i, scene in enumerate(scenes, 1):
        name = scene.relative_to(arguments.folder).as_posix()
        record, folders[name], kept = record_of(scene, name, arguments, has_add_light)
        records.append(record)
        state = record["error"] or f"ratio {figure(record['ratio'])}, blocks " + figure(
            record["block_rmse"])
        print(f"{i}/{len(scenes)} {name}: {state}{' (kept)' if kept else ''}", flush=True)
    records.sort(key=badness)
    head = summary(records, left_out)
    note = (f"{arguments.version}, {arguments.size}, {arguments.spp} paths a pixel, "
            f"{time.strftime('%Y-%m-%d')}")
    (arguments.out / "index.html").write_text("\n".join(page(records, folders, head, note)))
    (arguments.out / "results.json").write_text(
        json.dumps({"summary": head, "note": note, "scenes": records}, indent=1) + "\n")
    if arguments.markdown:
        print("\n".join(table(records)))
    print(f"{head}\n{arguments.out / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
