#!/usr/bin/env python3
"""Makes the bundled search model of a checkpoint of scripts/train-search-model.py.

    scripts/export-search-model.py out/search-model.pt assets/search-model

Writes image.onnx, text.onnx and model.json, and compares both towers with PyTorch. Needs torch, onnx
and onnxruntime.
"""

import argparse
import hashlib
import json
import pathlib

import torch

from search_model.captions import BACKGROUND, TEMPLATES, load_tokens
from search_model.networks import SIZE, Calibrated, ImageTower, TextTower
from search_model.towers import Preprocessing, export_towers, verify_towers

MOST_BYTES = 8_000_000  # of both towers


def part(state: dict[str, torch.Tensor], prefix: str) -> dict[str, torch.Tensor]:
    return {name.removeprefix(prefix): v for name, v in state.items() if name.startswith(prefix)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkpoint", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    arguments = parser.parse_args()
    state = torch.load(arguments.checkpoint, weights_only=True)["model"]
    image, score = ImageTower().eval(), Calibrated()
    text = TextTower([token for row in load_tokens().values() for token in row]).eval()
    for module, prefix in [(image, "image."), (text, "text."), (score, "score.")]:
        module.load_state_dict(part(state, prefix))
    weights = hashlib.sha256(b"".join(v.contiguous().numpy().tobytes() for v in state.values()))
    # Trained for 0.5; scenes that look less like the training's score lower, and nonsense far below. At
    # this threshold scripts/evaluate-search-model.py finds 99.5 % of the targets and 2.3 % of the nonsense.
    export_towers(
        arguments.out,
        image,
        text,
        "trapeze-objects",
        f"trapeze-objects {weights.hexdigest()[:12]}",
        Preprocessing(SIZE, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
        score.scale().item(),
        search={"templates": TEMPLATES, "background": BACKGROUND, "threshold": 0.02},
    )
    size = sum((arguments.out / f).stat().st_size for f in ("image.onnx", "text.onnx"))
    if size > MOST_BYTES:
        raise SystemExit(f"error: {arguments.out}: expected at most {MOST_BYTES} bytes, found {size}")
    differences = verify_towers(arguments.out, image, text)
    print(json.dumps({"bytes": size, "difference_from_pytorch": differences}))


main()
