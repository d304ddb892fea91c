#!/usr/bin/env python3
"""Measures a search model on procedural scenes, through the program itself.

    scripts/evaluate-search-model.py target/release/trapeze docs/benchmarks/search-model.json

Each scene has six objects: a target whose combination of shape and colours the bundled model was never
trained on, one of the same colours, one of the same shape, and three others. The target's
description, a description of something absent and nonsense are searched for. Then the same for other
numbers of views and sizes of crops, on fewer scenes. Needs torch.
"""

import argparse
import concurrent.futures
import functools
import json
import os
import pathlib
import random
import statistics
import subprocess
import tempfile

import torch

from search_model.attributes import truth
from search_model.scene_files import write_scene
from search_model.scenes import phrase_and_claim, random_look, random_scene

ODD_PER_SCENE = 6
# Texts about what no scene here has, in words that people use.
ODD_TEXTS = """
elephant; a cup of coffee; quarterly tax return; my grandmother's recipe; Tuesday afternoon; democracy
seventeen; a barking dog; the smell of rain; wi-fi password; purple elephant; a striped zebra; blue whale
golden retriever puppy; red fire truck; yellow banana; green tea; white wedding dress; black coffee
spotted leopard; checkered past; plain yoghurt; orange juice; brown bear; pink flamingo; grey squirrel
an old wooden chair; city at night; stock market crash; violin concerto; broken heart; parking ticket
the meaning of life; a glass of red wine; blue suede shoes; keyboard; laptop; bicycle; airplane; car
sandwich; umbrella; guitar; bookshelf; sofa; lamp; window; door; tree; flower; grass; sky; cloud
person; man in a hat; woman; child; cat; horse; bird; fish; butterfly; dinosaur; robot; unicorn
pizza with extra cheese; a bowl of soup; strawberry jam; carrot; bread; wine; beer; salt; sugar
lorem ipsum dolor sit amet; to be or not to be; colourless green ideas sleep furiously
the mitochondria is the powerhouse of the cell; please restart the server; press any key to continue
guten Morgen; bonjour tout le monde; buenas noches; 12345; 3.14159; http; ??!; ...; e = mc2
"""


def odd_texts(rng: random.Random) -> list[str]:
    texts = [text.strip() for line in ODD_TEXTS.split("\n") for text in line.split(";") if text.strip()]
    letters = "abcdefghijklmnopqrstuvwxyz"
    for _ in range(24):
        lengths = [rng.randint(3, 9) for _ in range(rng.randint(1, 3))]
        texts.append(" ".join("".join(rng.choices(letters, k=k)) for k in lengths))
    return texts


def absent_phrase(looks: list, rng: random.Random) -> str:
    while True:
        phrase, claim = phrase_and_claim(random_look(rng, rng.random() < 0.5))
        if all(truth(claim, look) == -1 for look in looks):
            return phrase


def search(program: pathlib.Path, scene: pathlib.Path, texts: list[str], views: int, size: int, models):
    """Per text, cluster ids and scores from best to worst; and the whole report."""
    features = scene.parent / f"{scene.name}-{views}-{size}.bin"
    command = [program, "query", scene, *texts, "--json", "--threshold", "0", "--top-k", "6"]
    command += ["--views", str(views), "--crop-size", str(size), "--features", features]
    command += ["--models", models]
    report = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    found = {text: [] for text in texts}
    for result in report["results"]:
        found[result["text"]].append((result["cluster"], result["score"]))
    return found, report


def measure(rows: list[dict], threshold: float) -> dict:
    share = lambda values: round(sum(values) / len(values), 4)
    return {
        "scenes": len(rows),
        "top1": share([row["best"] == row["target"] for row in rows]),
        "lost_to_same_colors": share([row["best"] == row["same_colors"] for row in rows]),
        "lost_to_same_shape": share([row["best"] == row["same_shape"] for row in rows]),
        "target_above_threshold": share([row["target_score"] >= threshold for row in rows]),
        "absent_above_threshold": share([row["absent_score"] >= threshold for row in rows]),
        "odd_above_threshold": share([s >= threshold for row in rows for s in row["odd"].values()]),
        "encode_ms_median": round(statistics.median(row["encode_ms"] for row in rows), 1),
        "crops_median": statistics.median(row["crops"] for row in rows),
        "query_ms_median": round(statistics.median(row["query_ms"] for row in rows), 1),
    }


def evaluate_scene(arguments, folder: pathlib.Path, seed: int, settings: list[tuple[int, int]], odd):
    """One row for each setting (views, crop size)."""
    torch.set_num_threads(1)
    rng = random.Random(seed)
    torch.manual_seed(seed)
    looks = random_scene(rng, held_out=True)
    scene = folder / str(seed)
    ids = write_scene(scene, looks, rng, arguments.splats)
    phrase, absent = phrase_and_claim(looks[0])[0], absent_phrase(looks, rng)
    asked = [odd[(seed * ODD_PER_SCENE + i) % len(odd)] for i in range(ODD_PER_SCENE)]
    rows = []
    for views, size in settings:
        texts = [phrase, absent, *asked]
        found, report = search(arguments.program, scene, texts, views, size, arguments.models)
        best = lambda text: found[text][0][1] if found[text] else 0.0
        scores = dict(found[phrase])
        rows.append(
            {
                "phrase": phrase,
                "best": found[phrase][0][0] if found[phrase] else None,
                **{"target": ids[0], "same_colors": ids[1], "same_shape": ids[2]},
                "target_score": scores.get(ids[0], 0.0),
                "absent_score": best(absent),
                "odd": {text: best(text) for text in asked},
                **{key: report[key] for key in ("encode_ms", "query_ms", "crops")},
            }
        )
    for path in sorted(scene.iterdir()):
        path.unlink()
    scene.rmdir()
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--models", type=pathlib.Path, default=pathlib.Path("assets/search-model"))
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--few", type=int, default=30, help="scenes of the other settings")
    parser.add_argument("--splats", type=int, default=2048, help="per object")
    parser.add_argument("--rows", type=pathlib.Path, help="write every score here")
    parser.add_argument("--seed", type=int, default=100000)
    parser.add_argument("--jobs", type=int, default=1, help="scenes side by side; times are one's only with 1")
    arguments = parser.parse_args()
    description = json.loads((arguments.models / "model.json").read_text())
    odd = odd_texts(random.Random(9))
    main_setting, others = (4, 256), [(1, 256), (2, 256), (8, 256), (4, 128), (4, 64)]
    rows = {setting: [] for setting in [main_setting, *others]}
    settings_of = lambda index: list(rows) if index < arguments.few else [main_setting]
    indices = range(arguments.scenes)
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ProcessPoolExecutor(arguments.jobs) as jobs:
        evaluate = functools.partial(evaluate_scene, arguments, pathlib.Path(folder), odd=odd)
        scenes = jobs.map(evaluate, (arguments.seed + i for i in indices), map(settings_of, indices))
        for index, found in enumerate(scenes):
            for setting, row in zip(settings_of(index), found):
                rows[setting].append(row)
            if (index + 1) % 10 == 0 or index + 1 == arguments.scenes:
                report = summary(rows, description, arguments.few)
                arguments.out.write_text(json.dumps(report, indent=1) + "\n")
                print(index + 1, json.dumps(report["settings"][0]), flush=True)
                if arguments.rows is not None:
                    named = {f"{views} x {size}": row for (views, size), row in rows.items()}
                    arguments.rows.write_text(json.dumps(named, indent=1) + "\n")


def summary(rows: dict[tuple[int, int], list[dict]], description: dict, few: int) -> dict:
    """The figures; `rows` holds the main setting first, of which the others see the first scenes."""
    threshold = description["search"]["threshold"]
    settings = [
        {"views": views, "crop_size": size, **measure(found, threshold)}
        for (views, size), found in rows.items()
        if found
    ]
    main_rows = next(iter(rows.values()))
    same = {**settings[0], **measure(main_rows[:few], threshold)}
    return {
        "model": description["release"],
        "threshold": threshold,
        "cores": os.cpu_count(),
        "odd_texts": len({text for row in main_rows for text in row["odd"]}),
        "settings": settings,
        "same_scenes": same,
        "misses": [row for row in main_rows if row["best"] != row["target"]],
    }


main()
