"""Texts about objects, and texts about nothing, as words and as CLIP's tokens."""

import json
import pathlib
import random

from .attributes import COLORS, PATTERN_NOUNS, PATTERNS, SHAPES, Claim, Look, NEUTRAL

TOKENS_FILE = pathlib.Path(__file__).parent / "tokens.json"
UNKNOWN = "\N{REPLACEMENT CHARACTER}"

# What a search asks with, and what it compares to; model.json repeats them.
TEMPLATES = ["a photo of a {}.", "{}", "a 3d render of a {}."]
BACKGROUND = ["something", "an unknown object", "a picture of something else"]

FRAMES = [
    *TEMPLATES,
    *["{}"] * 4,
    *["a {}"] * 2,
    *["the {}"] * 2,
    "a picture of a {}",
    "an image of a {}.",
    "a blurry photo of the {}.",
    "a 3d model of a {}",
    "this is a {}",
    "there is a {} in the scene",
    "where is the {}",
    "find the {}",
    "show me the {}",
    "one {} on its own",
    "something {}",
    "a small {}",
    "a big {}",
    "the large {}",
    "a little {}",
    "a tiny {}",
    "a huge {}",
]
THINGS = ["thing", "object", "shape", "toy"]
FUNCTION_WORDS = (
    "a an the and or of in on at to with from by for is are it its this that these one two some any "
    "something anything nothing else unknown what where which find show me my there here not no very "
    "small big large little tiny huge old new photo picture image render model 3d scene view object "
    "thing shape toy colored coloured pattern own blurry other its . , ! ?"
).split()


def words() -> list[str]:
    """Every word that has a meaning for the model."""
    texts = [*FRAMES, *BACKGROUND, *THINGS, *FUNCTION_WORDS, "dot", "polka"]
    for names in (*SHAPES.values(), *PATTERNS.values(), *PATTERN_NOUNS.values()):
        texts += names
    texts += [name for names, *_ in COLORS.values() for name in names]
    found = {word for text in texts for word in _split(text.replace("{}", " "))}
    return sorted(found)


def load_tokens() -> dict[str, list[int]]:
    return json.loads(TOKENS_FILE.read_text())


def encode(text: str, tokens: dict[str, list[int]], unknown_token: int) -> list[int]:
    """CLIP's tokens of a text of known words; every UNKNOWN is one `unknown_token`."""
    row = [49406]
    for word in _split(text):
        row += [unknown_token] if word == UNKNOWN else tokens[word]
    return [*row, 49407]


def _split(text: str) -> list[str]:
    for mark in ".,!?":
        text = text.replace(mark, f" {mark} ")
    return text.split()


def describe(look: Look, rng: random.Random) -> tuple[str, Claim]:
    """A text that is true of the object; it may leave things out."""
    shape = rng.choice(SHAPES[look.shape]) if rng.random() < 0.6 else SHAPES[look.shape][0]
    said_shape = look.shape
    if rng.random() < 0.12:
        shape, said_shape = rng.choice([*THINGS, ""]), None
    names = [rng.choice(COLORS[c][0]) if rng.random() < 0.4 else c for c in look.colors]
    pattern_words = PATTERNS[look.pattern]
    often = 0.15 if look.pattern == "plain" else 0.5
    pattern = rng.choice(pattern_words) if pattern_words and rng.random() < often else None
    claim = Claim(shape=said_shape, pattern=look.pattern if pattern else None)

    chromatic = [c for c in look.colors if c not in NEUTRAL]
    if len(look.colors) == 1:
        phrase, said = _plain(names[0], look.colors[0], shape, pattern, rng)
    elif rng.random() < 0.45 and len(chromatic) == 1:
        name = names[look.colors.index(chromatic[0])]
        pattern = pattern if rng.random() < 0.4 else None
        claim = Claim(shape=said_shape, pattern=look.pattern if pattern else None)
        phrase, said = _adjectives([name, pattern], shape, rng), (chromatic[0],)
    else:
        phrase, said = _two_colors(names, look, shape, pattern, rng)
    if not said and said_shape is None and pattern is None:
        return describe(look, rng)
    return rng.choice(FRAMES).format(phrase), Claim(claim.shape, claim.pattern, said)


def _plain(name: str, color: str, shape: str, pattern: str | None, rng: random.Random):
    if rng.random() < 0.12:
        return _adjectives([pattern], shape, rng), ()
    return _adjectives([name, pattern], shape, rng), (color,)


def _two_colors(names: list[str], look: Look, shape: str, pattern: str | None, rng: random.Random):
    first, second = rng.sample(names, 2)
    draw = rng.random()
    if pattern is not None and draw < 0.3:
        return _adjectives([pattern], shape, rng), ()
    if pattern is None and draw < 0.12:
        return shape, ()
    if pattern is not None and draw < 0.45:
        noun = rng.choice(PATTERN_NOUNS[look.pattern])
        return f"{shape} with {first} and {second} {noun}", look.colors
    return _adjectives([f"{first} and {second}", pattern], shape, rng), look.colors


def _adjectives(words: list[str | None], noun: str, rng: random.Random) -> str:
    kept = [word for word in words if word]
    rng.shuffle(kept)
    if rng.random() < 0.04:
        kept.insert(rng.randrange(len(kept) + 1), UNKNOWN)
    return " ".join([*kept, noun]).strip()


def nonsense(rng: random.Random) -> tuple[str, Claim]:
    """A text that is true of no object: unknown words, with known ones around them that make no
    object, or words without a noun."""
    color = rng.choice([name for names, *_ in COLORS.values() for name in names])
    pattern = rng.choice([name for names in PATTERNS.values() for name in names])
    known = rng.choice([color, pattern, f"{color} and {rng.choice(list(COLORS))}", f"{pattern} {color}"])
    draw = rng.random()
    if draw < 0.35:
        text = rng.choice(FRAMES).format(" ".join([UNKNOWN] * rng.randint(1, 4)))
    elif draw < 0.65:
        text = rng.choice(FRAMES).format(f"{known} " + " ".join([UNKNOWN] * rng.randint(1, 3)))
    elif draw < 0.85:
        row = [UNKNOWN] * rng.randint(3, 10) + rng.choices(FUNCTION_WORDS, k=rng.randint(0, 6))
        if rng.random() < 0.4:
            row.append(rng.choice([color, pattern, rng.choice(list(SHAPES))]))
        rng.shuffle(row)
        text = " ".join(row)
    else:
        text = " ".join(rng.choices(FUNCTION_WORDS, k=rng.randint(0, 6)))
    return text, Claim(nothing=True)


def write_tokens() -> None:
    """Looks every word up in open_clip's tokenizer; run once when the words change."""
    import open_clip

    tokenizer = open_clip.get_tokenizer("MobileCLIP2-S0")
    table = {word: [t for t in tokenizer([word])[0].tolist() if t][1:-1] for word in words()}
    TOKENS_FILE.write_text(json.dumps(table, indent=0) + "\n")


if __name__ == "__main__":
    write_tokens()
