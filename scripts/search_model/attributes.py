"""What the bundled model can tell apart: shapes, colours and patterns; which combinations are held
out of training; and whether a text is true of an object."""

from dataclasses import dataclass

import torch

SHAPES = {
    "ball": ["ball", "sphere", "globe", "orb"],
    "box": ["box", "cube", "block", "crate"],
    "cone": ["cone"],
    "cylinder": ["cylinder", "can", "tin", "drum", "barrel", "column"],
    "ring": ["ring", "torus", "donut", "doughnut", "hoop"],
    "pyramid": ["pyramid"],
    "plate": ["plate", "floor", "ground", "disc", "disk", "board", "tile", "platform", "slab"],
    "rock": ["rock", "stone", "blob", "lump", "boulder"],
    "star": ["star"],
    "capsule": ["capsule", "pill"],
    "monkey": ["monkey head", "monkey", "head", "face", "animal head", "ape"],
}

# Hue in degrees, saturation, value: ranges with gaps between neighbours, so that a name is right.
COLORS = {
    "red": (["red", "crimson", "scarlet"], (-8, 8), (0.72, 1.0), (0.55, 1.0)),
    "orange": (["orange"], (21, 34), (0.8, 1.0), (0.82, 1.0)),
    "yellow": (["yellow"], (48, 60), (0.65, 1.0), (0.8, 1.0)),
    "green": (["green"], (95, 150), (0.55, 1.0), (0.35, 0.85)),
    "cyan": (["cyan", "turquoise", "teal", "aqua"], (174, 192), (0.55, 1.0), (0.6, 1.0)),
    "blue": (["blue", "navy"], (212, 242), (0.65, 1.0), (0.45, 1.0)),
    "purple": (["purple", "violet"], (262, 290), (0.5, 0.95), (0.4, 0.85)),
    "pink": (["pink", "magenta"], (318, 342), (0.35, 0.8), (0.85, 1.0)),
    "brown": (["brown"], (18, 34), (0.5, 0.8), (0.28, 0.52)),
    "beige": (["beige", "tan"], (28, 42), (0.2, 0.45), (0.75, 0.95)),
    "white": (["white"], (0, 360), (0.0, 0.05), (0.9, 1.0)),
    "grey": (["grey", "gray"], (200, 230), (0.0, 0.25), (0.4, 0.75)),
    "black": (["black"], (0, 360), (0.0, 0.3), (0.02, 0.13)),
}
NEUTRAL = {"white", "grey", "black"}

# A two-tone object has two colours in halves, faces or patches, for which there is no one word.
PATTERNS = {
    "plain": ["plain", "solid", "uniform"],
    "striped": ["striped", "stripy", "banded"],
    "checkered": ["checkered", "chequered", "checked", "checkerboard"],
    "dotted": ["dotted", "spotted"],
    "two-tone": [],
}
PATTERN_NOUNS = {"striped": ["stripes"], "checkered": ["checks", "squares"], "dotted": ["dots", "spots"]}

SHAPE_NAMES, COLOR_NAMES, PATTERN_NAMES = list(SHAPES), list(COLORS), list(PATTERNS)


@dataclass(frozen=True)
class Look:
    """An object's shape, pattern and colours (one if plain, else two, in no order)."""

    shape: str
    pattern: str
    colors: tuple[str, ...]

    def held_out(self) -> bool:
        """True of a fifth of the pairs (shape, colour) and of a quarter of the triples (shape, two
        colours), whatever the pattern: no image and no text of these is trained on. An object
        in a colour and white, grey or black goes with the pair, as "red ball" may mean it."""
        shape = SHAPE_NAMES.index(self.shape)
        indices = [COLOR_NAMES.index(color) for color in self.colors]
        named = [c for c in self.colors if c not in NEUTRAL] or list(self.colors)
        if len(named) == 1 and (2 * shape + 3 * COLOR_NAMES.index(named[0])) % 5 == 0:
            return True
        return len(indices) == 2 and (shape + 3 * sum(indices)) % 4 == 0


@dataclass(frozen=True)
class Claim:
    """What a text says: None where it says nothing. `nothing` is a text that is true of no object."""

    shape: str | None = None
    pattern: str | None = None
    colors: tuple[str, ...] = ()
    nothing: bool = False


def truth(claim: Claim, look: Look) -> int:
    """1 where the claim is true of the object, −1 where it is false, 0 where people would disagree."""
    if claim.nothing:
        return -1
    if claim.shape not in (None, look.shape) or claim.pattern not in (None, look.pattern):
        return -1
    if not claim.colors:
        return 1
    if len(claim.colors) == 2:
        return 1 if set(claim.colors) == set(look.colors) else -1
    [color] = claim.colors
    if color not in look.colors:
        return -1
    if len(look.colors) == 1:
        return 1
    # A red and white ball is called red; a red and blue one, or a white one with red, is arguable.
    [other] = set(look.colors) - {color}
    return 1 if other in NEUTRAL and color not in NEUTRAL else 0


def look_table(looks: list[Look]) -> torch.Tensor:
    """[n, 4]: indices of shape, pattern and the two colours (the same one twice if plain)."""
    rows = [
        [
            SHAPE_NAMES.index(look.shape),
            PATTERN_NAMES.index(look.pattern),
            COLOR_NAMES.index(look.colors[0]),
            COLOR_NAMES.index(look.colors[-1]),
        ]
        for look in looks
    ]
    return torch.tensor(rows)


def claim_table(claims: list[Claim]) -> torch.Tensor:
    """[m, 5]: indices of shape, pattern and two colours, −1 where nothing is said (the same colour
    twice where one is); then 1 for a claim that is true of nothing."""
    rows = [
        [
            SHAPE_NAMES.index(claim.shape) if claim.shape else -1,
            PATTERN_NAMES.index(claim.pattern) if claim.pattern else -1,
            COLOR_NAMES.index(claim.colors[0]) if claim.colors else -1,
            COLOR_NAMES.index(claim.colors[-1]) if claim.colors else -1,
            int(claim.nothing),
        ]
        for claim in claims
    ]
    return torch.tensor(rows)


def truth_table(claims: torch.Tensor, looks: torch.Tensor) -> torch.Tensor:
    """`truth` of every claim (columns) of every look (rows): [n, m]."""
    shape, pattern, a, b = looks[:, :, None].unbind(1)
    said_shape, said_pattern, c, d, nothing = claims.unbind(1)
    neutral = torch.tensor([name in NEUTRAL for name in COLOR_NAMES], device=looks.device)
    one = c == d
    has = (c == a) | (c == b)
    other = torch.where(c == a, b, a)
    arguable = one & has & (a != b) & ~(neutral[other] & ~neutral[c.clamp_min(0)])
    both = ((c == a) & (d == b)) | ((c == b) & (d == a))
    colors_right = torch.where(one, has, both) | (c < 0)
    right = colors_right & ((said_shape < 0) | (said_shape == shape))
    right = right & ((said_pattern < 0) | (said_pattern == pattern)) & (nothing == 0)
    value = torch.where(right, 1, -1)
    return torch.where(right & arguable & (c >= 0), 0, value)
