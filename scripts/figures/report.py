#!/usr/bin/env python3
"""Writes report.html of a demo run: one self-contained page with pictures and tables of errors.

usage: scripts/figures/report.py OUT_DIR

OUT_DIR is what scripts/demo.sh leaves. The page needs Python's standard library alone. It links the
curves of the training, run/curves.svg, which scripts/figures/learning_curves.py draws.
"""
import base64
import html
import json
import pathlib
import sys

STYLESHEET = pathlib.Path(__file__).resolve().parents[2] / "lte/report/style.css"
METHODS = {
    "neural": "lte (this run)",
    "path_tracing_64": "path tracing, 64 samples",
    "constant_mean": "constant mean",
}
MODELS = (("shipped", "shipped model"), ("trained", "model of this run"))
STAGES = ("load", "sample", "light", "encode", "primary", "decode", "direct", "write", "total")


def image(path, alt):
    encoded = base64.b64encode(path.read_bytes()).decode()
    return f'<img alt="{html.escape(alt)}" src="data:image/png;base64,{encoded}">'


def figure(content, caption):
    return f"<figure>{content}<figcaption>{html.escape(caption)}</figcaption></figure>"


def picture(path, caption):
    return figure(image(path, caption), caption)


def difference(path, reference, caption):
    """The two pictures over one another; the stylesheet makes the browser subtract them."""
    both = image(reference, "") + image(path, caption)
    return figure(f'<div class="difference">{both}</div>', caption)


def table(head, rows, own=()):
    def line(cells, tag, kind=""):
        inner = "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in cells)
        return f"<tr{kind}>{inner}</tr>"

    body = [line(row, "td", ' class="own"' if i in own else "") for i, row in enumerate(rows)]
    return f"<div class=scroll><table>{line(head, 'th')}{''.join(body)}</table></div>"


def number(value):
    return "–" if value is None else f"{value:.4g}"


def error_tables(result):
    metrics = result["metrics"]
    names = [n for n in METHODS if n in metrics] + [n for n in metrics if n not in METHODS]
    rows = []
    for name in names:
        points, views = metrics[name]["points"], metrics[name]["views"]
        rows.append([METHODS.get(name, name)]
                    + [number(points.get(k)) for k in ("mse", "psnr", "relmse", "logrel")]
                    + [number(views.get(k)) for k in ("mse", "psnr", "ssim", "relmse")])
    head = ["predictor", "MSE", "PSNR", "relMSE", "logrel",
            "MSE (views)", "PSNR (views)", "SSIM (views)", "relMSE (views)"]
    return table(head, rows, own={names.index("neural")})


def scene_section(out, scene, title):
    reference = out / f"{scene}_reference.png"
    parts = [f'<h2>{html.escape(title)}</h2><div class="row">',
             picture(reference, "path-traced reference")]
    for model, who in MODELS:
        caption = f"{who}: predicted indirect + sampled direct light"
        parts.append(picture(out / f"{scene}_{model}.png", caption))
    parts.append("<br>")
    for model, who in MODELS:
        caption = f"{who}: |difference| of display values × 4"
        parts.append(difference(out / f"{scene}_{model}.png", reference, caption))
    rows = []
    for kind in ("reference", "shipped", "trained"):
        times = json.loads((out / f"{scene}_{kind}.json").read_text())
        rows.append([kind] + [f'{times["seconds"].get(stage, 0):.3f}' for stage in STAGES]
                    + [f'{times["peak_rss_mb"]:.0f}'])
    parts += ["</div>", table(["seconds", *STAGES, "peak MiB"], rows)]
    return "".join(parts)


def page_of(out):
    result = json.loads((out / "eval.json").read_text())
    yield "<!doctype html><html lang=en><meta charset=utf-8><title>lte demo</title>"
    yield '<meta name=viewport content="width=device-width, initial-scale=1">'
    yield f"<style>{STYLESHEET.read_text()}</style>"
    yield "<h1>lte: light transport embedding, demo report</h1>"
    yield ("<p>Rooms were generated and path-traced, a small model was trained on them, and it "
           "predicts the indirect light of rooms it has never seen. Direct light is sampled; the "
           "network adds everything after the first bounce.</p>")
    yield scene_section(out, "home",
                        "A home; the shipped model has learnt from others, this run's from none")
    yield scene_section(out, "room", "A room neither model has seen")
    yield scene_section(out, "cornell", "Cornell box (unlike any training room)")
    yield f"<h2>Error on {result['scenes']} unseen rooms</h2>" + error_tables(result)
    yield ('<p class="note">Irradiance over the mean emission; formulas in docs/metrics.md. A few '
           "minutes of training on a few rooms give a working model, not a good one: compare it "
           "with path tracing at 64 samples.</p>")
    for sheet in sorted((out / "eval").glob("*.png"))[:6]:
        yield picture(sheet, f"{sheet.stem}: indirect irradiance")
    yield '<p>Training: <a href="run/curves.svg">curves of the validation error</a>.</p>'


def main():
    if len(sys.argv) != 2:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    out = pathlib.Path(sys.argv[1])
    (out / "report.html").write_text("\n".join(page_of(out)))
    print(f"wrote {out / 'report.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
