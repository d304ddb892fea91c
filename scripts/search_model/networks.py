"""The two towers of the bundled model."""

import torch
from torch import nn

DIMENSION = 128
SIZE = 96
VOCABULARY = 49408
PADDING_ROW, UNKNOWN_ROW = 0, 1


class Block(nn.Module):
    """Two convolutions and a way around them."""

    def __init__(self, channels: int, inner: int):
        super().__init__()
        self.body = nn.Sequential(
            nn.Conv2d(channels, inner, 3, padding=1, bias=False),
            nn.BatchNorm2d(inner),
            nn.ReLU(),
            nn.Conv2d(inner, channels, 3, padding=1, bias=False),
            nn.BatchNorm2d(channels),
        )

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return torch.relu(x + self.body(x))


def _down(inputs: int, outputs: int) -> nn.Sequential:
    convolution = nn.Conv2d(inputs, outputs, 3, stride=2, padding=1, bias=False)
    return nn.Sequential(convolution, nn.BatchNorm2d(outputs), nn.ReLU())


class ImageTower(nn.Module):
    """f32 [n, 3, 96, 96] → [n, 128]."""

    def __init__(self):
        super().__init__()
        self.body = nn.Sequential(
            *[_down(3, 32), Block(32, 32)],
            *[_down(32, 64), Block(64, 64)],
            *[_down(64, 96), Block(96, 96), Block(96, 96)],
            *[_down(96, 160), Block(160, 96), Block(160, 96)],
        )
        self.head = nn.Sequential(nn.Linear(320, 256), nn.ReLU(), nn.Linear(256, DIMENSION))

    def forward(self, image: torch.Tensor) -> torch.Tensor:
        x = self.body(image).flatten(2)
        return self.head(torch.cat([x.mean(-1), x.amax(-1)], dim=-1))


class TextLayer(nn.Module):
    def __init__(self, width: int, heads: int):
        super().__init__()
        self.heads = heads
        self.before = nn.LayerNorm(width)
        self.query_key_value = nn.Linear(width, 3 * width)
        self.out = nn.Linear(width, width)
        self.mlp = nn.Sequential(
            nn.LayerNorm(width), nn.Linear(width, 3 * width), nn.GELU(), nn.Linear(3 * width, width)
        )

    def forward(self, x: torch.Tensor, hidden: torch.Tensor) -> torch.Tensor:
        n, length, width = x.shape
        parts = self.query_key_value(self.before(x)).reshape(n, length, 3, self.heads, -1)
        query, key, value = parts.permute(2, 0, 3, 1, 4).unbind(0)
        scores = query @ key.transpose(-1, -2) * (width / self.heads) ** -0.5 + hidden
        mixed = (scores.softmax(-1) @ value).transpose(1, 2).reshape(n, length, width)
        x = x + self.out(mixed)
        return x + self.mlp(x)


class TextTower(nn.Module):
    """i64 [n, 77] → [n, 128]. Tokens that no training text has share one row of the embedding."""

    POSITIONS = 32  # later ones share the last

    def __init__(self, known: list[int], width: int = 128, layers: int = 2, heads: int = 4):
        super().__init__()
        known = sorted({*known, 49406, 49407})
        if len(known) > 254:
            raise ValueError(f"vocabulary: expected at most 254 tokens, found {len(known)}")
        rows = torch.full((VOCABULARY,), UNKNOWN_ROW, dtype=torch.uint8)
        rows[0] = PADDING_ROW  # "!" is token 0: it is passed over, as padding is
        for row, token in enumerate(known):
            if token:
                rows[token] = row + 2
        self.register_buffer("rows", rows)
        self.embedding = nn.Embedding(len(known) + 2, width)
        nn.init.normal_(self.embedding.weight, std=0.5)
        self.position = nn.Parameter(torch.randn(self.POSITIONS, width) * 0.1)
        self.layers = nn.ModuleList(TextLayer(width, heads) for _ in range(layers))
        self.after = nn.LayerNorm(width)
        self.projection = nn.Linear(width, DIMENSION, bias=False)

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        rows = self.rows[tokens].long()
        places = torch.arange(tokens.shape[1], device=tokens.device).clamp_max(self.POSITIONS - 1)
        x = self.embedding(rows) + self.position[places]
        hidden = torch.where(rows == PADDING_ROW, -1e4, 0.0)[:, None, None]
        for layer in self.layers:
            x = layer(x, hidden)
        end = tokens.argmax(-1)[:, None, None].expand(-1, 1, x.shape[-1])
        return self.projection(self.after(x.gather(1, end)[:, 0]))


class Calibrated(nn.Module):
    """Scale of the cosines, and scores relative to the background texts."""

    def __init__(self):
        super().__init__()
        self.log_scale = nn.Parameter(torch.tensor(3.0))

    def scale(self) -> torch.Tensor:
        return self.log_scale.exp().clamp_max(60.0)

    def forward(self, image: torch.Tensor, text: torch.Tensor, background: torch.Tensor) -> torch.Tensor:
        """Logit of the search's score: the text's share in the softmax over itself and the
        background. All features are of unit length; [n, m]."""
        scale = self.scale()
        rest = (scale * image @ background.T).logsumexp(-1, keepdim=True)
        return scale * image @ text.T - rest
