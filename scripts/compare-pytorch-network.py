#!/usr/bin/env python3
"""Times the deformation network in PyTorch on the CPU, next to Trapeze's own evaluation.

    scripts/compare-pytorch-network.py assets/sample-scene [-- COMMAND ...]

COMMAND, when given, is run afterwards on the same machine and its JSON output is put under
"trapeze", so that one file holds both figures. Needs numpy and torch.
"""

import argparse
import json
import pathlib
import statistics
import subprocess
import time

import numpy
import torch

SHAPES = [(256, 84)] + [(256, 256)] * 4 + [(256, 340)] + [(256, 256)] * 2
SHAPES += [(3, 256), (4, 256), (3, 256)]


def read_positions(path: pathlib.Path) -> torch.Tensor:
    """x, y, z of a binary little-endian PLY whose vertex properties are all floats."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode("ascii").splitlines()
    properties = [line.split()[2] for line in header if line.startswith("property float ")]
    vertices = numpy.frombuffer(data, dtype="<f4", offset=end).reshape(-1, len(properties))
    columns = [properties.index(axis) for axis in "xyz"]
    return torch.from_numpy(vertices[:, columns].copy())


def read_layers(path: pathlib.Path) -> list[tuple[torch.Tensor, torch.Tensor]]:
    """Weight and bias of each layer of a headerless weights.bin."""
    rest = torch.from_numpy(numpy.fromfile(path, dtype="<f4"))
    layers = []
    for outputs, inputs in SHAPES:
        weight, bias, rest = rest.split(
            [outputs * inputs, outputs, len(rest) - outputs * (inputs + 1)]
        )
        layers.append((weight.reshape(outputs, inputs).contiguous(), bias.contiguous()))
    return layers


def encode(v: torch.Tensor, octaves: int = 10) -> torch.Tensor:
    waves = [wave(v * 2.0**k) for k in range(octaves) for wave in (torch.sin, torch.cos)]
    return torch.cat([v, *waves], dim=-1)


def evaluate(layers, encoded_positions: torch.Tensor, t: float) -> list[torch.Tensor]:
    time_encoding = encode(torch.tensor([[t]])).expand(len(encoded_positions), -1)
    inputs = torch.cat([encoded_positions, time_encoding], dim=-1)
    h = inputs
    for i, (weight, bias) in enumerate(layers[:8]):
        h = torch.relu(torch.nn.functional.linear(h, weight, bias))
        if i == 4:
            h = torch.cat([inputs, h], dim=-1)
    return [torch.nn.functional.linear(h, weight, bias) for weight, bias in layers[8:]]


def time_frames(layers, positions: torch.Tensor, batch: int, frames: int) -> dict:
    """Milliseconds per frame. The positions are encoded once: they do not change."""
    batches = [encode(p) for p in positions.split(batch)]
    times = []
    for frame in range(frames + 3):
        start = time.perf_counter()
        for encoded in batches:
            evaluate(layers, encoded, frame / frames)
        times.append((time.perf_counter() - start) * 1e3)
    times = sorted(times[3:])
    return {
        "batch": batch,
        "splats": len(positions),
        "median_ms": round(statistics.median(times), 2),
        "p10_ms": round(times[len(times) // 10], 2),
        "p90_ms": round(times[len(times) * 9 // 10], 2),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=pathlib.Path, help="folder with point_cloud.ply, weights.bin")
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--threads", type=int, default=torch.get_num_threads())
    parser.add_argument("command", nargs="*", help="prints JSON; its figures are put beside ours")
    arguments = parser.parse_args()

    torch.set_num_threads(arguments.threads)
    layers = read_layers(arguments.scene / "weights.bin")
    positions = read_positions(arguments.scene / "point_cloud.ply")
    report = {"torch": torch.__version__, "threads": arguments.threads}
    with torch.inference_mode():
        report["pytorch"] = [
            time_frames(layers, positions, batch, arguments.frames) for batch in (4096, len(positions))
        ]
    if arguments.command:
        output = subprocess.run(arguments.command, check=True, capture_output=True, text=True)
        report["trapeze"] = json.loads(output.stdout)
    print(json.dumps(report, indent=2))


if __name__ == "__main__":
    main()
