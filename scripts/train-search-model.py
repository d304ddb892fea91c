#!/usr/bin/env python3
"""Trains the bundled search model on procedurally made objects and writes its checkpoint.

    scripts/train-search-model.py out/search-model.pt --seconds 260

Objects are splats made on the device as they are needed: shapes × colours × patterns × proportions ×
light × faults, rendered as a search's crops. A fifth of the combinations is held out
(search_model/attributes.py). Nothing else is trained on. With a GPU a few minutes suffice.
scripts/export-search-model.py makes the model of the checkpoint. Needs torch, and Triton on a GPU.
"""

import argparse
import copy
import json
import math
import pathlib
import random
import time

import torch
from torch.nn.functional import normalize

from search_model.attributes import Look, claim_table, look_table, truth_table
from search_model.captions import BACKGROUND, TEMPLATES, describe, encode, load_tokens, nonsense
from search_model.crops import render_crops
from search_model.networks import SIZE, Calibrated, ImageTower, TextTower
from search_model.objects import make_splats
from search_model.scenes import phrase_and_claim, random_look, random_scene

VIEWS = 2
TEXT_LENGTH = 40


class Texts(torch.utils.data.IterableDataset):
    """Endless batches of what is trained on: looks, and tokens and claims about them."""

    def __init__(self, objects: int, nonsense_share: float, seed: int):
        self.objects, self.nonsense, self.seed = objects, int(objects * nonsense_share), seed
        self.tokens = load_tokens()
        self.known = {token for row in self.tokens.values() for token in row}

    def row(self, text: str, rng: random.Random) -> list[int]:
        unknown = 1
        while unknown in self.known or unknown == 1:
            unknown = rng.randrange(1, 49406)
        row = encode(text, self.tokens, unknown)[: TEXT_LENGTH - 1]
        row = row if row[-1] == 49407 else [*row, 49407]
        return row + [0] * (TEXT_LENGTH - len(row))

    def about(self, looks: list[Look], rng: random.Random) -> tuple[torch.Tensor, torch.Tensor]:
        """Tokens and claims: one text for each look, then nonsense."""
        pairs = [describe(look, rng) for look in looks]
        pairs += [nonsense(rng) for _ in range(self.nonsense)]
        rows = torch.tensor([self.row(text, rng) for text, _ in pairs])
        return rows, claim_table([claim for _, claim in pairs])

    def __iter__(self):
        worker = torch.utils.data.get_worker_info()
        rng = random.Random(self.seed * 1000 + (worker.id if worker else 0))
        while True:
            looks = [random_look(rng, held_out=False) for _ in range(self.objects)]
            yield look_table(looks), *self.about(looks, rng)


class Model(torch.nn.Module):
    def __init__(self, tokens: dict[str, list[int]]):
        super().__init__()
        self.image = ImageTower()
        self.text = TextTower([token for row in tokens.values() for token in row])
        self.score = Calibrated()


def threshold_loss(logits: torch.Tensor, truth: torch.Tensor) -> torch.Tensor:
    """For each row: true ones above zero, false ones below, the worst counting most
    (Su et al. 2022, "ZLPR"). Arguable ones do not count."""
    zero = torch.zeros_like(logits[:, :1])
    never = torch.full_like(logits, -1e4)
    false = torch.where(truth < 0, logits, never)
    true = torch.where(truth > 0, -logits, never)
    rows = torch.cat([zero, false], 1).logsumexp(1) + torch.cat([zero, true], 1).logsumexp(1)
    return rows.mean()


def with_mean(single: torch.Tensor) -> torch.Tensor:
    """Features [n, views, d] of unit length, one per view, then their mean: [views + 1, n, d]."""
    single = normalize(single.float(), dim=-1).transpose(0, 1)
    return torch.cat([single, normalize(single.sum(0), dim=-1)[None]])


def search_loss(model: Model, image: torch.Tensor, text: torch.Tensor, truth: torch.Tensor):
    """`image` as of with_mean; `text` has the background's features last."""
    text, ground = text.split([truth.shape[1], len(text) - truth.shape[1]])
    loss = 0.0
    for feature in image:
        logits = model.score(feature, text, ground)
        loss = loss + threshold_loss(logits, truth) + threshold_loss(logits.T, truth.T)
    return loss


class Run:
    """Optimiser, schedule, running average and printed lines of one training."""

    def __init__(self, model: Model, parameters: list[torch.nn.Parameter], arguments):
        self.model, self.average, self.arguments = model, copy.deepcopy(model), arguments
        groups = [
            {"params": [p for p in parameters if p.dim() > 1], "weight_decay": 0.03},
            {"params": [p for p in parameters if p.dim() <= 1], "weight_decay": 0.0},
        ]
        self.parameters = parameters
        self.optimizer = torch.optim.AdamW(groups, fused=parameters[0].is_cuda)
        self.start, self.step, self.shown = time.monotonic(), 0, 0.0

    def goes_on(self) -> bool:
        elapsed = time.monotonic() - self.start
        limit = self.arguments
        progress = max(elapsed / limit.seconds, self.step / limit.steps)
        cosine = 0.5 + 0.5 * math.cos(math.pi * min(progress, 1))
        rate = limit.rate * min(1, (self.step + 1) / 200) * cosine
        for group in self.optimizer.param_groups:
            group["lr"] = rate
        return progress < 1

    def update(self, loss: torch.Tensor) -> None:
        self.optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.parameters, 2.0)
        self.optimizer.step()
        update_average(self.average, self.model, min(0.998, self.step / (self.step + 20)))
        self.step += 1
        elapsed = time.monotonic() - self.start
        if elapsed - self.shown > self.arguments.report:
            self.shown = elapsed
            scale = self.model.score.scale().item()
            values = f"step {self.step}  loss {loss.item():.3f}  scale {scale:.1f}"
            print(f"{elapsed:5.0f} s  {values}", flush=True)


def background_rows(dataset: Texts) -> torch.Tensor:
    return torch.tensor([dataset.row(text, random.Random(0)) for text in BACKGROUND])


def train(model: Model, arguments, device: torch.device) -> Model:
    """Both towers, on objects that are made as they are needed."""
    dataset = Texts(arguments.objects, 0.25, arguments.seed)
    workers = arguments.workers
    loader = iter(torch.utils.data.DataLoader(dataset, batch_size=None, num_workers=workers))
    background = background_rows(dataset)
    run = Run(model, list(model.parameters()), arguments)
    while run.goes_on():
        looks, tokens, claims = next(loader)
        with torch.no_grad():
            crops = render_crops(make_splats(looks, arguments.splats, device), VIEWS, SIZE)
            truth = truth_table(claims.to(device), looks.to(device))
        with torch.autocast(device.type, torch.bfloat16, enabled=device.type == "cuda"):
            single = model.image(crops.contiguous(memory_format=torch.channels_last))
            text = model.text(torch.cat([tokens, background]).to(device))
        image = with_mean(single.view(len(looks), VIEWS, -1))
        run.update(search_loss(model, image, normalize(text.float(), dim=-1), truth))
    print(f"{run.step} steps of {arguments.objects} objects", flush=True)
    return run.average


@torch.no_grad()
def update_average(average: Model, model: Model, keep: float) -> None:
    for to, new in [(average.parameters(), model.parameters()), (average.buffers(), model.buffers())]:
        to, new = list(to), list(new)
        pairs = [(a, b) for a, b in zip(to, new) if a.is_floating_point()]
        torch._foreach_lerp_([a for a, _ in pairs], [b for _, b in pairs], 1 - keep)


@torch.no_grad()
def evaluate(model: Model, device: torch.device, scenes: int, splats: int, seed: int = 5) -> dict:
    """Top-1 over scenes of six with distractors of the same colours and the same shape, and how
    often a score passes one half. Fresh objects, by the renderer of the training."""
    model.eval()
    rng, dataset = random.Random(seed), Texts(1, 0, 0)

    def encoded(texts: list[str]) -> torch.Tensor:
        rows = torch.tensor([dataset.row(text, rng) for text in texts], device=device)
        return normalize(model.text(rows), dim=-1)

    def asked(phrases: list[str]) -> torch.Tensor:
        means = [encoded([t.format(phrase) for t in TEMPLATES]).mean(0) for phrase in phrases]
        return normalize(torch.stack(means), dim=-1)

    ground = encoded(BACKGROUND)
    result = {}
    for name, held_out in [("trained", False), ("held_out", True)]:
        all_scenes = [random_scene(rng, held_out) for _ in range(scenes)]
        looks = look_table([look for scene in all_scenes for look in scene])
        parts = [make_splats(part, splats, device) for part in looks.split(240)]
        crops = torch.cat([render_crops(part, 4, SIZE) for part in parts])
        single = torch.cat([normalize(model.image(part), dim=-1) for part in crops.split(960)])
        single = single.view(scenes, 6, 4, -1)
        text = asked([phrase_and_claim(scene[0])[0] for scene in all_scenes])
        odd = asked([nonsense(rng)[0] for _ in range(scenes)])
        for views in (1, 2, 4):
            image = normalize(single[:, :, :views].sum(2), dim=-1)
            score = lambda i, t: model.score(i, t[None], ground)[:, 0]
            logits = torch.stack([score(i, t) for i, t in zip(image, text)])
            strange = torch.stack([score(i, t) for i, t in zip(image, odd)])
            result[f"{name}, {views} views"] = summary(logits, strange)
    return result


def summary(logits: torch.Tensor, strange: torch.Tensor) -> dict:
    """`logits` [scenes, 6] of the target's phrase, the target first; `strange` of nonsense."""
    share = lambda mask: round(mask.float().mean().item(), 4)
    best = logits.argmax(1)
    return {
        "top1": share(best == 0),
        "lost_to_same_colors": share(best == 1),
        "lost_to_same_shape": share(best == 2),
        "target_above_half": share(logits[:, 0] > 0),
        "others_above_half": share(logits[:, 1:] > 0),
        "nonsense_above_half": share(strange.amax(1) > 0),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--start", type=pathlib.Path, help="checkpoint to go on from")
    parser.add_argument("--seconds", type=float, default=260)
    parser.add_argument("--steps", type=int, default=10**9)
    parser.add_argument("--objects", type=int, default=512, help="per step")
    parser.add_argument("--splats", type=int, default=3072, help="per object")
    parser.add_argument("--rate", type=float, default=2e-3)
    parser.add_argument("--scenes", type=int, default=400, help="to evaluate on afterwards")
    parser.add_argument("--workers", type=int, default=6)
    parser.add_argument("--report", type=float, default=10, help="seconds between lines")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    torch.manual_seed(arguments.seed)
    if device.type == "cpu":
        torch.set_num_threads(1)
    torch.backends.cudnn.benchmark = True
    torch.set_float32_matmul_precision("high")
    model = Model(load_tokens()).to(device)
    model.image.to(memory_format=torch.channels_last)
    if arguments.start is not None:
        model.load_state_dict(torch.load(arguments.start, weights_only=True)["model"])
    average = train(model, arguments, device)
    state = {"model": {name: value.cpu() for name, value in average.state_dict().items()}}
    torch.save(state, arguments.out)
    state["evaluation"] = evaluate(average, device, arguments.scenes, arguments.splats)
    print(json.dumps(state["evaluation"], indent=1))
    torch.save(state, arguments.out)


if __name__ == "__main__":
    main()
