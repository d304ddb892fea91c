#!/usr/bin/env python3
"""Makes the files that Trapeze searches with from a MobileCLIP model of open_clip.

    scripts/export-mobileclip.py MobileCLIP2-S0 models/mobileclip2-s0

Writes image.onnx, text.onnx and model.json (docs/formats.md). The trained weights come from
--weights, a checkpoint on disk, or are downloaded by open_clip; read Apple's licence for them first.
--random-weights makes the same graphs without any weights, for tests of everything but meaning.

Needs: pip install open-clip-torch==3.3.0 onnx onnxruntime
"""

import argparse
import copy
import hashlib
import pathlib
import sys

import open_clip
import timm.utils
import torch
from open_clip.constants import OPENAI_DATASET_MEAN, OPENAI_DATASET_STD

from search_model.towers import Preprocessing, export_towers, verify_towers

# Mean and standard deviation of the training images, and open_clip's name of the weights.
# open_clip knows the former only together with weights that it downloads itself: for a local
# checkpoint it would silently take its general ones, so they are set by name here.
PLAIN = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
OPENAI = (OPENAI_DATASET_MEAN, OPENAI_DATASET_STD)
MODELS = {
    "MobileCLIP-S1": (PLAIN, "datacompdr"),
    "MobileCLIP-S2": (PLAIN, "datacompdr"),
    "MobileCLIP-B": (PLAIN, "datacompdr"),
    "MobileCLIP2-S0": (PLAIN, "dfndr2b"),
    "MobileCLIP2-S2": (PLAIN, "dfndr2b"),
    "MobileCLIP2-B": (PLAIN, "dfndr2b"),
    "MobileCLIP2-S3": (OPENAI, "dfndr2b"),
    "MobileCLIP2-S4": (OPENAI, "dfndr2b"),
}


def randomise(model: torch.nn.Module, seed: int) -> None:
    """Makes every parameter matter. As initialised, layer scales of 1e-5 switch the blocks off and
    batch norms are the identity: a wrong graph would give nearly the right features."""
    generator = torch.Generator().manual_seed(seed)

    def uniform(tensor: torch.Tensor, low: float, high: float) -> None:
        tensor.data.uniform_(low, high, generator=generator)

    for module in model.modules():
        if isinstance(module, (torch.nn.BatchNorm1d, torch.nn.BatchNorm2d, torch.nn.LayerNorm)):
            uniform(module.weight, 0.7, 1.3)
            uniform(module.bias, -0.1, 0.1)
        if isinstance(module, (torch.nn.BatchNorm1d, torch.nn.BatchNorm2d)):
            uniform(module.running_mean, -0.1, 0.1)
            uniform(module.running_var, 0.7, 1.3)
    for name, parameter in model.named_parameters():
        if name.endswith("gamma") or "layer_scale" in name:
            uniform(parameter, 0.1, 0.4)


def load(name: str, weights: pathlib.Path | None, random_seed: int | None):
    """The model, and the name of the release that its weights are."""
    if random_seed is not None:
        torch.manual_seed(random_seed)
        model = open_clip.create_model(name, pretrained=None)
        randomise(model, random_seed)
        release = f"{name} random {random_seed}"
    elif weights is not None:
        model = open_clip.create_model(name, pretrained=str(weights))
        release = f"{name} {hashlib.sha256(weights.read_bytes()).hexdigest()[:16]}"
    else:
        tag = MODELS[name][1]
        model = open_clip.create_model(name, pretrained=tag)
        release = f"{name} {tag}"
    return model.eval(), release


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", choices=MODELS)
    parser.add_argument("out", type=pathlib.Path, help="folder for the three files")
    parser.add_argument("--weights", type=pathlib.Path, help="checkpoint on disk")
    parser.add_argument("--random-weights", type=int, metavar="SEED", help="no trained weights")
    parser.add_argument("--verify", action="store_true", help="compare with PyTorch afterwards")
    arguments = parser.parse_args()
    if arguments.weights is not None and arguments.random_weights is not None:
        parser.error("--weights and --random-weights exclude each other")
    if arguments.weights is not None and not arguments.weights.is_file():
        parser.error(f"--weights: expected a file, found none at {arguments.weights}")

    model, release = load(arguments.model, arguments.weights, arguments.random_weights)
    (mean, std), _ = MODELS[arguments.model]
    size = model.visual.image_size[0]
    # MobileOne and RepMixer blocks train with parallel branches that equal one convolution.
    fused = timm.utils.reparameterize_model(copy.deepcopy(model.visual))
    export_towers(
        arguments.out,
        fused,
        model.text,
        arguments.model,
        release,
        Preprocessing(size, tuple(mean), tuple(std)),
        model.logit_scale.exp().item(),
    )
    megabytes = {f: (arguments.out / f).stat().st_size / 1e6 for f in ("image.onnx", "text.onnx")}
    print(", ".join(f"{f} {size:.1f} MB" for f, size in megabytes.items()), "in", arguments.out)
    if arguments.verify:
        # Against the tower with its branches, so that the fusion is checked too.
        differences = verify_towers(arguments.out, model.visual, model.text)
        print(", ".join(f"{name} within {d:.1e} of PyTorch" for name, d in differences.items()))


if __name__ == "__main__":
    try:
        main()
    except (OSError, RuntimeError, ValueError) as error:
        sys.exit(f"error: {error}")
