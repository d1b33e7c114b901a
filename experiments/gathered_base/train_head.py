#!/usr/bin/env python3
"""Learns to combine gathered rays with the network's answer at the same point, and what error the
combination has; prints what that is worth beside the best constant share.

  experiment_gathered_base ROOM.glb --paths 1024 --arrays rooms/ROOM.safetensors    # a room
  experiments/gathered_base/train_head.py --train rooms --report other_rooms --table network

The answer is s B + (1 - s) f by channel: B the mean of 16 rays that read --table, and f --second:
network, asked at the point and kept within e^1.1 of the light that it starts from; solved, that
light itself; or rays, the middle half of the rays, which needs neither. Each fourth room of --train
is held out: of the steps the one with the least error there counts. Rooms of --report only appear
in the last table. Errors are mean((x - A)(x - B)) of two references, as equal-error paths a point,
and their geometric means over rooms. Needs NumPy.
"""
import argparse
import json
import math
import pathlib
import struct

import numpy

BOUND, CAP_QUANTILE, CAP_FACTOR, FEW = 1.1, 0.999, 4, 64
STEPS, RATE, HIDDEN = 240, 1e-2, 24
FLOOR, LIKELIHOOD = 1e-2, 0.1  # of deviations, over the room's mean; share of the second loss


def read_arrays(path):
    data = path.read_bytes()
    size, = struct.unpack("<Q", data[:8])
    arrays = {}
    for name, entry in json.loads(data[8:8 + size]).items():
        if name == "__metadata__":
            continue
        begin, end = (8 + size + at for at in entry["data_offsets"])
        arrays[name] = numpy.frombuffer(data[begin:end], "<f4").reshape(entry["shape"])
    return arrays


class Room:
    """A room's points: answers, inputs of the head, references."""

    def __init__(self, path, table, second):
        arrays = read_arrays(path)
        self.name = path.stem
        mean = 0.5 * (arrays["a"] + arrays["b"])
        quantile = numpy.sort(mean, None)[int(CAP_QUANTILE * (mean.size - 1))]

        def capped(values):
            return numpy.minimum(values, CAP_FACTOR * quantile)

        self.a, self.b = capped(arrays["a"]), capped(arrays["b"])
        self.level = capped(mean).mean()
        self.noise = numpy.square(self.a - self.b).mean() / 4  # variance of (A + B)/2
        rays, distance = arrays["rays/" + table], arrays["distance"]
        prior, least = arrays["prior"], 1e-4 * self.level
        if second == "rays":
            quarter = rays.shape[1] // 4
            prior = numpy.sort(rays, 1)[:, quarter:-quarter].mean(1) + 1e-3 * self.level
        decoded = arrays["decoded"] if second == "network" else prior
        factor = numpy.log((decoded + least) / (prior + least))
        self.decoded = capped(decoded)
        self.gathered = capped(rays.mean(1))
        self.f = capped((prior + least) * numpy.exp(factor.clip(-BOUND, BOUND)))
        self.few_mse = self.mse(capped(arrays["few"]))
        self.spread = rays.var(1, ddof=1) / rays.shape[1]
        self.inputs = self.describe(rays, distance, prior, least)

    def describe(self, rays, distance, prior, least):
        """[points, 3, inputs]"""
        log = numpy.log
        grey = numpy.sort(rays.mean(2), 1)
        count = grey.shape[1]
        level = grey.mean(1) + least
        far = numpy.minimum(distance, 30)
        of_point = numpy.stack([
            log(1 + numpy.minimum(grey.std(1, ddof=1) / level, 8)),
            grey[:, -1] / (count * level),
            (grey <= 0).mean(1),
            log((grey[:, count // 4:-count // 4].mean(1) + least) / level),
            numpy.isinf(distance).mean(1),
            log(far.mean(1)),
            -log((1 / numpy.maximum(far, 1e-3)).mean(1)),
            (distance < 0.15).mean(1),
            (distance < 0.5).mean(1),
            (distance < 1.5).mean(1),
        ], 1)
        gathered, f, prior = self.gathered + least, self.f + least, prior + least
        deviation = numpy.sqrt(self.spread) + 0.1 * least
        of_channel = numpy.stack([
            log(deviation / gathered), log(deviation / f), log(gathered / prior), log(f / prior),
            log(gathered / f), numpy.abs(log(gathered / f))], 2)
        shape = (*of_channel.shape[:2], of_point.shape[1])
        both = [numpy.broadcast_to(of_point[:, None, :], shape), of_channel]
        return numpy.concatenate(both, 2).clip(-6, 6).astype("f4")

    def mse(self, answer):
        return float(((answer - self.a) * (answer - self.b)).mean())

    def worth(self, answer):
        mse = self.mse(answer)
        return FEW * self.few_mse / mse if mse > 0 else float("inf")

    def mixed(self, share):
        return share * self.gathered + (1 - share) * self.f

    def best_share(self):
        """A bound: shares chosen by one reference, whose noise is taken off the error."""
        difference = self.gathered - self.f
        difference = numpy.where(difference == 0, 1e-12, difference)
        best = self.mixed(((self.a - self.f) / difference).clip(0, 1))
        left = numpy.square(best - self.b).mean() - numpy.square(self.a - self.b).mean() / 2
        return FEW * self.few_mse / max(float(left), 1e-12)


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def best_over(grid, rooms, answer):
    return max(grid, key=lambda value: geometric_mean([r.worth(answer(r, value)) for r in rooms]))


class Head:
    """Share and relative standard deviation of each channel: two hidden layers."""

    def __init__(self, rooms, seed):
        inputs = numpy.concatenate([room.inputs.reshape(-1, room.inputs.shape[2])
                                    for room in rooms])
        self.shift, self.scale = inputs.mean(0), inputs.std(0) + 1e-3
        random = numpy.random.default_rng(seed)
        sizes = [inputs.shape[1], HIDDEN, HIDDEN, 2]
        self.weights = []
        for rows, columns in zip(sizes, sizes[1:]):
            self.weights += [random.normal(0, rows ** -0.5, (rows, columns)).astype("f4"),
                             numpy.zeros(columns, "f4")]
        self.weights[-2] *= 0.1
        self.weights[-1][1] = -1.5

    def layers(self, inputs):
        """Of [..., inputs] normalized ones the values of each layer."""
        values = [inputs]
        for i in range(0, len(self.weights), 2):
            out = values[-1] @ self.weights[i] + self.weights[i + 1]
            values.append(numpy.tanh(out) if i + 2 < len(self.weights) else out)
        return values

    def gradients(self, values, slope):
        """Of the weights, from that of the last layer's values."""
        out = [None] * len(self.weights)
        for i in range(len(self.weights) - 2, -1, -2):
            before = values[i // 2]
            out[i], out[i + 1] = before.T @ slope, slope.sum(0)
            slope = (slope @ self.weights[i].T) * (1 - numpy.square(before))
        return out

    def answer(self, room):
        """Answer and standard deviation, [points, 3] each."""
        out = self.layers((room.inputs - self.shift) / self.scale)[-1]
        answer = room.mixed(1 / (1 + numpy.exp(-out[..., 0])))
        return answer, numpy.exp(out[..., 1]) * (answer + FLOOR * room.level)


class Batch:
    """All channels of all points of some rooms, one below the other, with the two losses: the error
    over that of the best constant share, and the likelihood of what is left."""

    def __init__(self, rooms, units, head):
        self.inputs = numpy.concatenate([((room.inputs - head.shift) / head.scale)
                                         .reshape(-1, room.inputs.shape[2]) for room in rooms])
        column = {name: numpy.concatenate([getattr(room, name).ravel() for room in rooms])
                  for name in ("a", "b", "gathered", "f")}
        self.a, self.b, self.gathered, self.f = column.values()

        def of_room(value):
            return numpy.concatenate([numpy.full(room.a.size, value(room), "f4") for room in rooms])

        self.weight = of_room(lambda room: 1 / (len(rooms) * room.a.size))
        self.unit = of_room(lambda room: 1 / units[room.name])
        self.level = of_room(lambda room: room.level)

    def loss(self, head):
        """Loss, values of the layers, and the slope of the last."""
        values = head.layers(self.inputs)
        share = 1 / (1 + numpy.exp(-values[-1][:, 0]))
        answer = share * self.gathered + (1 - share) * self.f
        left = (answer - self.a) * (answer - self.b)
        deviation = numpy.exp(values[-1][:, 1]) * (answer + FLOOR * self.level)
        relative = left / numpy.square(deviation)
        loss = (self.weight * (left * self.unit + LIKELIHOOD *
                               (0.5 * relative + numpy.log(deviation / self.level)))).sum()
        slope = self.weight[:, None] * numpy.stack([
            (2 * answer - self.a - self.b) * self.unit * (self.gathered - self.f) * share
            * (1 - share), LIKELIHOOD * (1 - relative)], 1)
        return loss, values, slope


def train(rooms, held, units, seed):
    head = Head(rooms, seed)
    learnt, tested = Batch(rooms, units, head), Batch(held, units, head)
    first, second = ([numpy.zeros_like(w) for w in head.weights] for _ in range(2))
    best, kept = float("inf"), None
    for step in range(1, STEPS + 1):
        _, values, slope = learnt.loss(head)
        rate = RATE * 0.5 * (1 + math.cos(math.pi * step / STEPS))
        for i, gradient in enumerate(head.gradients(values, slope)):  # Adam
            first[i] += 0.1 * (gradient - first[i])
            second[i] += 0.01 * (numpy.square(gradient) - second[i])
            size = numpy.sqrt(second[i] / (1 - 0.99 ** step)) + 1e-8
            head.weights[i] -= rate * first[i] / (1 - 0.9 ** step) / size
        if step % 20 == 0:
            value = tested.loss(head)[0]
            if value < best:
                best, kept = value, [w.copy() for w in head.weights]
    head.weights = kept
    return head


def calibration(room, answer, deviation):
    """Shares of the points within one and two standard deviations, root mean square of channels."""
    truth = 0.5 * (room.a + room.b)
    error = numpy.sqrt(numpy.square(answer - truth).mean(1))
    relative = room.noise / numpy.square(truth).mean()
    expected = numpy.sqrt((numpy.square(deviation) + relative * numpy.square(truth)).mean(1))
    return [float((error <= k * expected).mean()) for k in (1, 2)]


def print_within(name, shares):
    one, two = zip(*shares)
    print(f"  {name:22s} within one deviation {sum(one) / len(one):.2f} ({min(one):.2f} to"
          f" {max(one):.2f}), two {sum(two) / len(two):.2f} ({min(two):.2f} to {max(two):.2f})")


def report(title, rooms, constant, kappa, heads):
    rows = {"second": lambda r: r.decoded, "bounded": lambda r: r.f, "B": lambda r: r.gathered,
            f"constant share {constant:.2f}": lambda r: r.mixed(constant),
            f"by spread, {kappa:.2f}": lambda r: r.mixed(by_spread(r, kappa))}
    for seed, head in heads.items():
        rows[f"head, seed {seed}"] = lambda r, head=head: head.answer(r)[0]
    table = {}
    print(f"\n{title}, {len(rooms)} rooms: geometric mean, least; rooms whose mean is"
          " within 5 %, farthest ratio")
    for name, answer in rows.items():
        worth = [room.worth(answer(room)) for room in rooms]
        ratio = [float(answer(room).mean() / room.level) for room in rooms]
        table[name] = {"worth": dict(zip([r.name for r in rooms], worth))}
        print(f"  {name:22s} {geometric_mean(worth):8.1f} {min(worth):8.1f}"
              f" {sum(abs(v - 1) <= 0.05 for v in ratio):5d}"
              f" {max(ratio, key=lambda v: abs(v - 1)):7.2f}")
    best = [room.best_share() for room in rooms]
    print(f"  {'best shares, a bound':22s} {geometric_mean(best):8.1f} {min(best):8.1f}")
    for seed, head in heads.items():
        shares = [calibration(room, *head.answer(room)) for room in rooms]
        print_within(f"head, seed {seed}", shares)
        table[f"head, seed {seed}"]["within"] = dict(zip([r.name for r in rooms], shares))
    print_within("B, spread and a tenth", [
        calibration(r, r.gathered, numpy.sqrt(r.spread + numpy.square(0.1 * r.gathered)))
        for r in rooms])
    return table


def by_spread(room, kappa):
    """Weights by variance: of the rays by their spread, of the network a share of its answer."""
    of_network = numpy.square(kappa * room.f)
    return of_network / (of_network + room.spread + 1e-12 * room.level ** 2)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--train", nargs="+", required=True, type=pathlib.Path)
    parser.add_argument("--report", nargs="*", default=[], type=pathlib.Path)
    parser.add_argument("--table", default="network")
    parser.add_argument("--second", choices=["network", "solved", "rays"], default="network")
    parser.add_argument("--seeds", nargs="+", type=int, default=[1, 2])
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()

    def rooms_of(folders):
        return [Room(path, arguments.table, arguments.second) for folder in folders
                for path in sorted(folder.glob("*.safetensors"))]

    rooms = rooms_of(arguments.train)
    learnt = [room for i, room in enumerate(rooms) if i % 4 != 3]
    held = rooms[3::4]
    constant = best_over([i / 20 for i in range(21)], learnt, lambda r, s: r.mixed(s))
    kappa = best_over([0.02 * 1.25 ** i for i in range(20)], learnt,
                      lambda r, k: r.mixed(by_spread(r, k)))
    units = {room.name: room.mse(room.mixed(constant)) for room in rooms}
    heads = {seed: train(learnt, held, units, seed) for seed in arguments.seeds}
    result = {}
    for title, some in (("learnt", learnt), ("held out", held),
                        ("report", rooms_of(arguments.report))):
        if some:
            result[title] = report(title, some, constant, kappa, heads)
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=2))


if __name__ == "__main__":
    main()
