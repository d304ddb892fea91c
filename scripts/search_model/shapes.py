"""Points on the surfaces of the shapes, in batches: n objects with m points each. Objects differ in
their proportions, stand along z and fit roughly into the unit sphere."""

import math

import torch

Surface = tuple[torch.Tensor, torch.Tensor]  # positions and normals, [n, m, 3]


def _uniform(shape: tuple[int, ...], low: float, high: float, like: torch.Tensor) -> torch.Tensor:
    return torch.rand(shape, device=like.device) * (high - low) + low


def _sphere(u: torch.Tensor) -> torch.Tensor:
    """Uniform directions from two of the random numbers."""
    z, angle = u[..., 0] * 2 - 1, u[..., 1] * 2 * math.pi
    r = (1 - z * z).clamp_min(0).sqrt()
    return torch.stack([r * angle.cos(), r * angle.sin(), z], dim=-1)


def _normalise(v: torch.Tensor) -> torch.Tensor:
    return v / v.norm(dim=-1, keepdim=True).clamp_min(1e-8)


def _ellipsoid(u: torch.Tensor, radii: torch.Tensor) -> Surface:
    direction = _sphere(u)
    return direction * radii, _normalise(direction / radii)


def ball(u: torch.Tensor) -> Surface:
    direction = _sphere(u)
    return direction * 0.9, direction


def box(u: torch.Tensor) -> Surface:
    half = _uniform((len(u), 1, 3), 0.45, 0.8, u)
    return _cuboid(u, half)


def _cuboid(u: torch.Tensor, half: torch.Tensor) -> Surface:
    areas = torch.stack(
        [half[..., 1] * half[..., 2], half[..., 0] * half[..., 2], half[..., 0] * half[..., 1]], -1
    )
    edges = (areas / areas.sum(-1, keepdim=True)).cumsum(-1)
    axis = (u[..., 2:3] > edges[..., :2]).sum(-1)
    side = (u[..., 3] > 0.5).float() * 2 - 1
    normal = torch.nn.functional.one_hot(axis, 3).float() * side[..., None]
    anywhere = torch.stack([u[..., 0], u[..., 1], u[..., 4]], -1) * 2 - 1
    return torch.where(normal.abs() > 0.5, normal, anywhere) * half, normal


def _disc_point(u: torch.Tensor, v: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    angle, r = u * 2 * math.pi, v.sqrt()
    return r * angle.cos(), r * angle.sin()


def _tapered(u: torch.Tensor, bottom: torch.Tensor, top: torch.Tensor, half: torch.Tensor) -> Surface:
    """Side and caps of a cylinder or a truncated cone; all parameters [n, 1]."""
    slant = ((bottom - top) ** 2 + 4 * half**2).sqrt()
    side_area = (bottom + top) * slant
    total = side_area + bottom**2 + top**2
    on_side = u[..., 2] * total < side_area
    on_bottom = ~on_side & (u[..., 2] * total < side_area + bottom**2)
    # Distance from the wide end with density proportional to the radius.
    t = (bottom - (bottom**2 - u[..., 1] * (bottom**2 - top**2)).clamp_min(0).sqrt()) / (
        bottom - top
    ).clamp_min(1e-3)
    t = torch.where((bottom - top).abs() < 1e-3, u[..., 1], t)
    angle = u[..., 0] * 2 * math.pi
    radius = bottom + (top - bottom) * t
    side = torch.stack([radius * angle.cos(), radius * angle.sin(), half * (2 * t - 1)], -1)
    rise = ((bottom - top) / (2 * half)).expand_as(angle)
    side_normal = _normalise(torch.stack([angle.cos(), angle.sin(), rise], -1))
    x, y = _disc_point(u[..., 0], u[..., 1])
    cap_radius = torch.where(on_bottom, bottom.expand_as(x), top.expand_as(x))
    sign = torch.where(on_bottom, -1.0, 1.0)
    cap = torch.stack([x * cap_radius, y * cap_radius, half * sign], -1)
    cap_normal = torch.stack([0 * x, 0 * x, sign], -1)
    choose = on_side[..., None]
    return torch.where(choose, side, cap), torch.where(choose, side_normal, cap_normal)


def cone(u: torch.Tensor) -> Surface:
    n = (len(u), 1)
    return _tapered(u, _uniform(n, 0.5, 0.75, u), _uniform(n, 0.01, 0.03, u), _uniform(n, 0.5, 0.85, u))


def cylinder(u: torch.Tensor) -> Surface:
    radius = _uniform((len(u), 1), 0.35, 0.6, u)
    return _tapered(u, radius, radius, radius * _uniform((len(u), 1), 0.8, 2.0, u))


def plate(u: torch.Tensor) -> Surface:
    n = (len(u), 1)
    radius = _uniform(n, 0.9, 1.1, u)
    thickness = _uniform(n, 0.01, 0.07, u)
    disc, disc_normal = _tapered(u, radius, radius, thickness)
    half = torch.stack([_uniform(n, 0.6, 1.0, u), _uniform(n, 0.6, 1.0, u), thickness], -1)
    square, square_normal = _cuboid(u, half)
    choose = (torch.rand(len(u), 1, 1, device=u.device) < 0.5).expand_as(disc)
    return torch.where(choose, disc, square), torch.where(choose, disc_normal, square_normal)


def ring(u: torch.Tensor) -> Surface:
    minor = _uniform((len(u), 1), 0.16, 0.3, u)
    major = 0.95 - minor
    a, b = u[..., 0] * 2 * math.pi, u[..., 1] * 2 * math.pi
    normal = torch.stack([a.cos() * b.cos(), a.sin() * b.cos(), b.sin()], -1)
    centre = torch.stack([major * a.cos(), major * a.sin(), 0 * a], -1)
    return centre + minor[..., None] * normal, normal


def pyramid(u: torch.Tensor) -> Surface:
    half, height = _uniform((len(u), 1), 0.5, 0.75, u), _uniform((len(u), 1), 0.8, 1.4, u)
    slant = (half**2 + height**2).sqrt()
    on_base = u[..., 2] * (half + slant) < half
    base = torch.stack([(u[..., 0] * 2 - 1) * half, (u[..., 1] * 2 - 1) * half, 0 * u[..., 0]], -1)
    down = u[..., 1].sqrt()
    face = (u[..., 3] * 4).long().clamp_max(3).float() * (math.pi / 2)
    out, along = half * down, half * down * (u[..., 0] * 2 - 1)
    side = torch.stack(
        [
            out * face.cos() - along * face.sin(),
            out * face.sin() + along * face.cos(),
            height * (1 - down),
        ],
        -1,
    )
    lean = (height / slant).expand_as(face)
    side_normal = torch.stack(
        [lean * face.cos(), lean * face.sin(), (half / slant).expand_as(face)], -1
    )
    base_normal = torch.tensor([0.0, 0.0, -1.0], device=u.device).expand_as(side_normal)
    choose = on_base[..., None]
    points = torch.where(choose, base, side)
    points = points - torch.stack([0 * height, 0 * height, height / 2], -1)
    return points, torch.where(choose, base_normal, side_normal)


def rock(u: torch.Tensor) -> Surface:
    """A sphere with five waves over it, stretched."""
    n = len(u)
    direction = _sphere(u)
    waves = torch.randn(n, 5, 3, device=u.device) * 2.0
    phases = torch.rand(n, 5, device=u.device) * 2 * math.pi
    strength = _uniform((n, 1, 5), 0.05, 0.13, u)
    angle = torch.einsum("nmc,nkc->nmk", direction, waves) + phases[:, None]
    radius = 1 + (strength * angle.sin()).sum(-1, keepdim=True)
    gradient = torch.einsum("nmk,nkc->nmc", strength * angle.cos(), waves)
    normal = direction - (gradient - (gradient * direction).sum(-1, keepdim=True) * direction) / radius
    stretch = _uniform((n, 1, 3), 0.55, 0.9, u)
    return direction * radius * stretch, _normalise(normal / stretch)


def star(u: torch.Tensor) -> Surface:
    """A five-pointed star cut out of a thick sheet; it stands upright."""
    n = (len(u), 1)
    inner, half = _uniform(n, 0.38, 0.48, u), _uniform(n, 0.1, 0.25, u)
    sector = (u[..., 2] * 10).long().clamp_max(9).float()
    tip_first = (sector % 2) == 0
    first = torch.where(tip_first, torch.ones_like(sector), inner.expand_as(sector))
    second = torch.where(tip_first, inner.expand_as(sector), torch.ones_like(sector))
    a, b = sector * (math.pi / 5), (sector + 1) * (math.pi / 5)
    p = torch.stack([first * a.sin(), first * a.cos()], -1)
    q = torch.stack([second * b.sin(), second * b.cos()], -1)
    on_rim = u[..., 3] < 0.35
    along = u[..., 0:1]
    reach = torch.where(on_rim, torch.ones_like(u[..., 1]), u[..., 1].sqrt())[..., None]
    flat = (p + (q - p) * along) * reach
    side = torch.where(u[..., 4] > 0.5, 1.0, -1.0)
    depth = torch.where(on_rim, (u[..., 4] * 2 - 1) * half, side * half)
    edge = q - p
    rim_normal = torch.stack([-edge[..., 1], 0 * sector, edge[..., 0]], -1)
    rim_normal = _normalise(rim_normal)
    outward = (rim_normal[..., 0] * flat[..., 0] + rim_normal[..., 2] * flat[..., 1]).sign()
    face_normal = torch.stack([0 * sector, side, 0 * sector], -1)
    normal = torch.where(on_rim[..., None], rim_normal * outward[..., None], face_normal)
    return torch.stack([flat[..., 0], depth, flat[..., 1]], -1), normal


def capsule(u: torch.Tensor) -> Surface:
    radius, half = _uniform((len(u), 1), 0.25, 0.38, u), _uniform((len(u), 1), 0.45, 0.65, u)
    direction = _sphere(u)
    on_side = u[..., 2] * (half + radius) < half
    level = torch.where(on_side, (u[..., 3] * 2 - 1) * half, direction[..., 2].sign() * half)
    around = _normalise(torch.cat([direction[..., :2], torch.zeros_like(level)[..., None]], -1))
    normal = torch.where(on_side[..., None], around, direction)
    lift = torch.stack([0 * level, 0 * level, level], -1)
    return normal * radius[..., None] + lift, normal


def monkey(u: torch.Tensor) -> Surface:
    """A head, a muzzle, two ears, a brow: ellipsoids, whose insides nobody sees."""
    n = len(u)
    vary = lambda *values: torch.tensor(values, device=u.device) * _uniform((n, 1, 3), 0.9, 1.1, u)
    parts = [
        (vary(0.62, 0.55, 0.58), vary(0.0, 0.0, 0.12)),
        (vary(0.36, 0.3, 0.27), vary(0.0, -0.38, -0.3)),
        (vary(0.25, 0.08, 0.24), vary(-0.75, 0.1, 0.15)),
        (vary(0.25, 0.08, 0.24), vary(0.75, 0.1, 0.15)),
        (vary(0.42, 0.16, 0.13), vary(0.0, -0.45, 0.25)),
    ]
    part = torch.bucketize(u[..., 2].contiguous(), torch.tensor([0.5, 0.68, 0.78, 0.88], device=u.device))
    radii = torch.stack([r.expand(n, 1, 3)[:, 0] for r, _ in parts], 1)
    centres = torch.stack([c.expand(n, 1, 3)[:, 0] for _, c in parts], 1)
    pick = part[..., None].expand(-1, -1, 3)
    points, normal = _ellipsoid(u, radii.gather(1, pick))
    return points + centres.gather(1, pick), normal


SAMPLERS = {
    "ball": ball,
    "box": box,
    "cone": cone,
    "cylinder": cylinder,
    "ring": ring,
    "pyramid": pyramid,
    "plate": plate,
    "rock": rock,
    "star": star,
    "capsule": capsule,
    "monkey": monkey,
}
