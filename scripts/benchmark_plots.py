"""The plots among the benchmarks: two panels beside each other, as an SVG."""

import math


class Panel:
    """One of the two panels of a plot: `xs` and `ys` are the least and the greatest value on its axes."""

    WIDTH, HEIGHT, MARGIN = 400, 260, 44

    def __init__(self, left, xs, ys):
        self.left, self.xs, self.ys = left, xs, ys
        right, bottom = left + self.WIDTH - self.MARGIN, self.HEIGHT - self.MARGIN
        axes = f"M{left + self.MARGIN},{self.MARGIN}V{bottom}H{right}"
        self.parts = [f'<path d="{axes}" fill="none" stroke="black"/>']

    def place(self, x):
        first, last = self.xs
        return self.left + self.MARGIN + (self.WIDTH - 2 * self.MARGIN) * (x - first) / (last - first)

    def level(self, y):
        low, high = self.ys
        return self.HEIGHT - self.MARGIN - (self.HEIGHT - 2 * self.MARGIN) * (y - low) / (high - low)

    def text(self, x, y, anchor, text):
        self.parts.append(f'<text x="{x}" y="{y}" text-anchor="{anchor}">{text}</text>')

    def tick_below(self, x, label):
        self.text(f"{self.place(x):.0f}", self.HEIGHT - self.MARGIN + 16, "middle", label)

    def tick_beside(self, y, label):
        self.text(self.left + self.MARGIN - 5, f"{self.level(y) + 4:.0f}", "end", label)

    def name(self, name):
        self.text(self.left + self.WIDTH / 2, self.HEIGHT - 8, "middle", name)

    def circle(self, x, y, radius, color):
        place, level = f"{self.place(x):.1f}", f"{self.level(y):.1f}"
        self.parts.append(f'<circle cx="{place}" cy="{level}" r="{radius}" fill="{color}"/>')

    def line(self, points, color):
        path = "L".join(f"{self.place(x):.1f},{self.level(y):.1f}" for x, y in points)
        self.parts.append(f'<path d="M{path}" fill="none" stroke="{color}"/>')


def plot(title, panels):
    """The panels beside each other, under a title."""
    width, height = 2 * Panel.WIDTH, Panel.HEIGHT
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="11">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    for panel in panels:
        parts += panel.parts
    parts.append(f'<text x="{Panel.WIDTH}" y="20" text-anchor="middle" font-size="13">{title}</text></svg>')
    return "\n".join(parts) + "\n"


def scaling_plot(points):
    """Milliseconds over splats (left) and over pixels (right), all axes logarithmic, as an SVG."""
    sizes = [tuple(point["size"]) for point in points]
    usual_size = max(set(sizes), key=sizes.count)
    counts = [point["splats"] for point in points]
    usual_count = max(set(counts), key=counts.count)
    levels = [math.log10(point["median_ms"]) for point in points]
    low, high = math.floor(min(levels)), math.ceil(max(levels))
    pixels = lambda point: point["size"][0] * point["size"][1]
    axes = [
        (f"splats, {usual_size[0]} × {usual_size[1]}", lambda p: p["splats"],
         [p for p in points if tuple(p["size"]) == usual_size], [10_000, 100_000, 1_000_000]),
        (f"pixels, {usual_count} splats", pixels,
         [p for p in points if p["splats"] == usual_count], [250_000, 1_000_000, 4_000_000]),
    ]
    panels = []
    for left, (name, value, shown, ticks) in zip((0, Panel.WIDTH), axes):
        corners = [(math.log10(value(p)), math.log10(p["median_ms"])) for p in sorted(shown, key=value)]
        panel = Panel(left, (corners[0][0], corners[-1][0]), (low, high))
        for tick in ticks:
            label = f"{tick / 1e6:g} M" if tick >= 1e6 else f"{tick / 1e3:g} k"
            panel.tick_below(math.log10(tick), label)
        for tick in range(low, high + 1):
            panel.tick_beside(tick, f"{10.0**tick:g}")
        panel.name(name)
        panel.line(corners, "#1f77b4")
        for x, y in corners:
            panel.circle(x, y, 3.5, "#1f77b4")
        panels.append(panel)
    return plot("forward and backward pass, ms", panels)


def budget_plot(dataset, points):
    """PSNR over splats (left, logarithmic) and over seconds (right) as an SVG."""
    levels = [point["test_psnr"] for point in points]
    low, high = min(levels), max(levels)
    low, high = low - 0.05 * (high - low), high + 0.05 * (high - low)
    axes = [("splats", lambda p: math.log10(p["splats"]), lambda x: f"{10**x / 1000:.0f} k"),
            ("seconds", lambda p: p["seconds"], lambda x: f"{x:.0f} s")]
    panels = []
    for left, (name, value, label) in zip((0, Panel.WIDTH), axes):
        shown = [point for point in points if name in point]
        values = [value(point) for point in shown]
        first, last = min(values), max(values)
        panel = Panel(left, (first, last), (low, high))
        for tick in range(5):
            x, y = first + (last - first) * tick / 4, low + (high - low) * tick / 4
            panel.tick_below(x, label(x))
            panel.tick_beside(y, f"{y:.2f}")
        panel.name(name)
        for point in shown:
            color = "#1f77b4" if "budget" in point else "#d62728"
            panel.circle(value(point), point["test_psnr"], 4, color)
        panels.append(panel)
    return plot(f"{dataset}: test PSNR, dB; fixed budgets blue, auto red", panels)
