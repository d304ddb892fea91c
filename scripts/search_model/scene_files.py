"""Scenes of procedural objects as the files that the program reads."""

import pathlib
import random

import numpy
import torch

from .attributes import Look
from .crops import random_poses
from .objects import Splats, make_objects

COLUMNS = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity"]
COLUMNS += ["scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
BAND_0 = 0.28209479177387814  # the constant spherical harmonic
SPACING = 2.7  # between the centres of objects of about unit radius


def write_scene(folder: pathlib.Path, looks: list[Look], rng: random.Random, splats: int) -> list[int]:
    """Six or fewer objects side by side, each a cluster; returns the id of each look's cluster."""
    objects = make_objects(looks, splats, torch.device("cpu"))
    poses = random_poses(len(looks), torch.device("cpu"))
    places = [(x * SPACING, y * SPACING) for x in range(3) for y in range(2)]
    ids = list(range(1, len(looks) + 1))
    rng.shuffle(places)
    rng.shuffle(ids)
    tables = []
    for index, (x, y) in enumerate(places[: len(looks)]):
        scale = rng.uniform(0.7, 1.1)
        tables.append(_rows(objects, index, poses[index], scale, (x, y, 0.0)))
    folder.mkdir(parents=True)
    table = numpy.concatenate(tables)
    header = "ply\nformat binary_little_endian 1.0\n" + f"element vertex {len(table)}\n"
    header += "".join(f"property float {name}\n" for name in COLUMNS) + "end_header\n"
    (folder / "point_cloud.ply").write_bytes(header.encode() + table.astype("<f4").tobytes())
    labels = numpy.concatenate([numpy.full(len(t), i, "<u4") for t, i in zip(tables, ids)])
    colors = numpy.zeros((len(table), 3), "<f4")
    start = b"CLST" + numpy.array([1, len(table)], "<u4").tobytes()
    (folder / "clusters.bin").write_bytes(start + labels.tobytes() + colors.tobytes())
    return ids


def _rows(objects: Splats, index: int, pose: torch.Tensor, scale: float, place) -> numpy.ndarray:
    seen = objects.opacities[index] > 1 / 255
    positions = objects.positions[index][seen] @ pose.T * scale + torch.tensor(place)
    axes = objects.axes[index][seen] @ pose.T * scale
    lengths = axes.norm(dim=-1)
    opacity = objects.opacities[index][seen].clamp(1e-3, 0.999)
    color = (objects.colors[index][seen] - 0.5) / BAND_0
    # Columns of the rotation are the directions of the semi-axes.
    turns = _quaternions((axes / lengths[..., None]).transpose(1, 2))
    columns = [positions, color, torch.logit(opacity)[:, None], lengths.log(), turns]
    return torch.cat(columns, dim=1).numpy()


def _quaternions(r: torch.Tensor) -> torch.Tensor:
    """(w, x, y, z) of rotation matrices [n, 3, 3]: of four ways to divide, the one by the largest."""
    m = lambda i, j: r[:, i, j]
    products = torch.stack(
        [
            torch.stack([1 + m(0, 0) + m(1, 1) + m(2, 2), m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)], 1),
            torch.stack([m(2, 1) - m(1, 2), 1 + m(0, 0) - m(1, 1) - m(2, 2), m(1, 0) + m(0, 1), m(0, 2) + m(2, 0)], 1),
            torch.stack([m(0, 2) - m(2, 0), m(1, 0) + m(0, 1), 1 - m(0, 0) + m(1, 1) - m(2, 2), m(2, 1) + m(1, 2)], 1),
            torch.stack([m(1, 0) - m(0, 1), m(0, 2) + m(2, 0), m(2, 1) + m(1, 2), 1 - m(0, 0) - m(1, 1) + m(2, 2)], 1),
        ],
        1,
    )
    largest = products.diagonal(dim1=1, dim2=2).argmax(1)
    return torch.nn.functional.normalize(products[torch.arange(len(r)), largest], dim=-1)
