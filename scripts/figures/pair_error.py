"""Error of the indirect light of pictures against two path-traced references of independent noise,
as `lte_eval scenes` finds it (docs/metrics.md): the mean of (x - A)(x - B), whose expectation has
no noise of theirs in it, over the pixels that see a surface which does not shine."""
import math
import statistics

from exr_layer import read_layer

LIGHT, EMISSION = ([f"{layer}.{c}" for c in "RGB"] for layer in ("indirect", "emission"))
CAP_QUANTILE, CAP_FACTOR = 0.999, 4  # larger values, which are fireflies, count as that
BLOCK = 8  # pixels of the edge of what the standard error is found by


class References:
    def __init__(self, a, b):
        pictures = [read_layer(path, *LIGHT, *EMISSION, "depth.Z") for path in (a, b)]
        self.size = pictures[0][:2]
        self.shown = [k for k in range(len(pictures[0][2][-1]))
                      if all(values[-1][k] > 0 and not any(e[k] for e in values[3:6])
                             for _, _, values in pictures)]
        light = [self.values(values) for _, _, values in pictures]
        means = sorted((x + y) / 2 for x, y in zip(*light))
        quantile = means[int(CAP_QUANTILE * (len(means) - 1))]
        self.cap = CAP_FACTOR * quantile if quantile > 0 else math.inf
        self.a, self.b = ([min(value, self.cap) for value in each] for each in light)
        self.mean = statistics.fmean(self.a + self.b)

    def values(self, channels):
        """Of the pixels that count, their red, green and blue in sequence."""
        return [channel[k] for k in self.shown for channel in channels[:3]]

    def noise(self):
        """Of one of them: root mean square, relative to the mean."""
        return math.sqrt(statistics.fmean((x - y)**2 for x, y in zip(self.a, self.b)) / 2) \
            / self.mean

    def error(self, path):
        """Root mean square, relative to the mean; one below its standard error counts as that."""
        width, height, channels = read_layer(path, *LIGHT)
        if (width, height) != self.size:
            raise ValueError(f"{path}: is {width}x{height}, its references are not")
        values = [min(value, self.cap) for value in self.values(channels)]
        products = [(x - a) * (x - b) for x, a, b in zip(values, self.a, self.b)]
        mse = statistics.fmean(products)
        blocks = {}
        for k, pixel in enumerate(self.shown):
            key = (pixel // width // BLOCK, pixel % width // BLOCK)
            blocks[key] = blocks.get(key, 0) + sum(products[3 * k:3 * k + 3]) - 3 * mse
        spread = sum(rest * rest for rest in blocks.values()) * len(blocks) / (len(blocks) - 1)
        return math.sqrt(max(mse, math.sqrt(spread) / len(products))) / self.mean
