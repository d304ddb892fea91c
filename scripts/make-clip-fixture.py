#!/usr/bin/env python3
"""Makes tests/fixtures/clip: a small model of MobileCLIP2's graph family with PyTorch's outputs, and
images resized by PIL. Tests compare the program's towers and its resize with them.

    scripts/make-clip-fixture.py tests/fixtures/clip

The graph has what MobileCLIP2-S0 has (MobileOne stem and patch embeddings, RepMixer blocks,
squeeze-and-excitation, attention with a conditional position encoding, a text transformer without
causal mask), with few channels and random weights. Of the vocabulary's 49 408 rows it keeps 509,
addressed by the token modulo 509, so that real tokens can be given to it.

Needs: pip install open-clip-torch==3.3.0 onnx onnxruntime
"""

import argparse
import copy
import functools
import pathlib

import numpy
import open_clip
import PIL.Image
import timm.models.fastvit as fastvit
import timm.utils
import torch
from open_clip.transform import image_transform
from open_clip.transformer import TextTransformer

from search_model.towers import Preprocessing, export_towers, verify_towers

SIZE = 64
DIMENSION = 32
ROWS = 509
# Shapes at which a resize can go wrong: shrinking and growing, odd, wide, tall, thin, already right.
IMAGES = {"shrink": (203, 151), "grow": (23, 31), "wide": (301, 70), "tall": (65, 97), "same": (64, 64)}
TEXTS = ["a red ball", "blue and yellow box", "", "The quick brown fox jumps over the lazy dog"]


class FewRows(torch.nn.Module):
    """An embedding whose rows are shared by the tokens with the same remainder."""

    def __init__(self, rows: int, width: int):
        super().__init__()
        self.table = torch.nn.Parameter(torch.randn(rows, width))

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        return torch.nn.functional.embedding(tokens % len(self.table), self.table)


def make_image_tower() -> torch.nn.Module:
    encoding = functools.partial(fastvit.RepConditionalPosEnc, spatial_shape=(7, 7))
    return fastvit.FastVit(
        layers=(1, 1, 1, 1),
        embed_dims=(8, 16, 32, 32),
        mlp_ratios=(2, 2, 2, 2),
        se_downsamples=(False, False, True, True),
        pos_embs=(None, None, None, encoding),
        token_mixers=("repmixer", "repmixer", "repmixer", "attention"),
        lkc_use_act=True,
        num_classes=DIMENSION,
    )


def make_text_tower() -> torch.nn.Module:
    tower = TextTransformer(
        width=32, heads=4, layers=2, output_dim=DIMENSION, vocab_size=ROWS, no_causal_mask=True
    )
    tower.token_embedding = FewRows(ROWS, 32)
    torch.nn.init.normal_(tower.positional_embedding, std=0.5)
    return tower


def randomise(model: torch.nn.Module) -> None:
    """Makes every branch and every statistic matter; see export-mobileclip.py."""
    for module in model.modules():
        if isinstance(module, torch.nn.BatchNorm2d):
            for tensor, low, high in [
                (module.weight, 0.5, 1.5),
                (module.bias, -0.3, 0.3),
                (module.running_mean, -0.3, 0.3),
                (module.running_var, 0.5, 1.5),
            ]:
                torch.nn.init.uniform_(tensor, low, high)
    for name, parameter in model.named_parameters():
        if name.endswith("gamma") or "layer_scale" in name:
            torch.nn.init.uniform_(parameter, 0.2, 0.6)
        elif parameter.dim() > 1 and "embedding" not in name:
            torch.nn.init.normal_(parameter, std=(2.0 / parameter[0].numel()) ** 0.5)


def picture(size: tuple[int, int], random: numpy.random.Generator) -> PIL.Image.Image:
    """A gradient, stripes too fine for the resized image, and noise: what aliasing shows on."""
    width, height = size
    x, y = numpy.meshgrid(numpy.arange(width), numpy.arange(height))
    red = 255 * x / width
    green = 127.5 + 127.5 * numpy.sin(2.1 * x + 0.7 * y)
    blue = random.integers(0, 256, (height, width))
    return PIL.Image.fromarray(numpy.stack([red, green, blue], axis=-1).astype(numpy.uint8))


def write_resize_fixtures(folder: pathlib.Path, random: numpy.random.Generator) -> None:
    """NAME.png, and NAME-64.png as open_clip's own transform for MobileCLIP resizes and cuts it."""
    folder.mkdir(parents=True, exist_ok=True)
    transform = image_transform(
        SIZE,
        is_train=False,
        mean=(0.0, 0.0, 0.0),
        std=(1.0, 1.0, 1.0),
        resize_mode="shortest",
        interpolation="bilinear",
    )
    for name, size in IMAGES.items():
        image = picture(size, random)
        image.save(folder / f"{name}.png", optimize=True)
        levels = (transform(image) * 255).round().byte().permute(1, 2, 0).numpy()
        PIL.Image.fromarray(levels).save(folder / f"{name}-{SIZE}.png", optimize=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=pathlib.Path)
    folder = parser.parse_args().out
    random = numpy.random.default_rng(3)
    torch.manual_seed(3)

    image_tower, text_tower = make_image_tower().eval(), make_text_tower().eval()
    randomise(image_tower)
    randomise(text_tower)
    fused = timm.utils.reparameterize_model(copy.deepcopy(image_tower))
    preprocessing = Preprocessing(SIZE, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    export_towers(folder, fused, text_tower, "small", "small random 3", preprocessing, 100.0)
    print(verify_towers(folder, image_tower, text_tower))

    images = torch.from_numpy(random.random((3, 3, SIZE, SIZE), dtype=numpy.float32))
    tokens = open_clip.get_tokenizer("MobileCLIP2-S0")(TEXTS)
    with torch.no_grad():
        image_features, text_features = image_tower(images), text_tower(tokens)
    numpy.save(folder / "images.npy", images.numpy())
    numpy.save(folder / "image-features.npy", image_features.numpy())
    numpy.save(folder / "tokens.npy", tokens.numpy())
    numpy.save(folder / "text-features.npy", text_features.numpy())
    write_resize_fixtures(folder / "resize", random)


main()
