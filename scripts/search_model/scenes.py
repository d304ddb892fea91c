"""Scenes to search in: a target that was never trained on, something of its colours, something of its
shape, and others."""

import itertools
import random
from functools import cache

from .attributes import COLOR_NAMES, NEUTRAL, PATTERN_NAMES, SHAPE_NAMES, Claim, Look, truth


@cache
def all_looks() -> list[Look]:
    plain = [Look(s, "plain", (c,)) for s in SHAPE_NAMES for c in COLOR_NAMES]
    pairs = list(itertools.combinations(COLOR_NAMES, 2))
    two = [Look(s, p, c) for s in SHAPE_NAMES for p in PATTERN_NAMES[1:] for c in pairs]
    return plain + two


def random_look(rng: random.Random, held_out: bool) -> Look:
    """Plain ones are a third, and two fifths of the others have a neutral colour by design; the
    held-out ones are never trained on, the others are."""
    while True:
        shape, pattern = rng.choice(SHAPE_NAMES), rng.choice(PATTERN_NAMES[1:])
        colors = rng.sample(COLOR_NAMES, 2)
        if rng.random() < 0.4 and colors[0] not in NEUTRAL:
            colors[1] = rng.choice(sorted(NEUTRAL))
        look = Look(shape, pattern, tuple(colors))
        if rng.random() < 1 / 3:
            look = Look(shape, "plain", look.colors[:1])
        if look.held_out() == held_out:
            return look


def phrase_and_claim(look: Look) -> tuple[str, Claim]:
    """Everything there is to say about an object."""
    pattern = "" if look.pattern in ("plain", "two-tone") else look.pattern + " "
    claim = Claim(look.shape, look.pattern if pattern else None, look.colors)
    shape = "monkey head" if look.shape == "monkey" else look.shape
    return f"{' and '.join(look.colors)} {pattern}{shape}", claim


def random_scene(rng: random.Random, held_out: bool = True, count: int = 6) -> list[Look]:
    """The first look is the target, the second has its colours, the third its shape; the target's
    full description is false of all others."""
    target = random_look(rng, held_out)
    _, claim = phrase_and_claim(target)
    other_shapes = [s for s in SHAPE_NAMES if s != target.shape]
    same_color = Look(rng.choice(other_shapes), target.pattern, target.colors)
    looks = [target, same_color]
    while len(looks) < count:
        look = random_look(rng, held_out=False)
        if len(looks) == 2:
            look = Look(target.shape, look.pattern, look.colors)
        if truth(claim, look) == -1:
            looks.append(look)
    return looks
