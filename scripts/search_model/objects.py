"""Objects as Gaussian splats, in batches on any device: surface, pattern, light, and the faults that
trained splats have."""

import math
from dataclasses import dataclass

import torch

from .attributes import COLORS, SHAPE_NAMES, Look, look_table
from .shapes import SAMPLERS


@dataclass
class Splats:
    """n objects of m splats. `axes` are the ellipsoids' semi-axes (1 σ) as rows."""

    positions: torch.Tensor  # [n, m, 3]
    axes: torch.Tensor  # [n, m, 3, 3]
    colors: torch.Tensor  # [n, m, 3], 0–1
    opacities: torch.Tensor  # [n, m]


def make_objects(looks: list[Look], count: int, device: torch.device) -> Splats:
    return make_splats(look_table(looks), count, device)


def make_splats(looks: torch.Tensor, count: int, device: torch.device) -> Splats:
    """`count` splats for each row of a look_table, which lies on the CPU; some splats are
    transparent where an object has fewer."""
    n = len(looks)
    u = torch.rand(n, count, 5, device=device)
    positions, normals = torch.empty(n, count, 3, device=device), torch.empty(n, count, 3, device=device)
    for index, name in enumerate(SHAPE_NAMES):
        chosen = (looks[:, 0] == index).nonzero()[:, 0].to(device)
        if len(chosen):
            positions[chosen], normals[chosen] = SAMPLERS[name](u[chosen])

    looks = looks.to(device)
    shape, pattern = looks[:, 0], looks[:, 1]
    first, second = _pick_colors(looks)
    is_second = _pattern(pattern, shape, positions, normals)
    base = torch.where(is_second[..., None], second[:, None], first[:, None])
    base = base + torch.randn_like(base) * _range(n, 0.0, 0.05, device) + _stains(positions)
    colors = _light(base, positions, normals)

    positions, axes = _ellipsoids(positions, normals)
    opacities = 1 - torch.rand(n, count, device=device) ** 2 * _range(n, 0.05, 0.9, device)[..., 0]
    opacities = opacities * _present(positions)
    positions, opacities = _floaters(positions, opacities)
    return Splats(positions, axes, colors.clamp(0, 1), opacities.clamp(0, 0.99))


def _range(n: int, low: float, high: float, device: torch.device) -> torch.Tensor:
    return torch.rand(n, 1, 1, device=device) * (high - low) + low


def _frequency(n: int, low: float, high: float, device: torch.device) -> torch.Tensor:
    """Radians per unit, as often between 3 and 6 as between 6 and 12."""
    return torch.exp(_range(n, math.log(low), math.log(high), device))


def _chance(n: int, p: float, device: torch.device) -> torch.Tensor:
    return (torch.rand(n, 1, 1, device=device) < p).float()


def _pick_colors(looks: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """One colour each [n, 3] from the ranges of the two names, in either order."""
    device = looks.device
    swap = torch.rand(len(looks), device=device) < 0.5
    names = torch.where(swap[:, None], looks[:, [3, 2]], looks[:, [2, 3]])
    ranges = torch.tensor([entry[1:] for entry in COLORS.values()], device=device)[names]
    low, high = ranges.float().unbind(-1)
    hue, saturation, value = (low + (high - low) * torch.rand_like(low)).unbind(-1)
    # HSV to RGB: each channel falls off from `value` with its distance from the hue.
    offset = torch.tensor([5.0, 3.0, 1.0], device=device)
    k = (offset + hue[..., None] / 60) % 6
    fall = torch.minimum(k, 4 - k).clamp(0, 1)
    rgb = value[..., None] * (1 - saturation[..., None] * fall)
    return rgb[:, 0], rgb[:, 1]


def _pattern(
    pattern: torch.Tensor, shape: torch.Tensor, positions: torch.Tensor, normals: torch.Tensor
) -> torch.Tensor:
    """Which splats have the second colour: boolean [n, m]."""
    n, device = len(pattern), positions.device
    choices = torch.stack(
        [
            torch.zeros(positions.shape[:2], dtype=torch.bool, device=device),
            _stripes(positions),
            _checks(shape, positions),
            _dots(positions),
            _two_tone(positions, normals),
        ],
        dim=-1,
    )
    return choices.gather(-1, pattern[:, None, None].expand(n, positions.shape[1], 1))[..., 0]


def _direction(n: int, device: torch.device, axis_share: float) -> torch.Tensor:
    """Random directions [n, 1, 3]; a share of them along an axis."""
    axis = torch.eye(3, device=device)[torch.randint(0, 3, (n,), device=device)][:, None]
    free = torch.nn.functional.normalize(torch.randn(n, 1, 3, device=device), dim=-1)
    return torch.where(_chance(n, axis_share, device) > 0, axis, free)


def _stripes(positions: torch.Tensor) -> torch.Tensor:
    n, device = len(positions), positions.device
    along = (positions * _direction(n, device, 0.6)).sum(-1, keepdim=True)
    wave = along * _frequency(n, 6.0, 20.0, device) + _range(n, 0.0, 6.3, device)
    return (wave.sin() > _range(n, -0.3, 0.3, device))[..., 0]


def _checks(shape: torch.Tensor, positions: torch.Tensor) -> torch.Tensor:
    """Cubes in space, or meridians and parallels; a plate's squares ignore its thickness."""
    n, device = len(positions), positions.device
    frequency = _frequency(n, 2.5, 20.0, device)
    phase = torch.rand(n, 1, 3, device=device) * 6.3
    waves = (positions * frequency + phase).sin()
    flat = (shape == SHAPE_NAMES.index("plate"))[:, None, None]
    third = torch.where(flat, torch.ones_like(waves[..., 2:]), waves[..., 2:])
    cubes = waves[..., 0:1] * waves[..., 1:2] * third > 0
    longitude = torch.atan2(positions[..., 1:2], positions[..., 0:1])
    around = (longitude * _range(n, 2, 8, device).floor() + phase[..., :1]).sin()
    globe = around * waves[..., 2:] > 0
    globes = (_chance(n, 0.4, device) > 0) & ~flat
    return torch.where(globes, globe, cubes)[..., 0]


def _dots(positions: torch.Tensor) -> torch.Tensor:
    n, m, _ = positions.shape
    centres = positions[:, torch.randperm(m)[:40]]
    used = torch.arange(40, device=positions.device) < _range(n, 14, 40, positions.device)[..., 0]
    squared = (
        (positions**2).sum(-1)[:, :, None]
        + (centres**2).sum(-1)[:, None]
        - 2 * positions @ centres.transpose(1, 2)
    )
    squared = torch.where(used[:, None], squared, torch.full_like(squared, 9.0))
    return squared.amin(-1) < _range(n, 0.09, 0.17, positions.device)[..., 0] ** 2


def _two_tone(positions: torch.Tensor, normals: torch.Tensor) -> torch.Tensor:
    """Halves, faces or patches."""
    n, device = len(positions), positions.device
    halves = (positions * _direction(n, device, 0.5)).sum(-1) > 0
    faces = normals.abs().argmax(-1) == torch.randint(0, 3, (n, 1), device=device)
    waves = torch.randn(n, 3, 3, device=device) * _range(n, 2.0, 6.0, device)
    phases = torch.rand(n, 1, 3, device=device) * 6.3
    patches = (positions @ waves + phases).sin().sum(-1) > 0
    kind = torch.randint(0, 4, (n, 1), device=device)
    return torch.where(kind == 0, halves, torch.where(kind == 1, faces, patches))


def _stains(positions: torch.Tensor) -> torch.Tensor:
    """Slow changes of brightness, as captures have."""
    n, device = len(positions), positions.device
    waves = torch.randn(n, 3, 1, device=device) * _range(n, 1.0, 4.0, device)
    return (positions @ waves + _range(n, 0, 6.3, device)).sin() * _range(n, 0.0, 0.05, device)


def _light(base: torch.Tensor, positions: torch.Tensor, normals: torch.Tensor) -> torch.Tensor:
    """A sky, one lamp from above, its highlight, a shadow of something else."""
    n, device = len(base), base.device
    lamp = torch.nn.functional.normalize(
        torch.randn(n, 1, 3, device=device) + torch.tensor([0.0, 0.0, 1.2], device=device), dim=-1
    )
    lambert = (normals * lamp).sum(-1, keepdim=True)
    sky = 0.5 + 0.5 * normals[..., 2:]
    ambient = _range(n, 0.45, 0.85, device)
    shade = ambient * (1 - _range(n, 0.0, 0.4, device) * (1 - sky))
    shade = shade + (1.05 - ambient) * lambert.clamp_min(0)
    centre = torch.randn(n, 1, 3, device=device) * 0.7
    distance = (positions - centre).norm(dim=-1, keepdim=True)
    softness, size = _range(n, 0.03, 0.2, device), _range(n, 0.15, 0.6, device)
    shadow = torch.sigmoid((size - distance) / softness)
    shade = shade * (1 - _chance(n, 0.35, device) * _range(n, 0.1, 0.5, device) * shadow)
    tint = 1 + torch.randn(n, 1, 3, device=device) * 0.03
    highlight = lambert.clamp_min(0) ** 24 * _chance(n, 0.35, device) * _range(n, 0.1, 0.6, device)
    return base * shade * tint * _range(n, 0.88, 1.12, device) + highlight


def _ellipsoids(positions: torch.Tensor, normals: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Discs on the surface: larger ones blur the pattern, smaller ones leave gaps."""
    n, m, _ = positions.shape
    device = positions.device
    spacing = math.sqrt(4 * math.pi / m)
    size = spacing * _range(n, 0.35, 0.85, device) * torch.exp(torch.randn(n, m, 1, device=device) * 0.35)
    helper = torch.nn.functional.normalize(torch.randn(n, m, 3, device=device), dim=-1)
    first = torch.nn.functional.normalize(torch.linalg.cross(normals, helper), dim=-1)
    second = torch.linalg.cross(normals, first)
    stretch = torch.exp(torch.randn(n, m, 1, device=device) * _range(n, 0.0, 0.35, device))
    thickness = _range(n, 0.1, 0.6, device)
    axes = torch.stack([first * size * stretch, second * size / stretch, normals * size * thickness], 2)
    jitter = torch.randn_like(positions) * spacing * _range(n, 0.0, 0.25, device)
    return positions + jitter, axes


def _present(positions: torch.Tensor) -> torch.Tensor:
    """1 or 0: some objects have fewer splats, some lack the side that no camera saw."""
    n, device = len(positions), positions.device
    kept = torch.rand(positions.shape[:2], device=device) < _range(n, 0.55, 1.2, device)[..., 0]
    direction = torch.nn.functional.normalize(torch.randn(n, 1, 3, device=device), dim=-1)
    reach = (positions * direction).sum(-1)
    limit = torch.quantile(reach, 0.9, dim=1, keepdim=True)
    hole = (reach > limit) & (_chance(n, 0.15, device)[..., 0] > 0)
    return (kept & ~hole).float()


def _floaters(positions: torch.Tensor, opacities: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    n, device = len(positions), positions.device
    share = _range(n, 0.0, 0.03, device)
    floats = torch.rand(positions.shape[:2] + (1,), device=device) < share
    away = positions * (1 + torch.rand_like(positions[..., :1]) * 0.3)
    opacities = torch.where(floats[..., 0], opacities * 0.3, opacities)
    return torch.where(floats, away, positions), opacities
