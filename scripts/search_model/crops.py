"""Renders of objects as a search's crops show them: alone over grey, or cut out of a scene."""

import math

import torch

from .compositor import composite, project
from .objects import Splats

GREY = 128 / 255


def random_views(n: int, device: torch.device) -> torch.Tensor:
    """Rotations [n, 3, 3] from object to camera axes: mostly from around and above, a quarter of the
    objects tumbled."""
    azimuth = torch.rand(n, device=device) * 2 * math.pi
    elevation = torch.rand(n, device=device) * 1.5 - 0.25
    forward = torch.stack(
        [-elevation.cos() * azimuth.cos(), -elevation.cos() * azimuth.sin(), -elevation.sin()], -1
    )
    up = torch.tensor([0.0, 0.0, 1.0], device=device).expand_as(forward)
    right = torch.nn.functional.normalize(torch.linalg.cross(forward, up), dim=-1)
    down = torch.linalg.cross(forward, right)
    return torch.stack([right, down, forward], 1)


def random_poses(n: int, device: torch.device) -> torch.Tensor:
    """Rotations of objects in their scenes [n, 3, 3]: upright, or any (a quarter)."""
    q = torch.nn.functional.normalize(torch.randn(n, 4, device=device), dim=-1)
    upright = torch.rand(n, 1, device=device) < 0.75
    turned = torch.nn.functional.normalize(q * torch.tensor([1.0, 0, 0, 1.0], device=device), dim=-1)
    w, x, y, z = torch.where(upright, turned, q).unbind(-1)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return torch.stack([torch.stack(row, -1) for row in rows], 1)


def repeat(splats: Splats, views: int) -> Splats:
    """Each object `views` times in a row."""
    many = lambda v: v.repeat_interleave(views, 0)
    return Splats(*(many(v) for v in vars(splats).values()))


def render_crops(splats: Splats, views: int, size: int, detail: bool = True) -> torch.Tensor:
    """[n·views, 3, size, size] in 0–1, rounded to bytes as images are."""
    poses = random_poses(len(splats.positions), splats.positions.device)
    many = repeat(splats, views)
    n, device = len(many.positions), many.positions.device
    rotations = random_views(n, device) @ poses.repeat_interleave(views, 0)
    distance = 2.5 + torch.rand(n, device=device) * 4
    image = composite(project(many, rotations, distance, size), size)
    crops = _cut_out(image, _context(n, size, device))
    crops = _occlude(crops)
    if detail:
        crops = _blur(crops)
    gain = 1 + torch.randn(n, 1, 1, 1, device=device) * 0.06
    gamma = torch.exp(torch.randn(n, 1, 1, 1, device=device) * 0.08)
    toned = (crops.clamp(1e-4, 1) ** gamma * gain).clamp(0, 1)
    toned = torch.where((crops - GREY).abs().amax(1, keepdim=True) < 1e-3, crops, toned)
    return (toned * 255).round() / 255


def _context(n: int, size: int, device: torch.device) -> torch.Tensor:
    """What may lie behind an object: two colours that run into each other."""
    ramp = torch.linspace(-1, 1, size, device=device)
    angle = torch.rand(n, 1, 1, device=device) * 2 * math.pi
    line = ramp[None, None, :] * angle.cos() + ramp[None, :, None] * angle.sin()
    mix = torch.sigmoid((line + torch.randn(n, 1, 1, device=device) * 0.5) * 6)[:, None]
    one, two = torch.rand(n, 3, 1, 1, device=device), torch.rand(n, 3, 1, 1, device=device)
    return one * mix + two * (1 - mix)


def _cut_out(image: torch.Tensor, context: torch.Tensor) -> torch.Tensor:
    """Half of the crops alone over grey; the others over their context, in which pixels that are
    mostly of something else are grey."""
    color, alpha = image[:, :3], image[:, 3:]
    alone = color + (1 - alpha) * GREY
    within = torch.where(alpha > 0.5, color + (1 - alpha) * context, torch.full_like(color, GREY))
    isolated = torch.rand(len(image), 1, 1, 1, device=image.device) < 0.5
    return torch.where(isolated, alone, within)


def _occlude(crops: torch.Tensor) -> torch.Tensor:
    """Something round stands before a quarter of the objects, something straight before a tenth."""
    n, _, size, _ = crops.shape
    device = crops.device
    grid = torch.linspace(-1, 1, size, device=device)
    angle = torch.rand(n, 1, 1, device=device) * 2 * math.pi
    reach = 0.55 + torch.rand(n, 1, 1, device=device) * 0.6
    radius = 0.2 + torch.rand(n, 1, 1, device=device) * 0.45
    dx, dy = grid[None, None] - reach * angle.cos(), grid[None, :, None] - reach * angle.sin()
    hidden = (dx * dx + dy * dy < radius**2) & (torch.rand(n, 1, 1, device=device) < 0.25)
    beyond = grid[None, None] * angle.cos() + grid[None, :, None] * angle.sin() > reach - 0.35
    hidden = hidden | (beyond & (torch.rand(n, 1, 1, device=device) < 0.1))
    return torch.where(hidden[:, None], torch.full_like(crops, GREY), crops)


def _blur(crops: torch.Tensor) -> torch.Tensor:
    """A third of the crops come from fewer pixels."""
    n, _, size, _ = crops.shape
    order = torch.randperm(n, device=crops.device)
    few = order[: n // 3]
    for part in few.chunk(4):
        side = int(torch.randint(size // 5, size * 3 // 4, (1,)))
        small = torch.nn.functional.interpolate(crops[part], size=side, mode="bilinear", antialias=True)
        crops[part] = torch.nn.functional.interpolate(small, size=size, mode="bilinear")
    return crops
