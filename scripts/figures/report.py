#!/usr/bin/env python3
"""Writes report.html of a demo run: one self-contained page with pictures, loss curve and tables.

usage: scripts/figures/report.py OUT_DIR      (Python's standard library alone)
"""
import base64
import html
import json
import pathlib
import struct
import sys
import zlib

STYLE = """
body{font:15px/1.5 system-ui,sans-serif;max-width:1180px;margin:2em auto;padding:0 1em;color:#222}
h1{font-size:1.6em}h2{margin-top:1.8em;border-bottom:1px solid #ddd}table{border-collapse:collapse;margin:1em 0}
td,th{padding:.25em .8em;text-align:right;border-bottom:1px solid #eee}td:first-child,th:first-child{text-align:left}
tr.own{background:#eef6ff;font-weight:600}figure{display:inline-block;margin:.4em;vertical-align:top;width:31%}
figure.wide{width:98%}img{width:100%;image-rendering:auto;border:1px solid #ccc}figcaption{font-size:.85em;color:#555}
.note{color:#555;font-size:.9em}svg{background:#fafafa;border:1px solid #ddd}
"""
METHODS = {
    "neural": "lte (this run)",
    "path_tracing_64": "path tracing, 64 samples",
    "constant_mean": "constant mean",
    "nearest_point": "nearest scene point's training mean",
    "blurred_direct": "direct light, blurred",
}


def read_png(path):
    """Width, height and RGB bytes of an 8-bit PNG without interlacing, as lte writes them."""
    raw = path.read_bytes()
    width, height, depth, kind = struct.unpack(">IIBB", raw[16:26])
    channels = {0: 1, 2: 3, 6: 4}[kind]
    assert depth == 8, f"{path}: not 8 bit"
    packed, at = b"", 8
    while at < len(raw):
        size, name = struct.unpack(">I4s", raw[at : at + 8])
        if name == b"IDAT":
            packed += raw[at + 8 : at + 8 + size]
        at += size + 12
    data, stride = zlib.decompress(packed), width * channels
    previous, rows = bytearray(stride), []
    for y in range(height):
        start = y * (stride + 1)
        row = unfilter(data[start], bytearray(data[start + 1 : start + 1 + stride]), previous, channels)
        rows.append(row)
        previous = row
    return width, height, channels, rows


def unfilter(kind, row, above, step):
    """Undoes a PNG row filter (PNG specification, section 9)."""
    for i in range(len(row)):
        left, up, corner = (row[i - step] if i >= step else 0), above[i], (above[i - step] if i >= step else 0)
        if kind == 1:
            row[i] = (row[i] + left) & 255
        elif kind == 2:
            row[i] = (row[i] + up) & 255
        elif kind == 3:
            row[i] = (row[i] + (left + up) // 2) & 255
        elif kind == 4:
            guess = left + up - corner
            best = min((left, up, corner), key=lambda v: abs(guess - v))
            row[i] = (row[i] + best) & 255
    return row


def difference_png(a, b, gain):
    """|a − b| of display values times `gain`, as PNG bytes."""
    width, height, channels, rows_a = read_png(a)
    other = read_png(b)
    assert other[:3] == (width, height, channels), f"{a} and {b} differ in size"
    rows = b"".join(
        b"\0" + bytes(min(255, gain * abs(x - y)) for x, y in zip(row_a, row_b)) for row_a, row_b in zip(rows_a, other[3])
    )
    kind = {1: 0, 3: 2, 4: 6}[channels]

    def chunk(name, body):
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    header = struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


def figure(png, caption, kind=""):
    encoded = base64.b64encode(png).decode()
    return (f'<figure class="{kind}"><img alt="{html.escape(caption)}" src="data:image/png;base64,{encoded}">'
            f"<figcaption>{html.escape(caption)}</figcaption></figure>")


def table(head, rows, own=()):
    cells = lambda row, tag: "".join(f"<{tag}>{html.escape(str(c))}</{tag}>" for c in row)
    body = "".join(f'<tr{" class=own" if i in own else ""}>{cells(row, "td")}</tr>' for i, row in enumerate(rows))
    return f"<table><tr>{cells(head, 'th')}</tr>{body}</table>"


def number(value):
    return "–" if value is None else f"{value:.4g}"


def loss_curve(log_path):
    """An SVG of training and validation loss over steps, logarithmic in the loss."""
    import math

    records = [json.loads(line) for line in log_path.read_text().splitlines() if line.strip()]
    train = [(r["step"], r["loss"]) for r in records if r.get("loss")]
    val = [(r["step"], r["val_loss"]) for r in records if r.get("val_loss")]
    window = max(1, len(train) // 60)
    smooth = [(train[i][0], sum(l for _, l in train[i : i + window]) / len(train[i : i + window]))
              for i in range(0, len(train), window)]
    values = [l for _, l in smooth + val]
    low, high, last = math.log10(min(values)), math.log10(max(values)), max(s for s, _ in smooth + val)
    span = max(high - low, 1e-6)
    place = lambda s, l: f"{60 + 800 * s / last:.1f},{20 + 240 * (high - math.log10(l)) / span:.1f}"
    line = lambda points, color: (f'<polyline fill="none" stroke="{color}" stroke-width="2" '
                                   f'points="{" ".join(place(*p) for p in points)}"/>')
    ticks = "".join(f'<text x="4" y="{24 + 240 * i / 4:.0f}" font-size="12">{10 ** (high - span * i / 4):.3g}</text>'
                    for i in range(5))
    return (f'<svg viewBox="0 0 900 300" width="100%">{ticks}{line(smooth, "#0072b2")}{line(val, "#d55e00")}'
            f'<text x="820" y="290" font-size="12">step {last}</text>'
            '<text x="640" y="20" font-size="13" fill="#0072b2">training loss</text>'
            '<text x="750" y="20" font-size="13" fill="#d55e00">validation loss</text></svg>')


def error_tables(result):
    metrics = result["metrics"]
    names = [n for n in METHODS if n in metrics] + [n for n in metrics if n not in METHODS]
    rows = []
    for name in names:
        points, views = metrics[name]["points"], metrics[name]["views"]
        rows.append([METHODS.get(name, name)] + [number(points.get(k)) for k in ("mse", "psnr", "relmse", "logrel")]
                    + [number(views.get(k)) for k in ("mse", "psnr", "ssim", "relmse")])
    head = ["predictor", "MSE", "PSNR", "relMSE", "logrel", "MSE (views)", "PSNR (views)", "SSIM (views)", "relMSE (views)"]
    return table(head, rows, own={names.index("neural")})


def scene_section(out, scene, title):
    reference = out / f"{scene}_reference.png"
    parts = [f"<h2>{html.escape(title)}</h2>"]
    parts.append(figure(reference.read_bytes(), "path-traced reference"))
    for model, caption in (("shipped", "shipped model"), ("trained", "model of this run")):
        parts.append(figure((out / f"{scene}_{model}.png").read_bytes(), f"{caption}: predicted indirect + sampled direct light"))
    parts.append("<br>")
    for model, caption in (("shipped", "shipped model"), ("trained", "model of this run")):
        parts.append(figure(difference_png(out / f"{scene}_{model}.png", reference, 4), f"{caption}: |difference| of display values × 4"))
    stages = ("load", "sample", "light", "encode", "primary", "decode", "direct", "write", "total")
    rows = []
    for kind in ("reference", "shipped", "trained"):
        times = json.loads((out / f"{scene}_{kind}.json").read_text())
        rows.append([kind] + [f'{times["seconds"].get(s, 0):.3f}' for s in stages] + [f'{times["peak_rss_mb"]:.0f}'])
    parts.append(table(["seconds"] + list(stages) + ["peak MiB"], rows))
    return "".join(parts)


def main():
    if len(sys.argv) != 2:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    out = pathlib.Path(sys.argv[1])
    result = json.loads((out / "eval.json").read_text())
    page = ["<!doctype html><html lang=en><meta charset=utf-8><title>lte demo</title>", f"<style>{STYLE}</style>",
            "<h1>lte: light transport embedding, demo report</h1>",
            "<p>Rooms were generated and path-traced, a small model was trained on them, and it predicts the indirect light of "
            "rooms it has never seen. Direct light is sampled; the network adds everything after the first bounce.</p>",
            scene_section(out, "room", "A room neither model has seen"),
            scene_section(out, "cornell", "Cornell box (unlike any training room)"),
            f"<h2>Error on {result['scenes']} unseen rooms</h2>", error_tables(result),
            '<p class="note">Irradiance over the emission scalar; formulas in docs/metrics.md. A few minutes of training on a few '
            "rooms give a working model, not a good one: compare with path tracing at 64 samples.</p>"]
    for sheet in sorted((out / "eval").glob("*.png"))[:6]:
        page.append(figure(sheet.read_bytes(), f"{sheet.stem}: indirect irradiance", "wide"))
    page += ["<h2>Training</h2>", loss_curve(out / "run" / "log.jsonl")]
    (out / "report.html").write_text("\n".join(page))
    print(f"wrote {out / 'report.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
