"""Splats to images, in batches: EWA projection and front-to-back blending as in the rest of the
project (ARCHITECTURE.md), with a Triton kernel on a GPU and blend.c elsewhere."""

import ctypes
import functools
import math
import pathlib
import subprocess
import tempfile
from dataclasses import dataclass

import torch

from .objects import Splats

try:
    import triton
    import triton.language as tl
except ImportError:
    triton = None

LOW_PASS = 0.3  # px²
LEAST_ALPHA = 1 / 255
TILE = 16


@dataclass
class Projected:
    """n images of m splats in drawing order."""

    centres: torch.Tensor  # [n, m, 2] px
    conics: torch.Tensor  # [n, m, 3]: xx, xy, yy of the inverse covariance
    radii: torch.Tensor  # [n, m, 2] px: where α falls to 1/255
    colors: torch.Tensor  # [n, m, 3]
    opacities: torch.Tensor  # [n, m]


def project(splats: Splats, rotations: torch.Tensor, distance: torch.Tensor, size: int) -> Projected:
    """Cameras look at the origin from `distance` [n]; `rotations` [n, 3, 3] turn objects into
    camera axes (x right, y down, z forward). The frame is the box of the visible
    splats with a tenth of its longer side on either side, as in a search's crops."""
    view = splats.positions @ rotations.transpose(1, 2)
    axes = (splats.axes.flatten(1, 2) @ rotations.transpose(1, 2)).view_as(splats.axes)
    depth = (view[..., 2] + distance[:, None]).clamp_min(0.1)
    plane = view[..., :2] / depth[..., None]
    extent = axes.norm(dim=2).amax(-1) / depth * 1.5
    centre, scale = _frame(plane, extent, splats.opacities > 0.1, size)
    centres = (plane - centre[:, None]) * scale[:, None, None] + size / 2
    # J applied to each semi-axis: the covariance is the sum of their outer products.
    flat = (axes[..., :2] - plane[:, :, None] * axes[..., 2:]) * (scale[:, None] / depth)[..., None, None]
    xx = (flat[..., 0] ** 2).sum(-1) + LOW_PASS
    yy = (flat[..., 1] ** 2).sum(-1) + LOW_PASS
    xy = (flat[..., 0] * flat[..., 1]).sum(-1)
    inverse = 1 / (xx * yy - xy**2).clamp_min(1e-6)
    conics = torch.stack([yy * inverse, -xy * inverse, xx * inverse], -1)
    reach = (2 * (splats.opacities / LEAST_ALPHA).clamp_min(1).log()).sqrt()
    radii = torch.stack([xx.sqrt() * reach, yy.sqrt() * reach], -1)
    order = depth.argsort(dim=1)
    sort = lambda v: v.gather(1, order.view(*order.shape, *[1] * (v.dim() - 2)).expand_as(v))
    return Projected(
        sort(centres), sort(conics), sort(radii), sort(splats.colors), sort(splats.opacities)
    )


def _frame(
    plane: torch.Tensor, extent: torch.Tensor, seen: torch.Tensor, size: int
) -> tuple[torch.Tensor, torch.Tensor]:
    """Centre [n, 2] and pixels per unit [n] of the crop; one splat in a hundred may stand out."""
    low = torch.where(seen[..., None], plane - extent[..., None], torch.full_like(plane, math.inf))
    high = torch.where(seen[..., None], plane + extent[..., None], torch.full_like(plane, -math.inf))
    spare = plane.shape[1] // 100 + 1
    low = low.topk(spare, dim=1, largest=False).values[:, -1]
    high = high.topk(spare, dim=1).values[:, -1]
    n, device = len(plane), plane.device
    side = (high - low).amax(-1).clamp_min(1e-3)
    scale = size / (1.2 * side) * (1 + torch.randn(n, device=device) * 0.05).clamp(0.85, 1.15)
    shift = torch.randn(n, 2, device=device) * 0.02 * side[:, None]
    return (low + high) / 2 + shift, scale


def composite(projected: Projected, size: int) -> torch.Tensor:
    """[n, 4, size, size]: colour over black, alpha."""
    radii = torch.where(projected.opacities[..., None] > LEAST_ALPHA, projected.radii, -1e6)
    parts = [projected.centres, projected.conics, radii, projected.opacities[..., None]]
    packed = torch.cat([*parts, projected.colors], dim=-1).contiguous()
    image = torch.empty(len(packed), 4, size, size, device=packed.device)
    if packed.is_cuda:
        _blend_on_gpu(packed, image)
    else:
        sizes = (ctypes.c_long(v) for v in (len(packed), packed.shape[1], size))
        pointers = (ctypes.c_void_p(v.data_ptr()) for v in (packed, image))
        _blend_library().blend(*pointers, *sizes)
    return image


@functools.cache
def _blend_library() -> ctypes.CDLL:
    """blend.c, compiled for this machine."""
    source = pathlib.Path(__file__).parent / "blend.c"
    library = pathlib.Path(tempfile.mkdtemp()) / "blend.so"
    command = ["cc", "-O3", "-march=native", "-ffast-math", "-shared", "-fPIC"]
    subprocess.run([*command, str(source), "-o", str(library), "-lm"], check=True)
    return ctypes.CDLL(str(library))


if triton is not None:

    @triton.jit
    def _blend_tiles(splats, image, count, size, TILE: tl.constexpr):
        """One program a tile. `splats` [n, count, 11]: centre, conic, radii, opacity, colour."""
        index = tl.program_id(0).to(tl.int64)
        across = size // TILE
        left = (tl.program_id(1) % across) * TILE
        top = (tl.program_id(1) // across) * TILE
        pixel = tl.arange(0, TILE * TILE)
        column, row = left + pixel % TILE, top + pixel // TILE
        x, y = column + 0.5, row + 0.5
        red = tl.zeros([TILE * TILE], tl.float32)
        green = tl.zeros([TILE * TILE], tl.float32)
        blue = tl.zeros([TILE * TILE], tl.float32)
        transmittance = tl.full([TILE * TILE], 1.0, tl.float32)
        splat = splats + index * count * 11
        for _ in range(count):
            cx = tl.load(splat)
            cy = tl.load(splat + 1)
            rx = tl.load(splat + 5)
            ry = tl.load(splat + 6)
            inside = (cx + rx > left) & (cx - rx < left + TILE)
            inside = inside & (cy + ry > top) & (cy - ry < top + TILE)
            if inside:
                a = tl.load(splat + 2)
                b = tl.load(splat + 3)
                c = tl.load(splat + 4)
                dx, dy = x - cx, y - cy
                power = -0.5 * (a * dx * dx + c * dy * dy) - b * dx * dy
                alpha = tl.minimum(tl.load(splat + 7) * tl.exp(power), 0.99)
                weight = tl.where(alpha >= 1 / 255, alpha, 0.0) * transmittance
                red += weight * tl.load(splat + 8)
                green += weight * tl.load(splat + 9)
                blue += weight * tl.load(splat + 10)
                transmittance -= weight
            splat += 11
        out = image + index * 4 * size * size + row * size + column
        plane = size * size
        tl.store(out, red)
        tl.store(out + plane, green)
        tl.store(out + 2 * plane, blue)
        tl.store(out + 3 * plane, 1.0 - transmittance)


def _blend_on_gpu(packed: torch.Tensor, image: torch.Tensor) -> None:
    size = image.shape[-1]
    if size % TILE:
        raise ValueError(f"size: expected a multiple of {TILE}, found {size}")
    tiles = (size // TILE) ** 2
    _blend_tiles[(len(packed), tiles)](packed, image, packed.shape[1], size, TILE)
