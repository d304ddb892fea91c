"""Writes the two towers of a CLIP-like model as ONNX with the JSON that describes them, and checks
what was written against PyTorch. The files are described in docs/formats.md."""

import json
import pathlib
import warnings
import zlib
from dataclasses import dataclass

import numpy
import onnx
import onnxruntime
import torch

OPSET = 17
CONTEXT_LENGTH = 77
START_OF_TEXT = 49406
END_OF_TEXT = 49407
INPUTS = {"image": "image", "text": "tokens"}

# Rounding alone: the same operations in another order, over some tens of layers of f32.
TOLERANCE = 1e-4


@dataclass(frozen=True)
class Preprocessing:
    """How an image becomes the tensor of the image tower: the shorter side is resized to `size`
    with PIL's antialiased bilinear filter, the centre is cut out, values in [0, 1] are normalised."""

    size: int
    mean: tuple[float, float, float]
    std: tuple[float, float, float]


def export_towers(
    folder: pathlib.Path,
    image_tower: torch.nn.Module,
    text_tower: torch.nn.Module,
    name: str,
    release: str,
    preprocessing: Preprocessing,
    logit_scale: float,
    search: dict | None = None,
) -> None:
    """Writes image.onnx, text.onnx and model.json. Both graphs take batches of any size and give
    features that are not normalised; `release` is written into all three files. `search` holds the
    prompts and the threshold, where a model has its own."""
    folder.mkdir(parents=True, exist_ok=True)
    size = preprocessing.size
    image = torch.zeros(2, 3, size, size)
    tokens = tokens_of([[START_OF_TEXT, 320, END_OF_TEXT]] * 2)
    dimension = _write_graph(folder, "image", image_tower, image, release)
    text_dimension = _write_graph(folder, "text", text_tower, tokens, release)
    if dimension != text_dimension:
        raise ValueError(f"{name}: image features have {dimension} values, text {text_dimension}")
    description = {
        "format": 1,
        "name": name,
        "release": release,
        "dimension": dimension,
        "logit_scale": round(float(logit_scale), 4),
        "image": {
            "input": INPUTS["image"],
            "output": "embedding",
            "crc32": _crc32(folder / "image.onnx"),
            "size": size,
            "resize": "shortest",
            "filter": "bilinear",
            "mean": list(preprocessing.mean),
            "std": list(preprocessing.std),
        },
        "text": {
            "input": INPUTS["text"],
            "output": "embedding",
            "crc32": _crc32(folder / "text.onnx"),
            "context_length": CONTEXT_LENGTH,
        },
    }
    if search is not None:
        description["search"] = search
    (folder / "model.json").write_text(json.dumps(description, indent=2) + "\n")


def tokens_of(rows: list[list[int]]) -> torch.Tensor:
    """Token rows padded with zeros to the context length, as CLIP's tokenizer does."""
    tokens = torch.zeros(len(rows), CONTEXT_LENGTH, dtype=torch.int64)
    for row, values in zip(tokens, rows):
        row[: len(values)] = torch.tensor(values)
    return tokens


def random_tokens(count: int, generator: torch.Generator) -> torch.Tensor:
    """Texts of 1 to 75 random tokens between the start and the end token."""
    rows = []
    for _ in range(count):
        length = int(torch.randint(1, CONTEXT_LENGTH - 1, (1,), generator=generator))
        words = torch.randint(1, START_OF_TEXT, (length,), generator=generator)
        rows.append([START_OF_TEXT, *words.tolist(), END_OF_TEXT])
    return tokens_of(rows)


def run_graph(path: pathlib.Path, value: torch.Tensor) -> numpy.ndarray:
    """What onnxruntime makes of the only input of a graph."""
    session = onnxruntime.InferenceSession(str(path), providers=["CPUExecutionProvider"])
    return session.run(None, {session.get_inputs()[0].name: value.numpy()})[0]


def normalised(features: numpy.ndarray) -> numpy.ndarray:
    return features / numpy.linalg.norm(features, axis=-1, keepdims=True)


def verify_towers(
    folder: pathlib.Path, image_tower: torch.nn.Module, text_tower: torch.nn.Module, seed: int = 11
) -> dict[str, float]:
    """Largest difference of normalised features between PyTorch and the files, on random inputs
    and two sizes of batch. `image_tower` may be the tower before its branches were fused.
    Raises ValueError beyond TOLERANCE."""
    description = json.loads((folder / "model.json").read_text())
    generator = torch.Generator().manual_seed(seed)
    size = description["image"]["size"]
    differences = {}
    for name, tower, make in [
        ("image", image_tower, lambda n: torch.randn(n, 3, size, size, generator=generator)),
        ("text", text_tower, lambda n: random_tokens(n, generator)),
    ]:
        worst = 0.0
        for count in (1, 3):
            value = make(count)
            with torch.no_grad():
                expected = normalised(tower(value).numpy())
            found = normalised(run_graph(folder / f"{name}.onnx", value))
            worst = max(worst, float(abs(found - expected).max()))
        if not worst <= TOLERANCE:
            raise ValueError(f"{name}.onnx: features differ from PyTorch's by {worst:.1e}")
        differences[name] = worst
    return differences


def _write_graph(
    folder: pathlib.Path, kind: str, tower: torch.nn.Module, value: torch.Tensor, release: str
) -> int:
    """Exports one tower; returns the number of values of a feature."""
    path, name = folder / f"{kind}.onnx", INPUTS[kind]
    tower.eval()
    # The fused attention of nn.MultiheadAttention has no ONNX form.
    torch.backends.mha.set_fastpath_enabled(False)
    with warnings.catch_warnings(), torch.no_grad():
        warnings.simplefilter("ignore")
        torch.onnx.export(
            tower,
            (value,),
            str(path),
            input_names=[name],
            output_names=["embedding"],
            dynamic_axes={name: {0: "batch"}, "embedding": {0: "batch"}},
            opset_version=OPSET,
            # The exporter by tracing: the newer one starts at opset 18 and converts downwards.
            dynamo=False,
        )
        dimension = tower(value).shape[-1]
    graph = onnx.load(str(path))
    onnx.helper.set_model_props(graph, {"release": release, "tower": kind})
    onnx.checker.check_model(graph)
    onnx.save(graph, str(path))
    return dimension


def _crc32(path: pathlib.Path) -> str:
    return f"{zlib.crc32(path.read_bytes()):08x}"
