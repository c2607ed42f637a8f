"""What textures are woven of: noise, cells, courses of bricks, rectangles. All of it tiles.

A pattern is sampled at the centres of texels. ``u`` runs to the right and ``v`` upwards, both in [0, 1) over one
repetition; row 0 of an array is its top.
"""

import numpy as np
from numpy.random import PCG64, Generator
from numpy.typing import NDArray

from reasoned_explorer.model.draws import key_of

#: Edge of a texture, texels.
SIZE = 128
Field = NDArray[np.float64]

_SEED = 20


def generator_of(*keys: int | str) -> Generator:
    """Return a generator of draws for one texture; the same keys give the same draws."""
    return Generator(PCG64(key_of(_SEED, "texture", *keys)))


def grid() -> tuple[Field, Field]:
    """Return u and v of every texel, each of shape (SIZE, SIZE)."""
    centres = (np.arange(SIZE) + 0.5) / SIZE
    u, v = np.meshgrid(centres, centres[::-1])
    return u, v


def grain(rng: Generator) -> Field:
    """Return noise of single texels in [0, 1], shape (SIZE, SIZE)."""
    return rng.random((SIZE, SIZE))


def clouds(rng: Generator, *cells: int, across: int = 1, fall: float = 0.6) -> Field:
    """Return smooth noise in [0, 1], shape (SIZE, SIZE).

    Args:
        rng: Draws.
        cells: Of each octave, how many cells one repetition has up and down; the first is the strongest.
        across: The same sideways, as a multiple: above 1 for upright streaks.
        fall: How much weaker each octave is than the one before.
    """
    u, v = grid()
    total = np.zeros((SIZE, SIZE))
    for octave, count in enumerate(cells):
        total += fall**octave * _value_noise(rng, u, v, (count * across, count))
    low, high = total.min(), total.max()
    noise: Field = (total - low) / (high - low)
    return noise


def _value_noise(rng: Generator, u: Field, v: Field, cells: tuple[int, int]) -> Field:
    columns, rows = cells
    values = rng.random((rows, columns))
    x, y = u * columns - 0.5, v * rows - 0.5
    column, row = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    along, up = _eased(x - column), _eased(y - row)
    left, right = column % columns, (column + 1) % columns
    below, above = row % rows, (row + 1) % rows
    low = values[below, left] * (1.0 - along) + values[below, right] * along
    high = values[above, left] * (1.0 - along) + values[above, right] * along
    noise: Field = low * (1.0 - up) + high * up
    return noise


def _eased(share: Field) -> Field:
    eased: Field = share * share * (3.0 - 2.0 * share)
    return eased


def stones(rng: Generator, cells: int, *, jitter: float = 0.7) -> tuple[Field, Field]:
    """Return cells about jittered seeds: of each texel how far it is inside its cell, and a number of that cell's own.

    Args:
        rng: Draws.
        cells: How many along either axis.
        jitter: How far seeds stray, in cells.

    Returns:
        Distance to the cell's border, in cells, 0 on the border; and a number in [0, 1) for each cell.
    """
    u, v = grid()
    shift = 0.5 + jitter * (rng.random((cells, cells, 2)) - 0.5)
    shade = rng.random((cells, cells))
    x, y = u * cells, v * cells
    column, row = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    first, second = np.full(u.shape, 9.0), np.full(u.shape, 9.0)
    own = np.zeros(u.shape)
    for down in (-1, 0, 1):
        for aside in (-1, 0, 1):
            seed = shift[(row + down) % cells, (column + aside) % cells]
            gap = np.hypot(column + aside + seed[..., 0] - x, row + down + seed[..., 1] - y)
            nearer = gap < first
            second = np.where(nearer, first, np.minimum(second, gap))
            own = np.where(nearer, shade[(row + down) % cells, (column + aside) % cells], own)
            first = np.where(nearer, gap, first)
    return (second - first) / 2.0, own


def courses(rng: Generator, columns: int, rows: int, *, shift: float = 0.5) -> tuple[Field, Field, Field]:
    """Return courses of bricks or slabs, every other one moved sideways.

    Args:
        rng: Draws.
        columns: Bricks along one repetition.
        rows: Courses in one repetition, even where they are shifted.
        shift: How far every other course is moved, in bricks.

    Returns:
        Place in the brick along u, place in it along v, both in [0, 1); and a number in [0, 1) for each brick.
    """
    u, v = grid()
    y = v * rows
    row = np.floor(y).astype(np.int64) % rows
    x = u * columns + shift * (row % 2)
    column = np.floor(x).astype(np.int64) % columns
    return x - np.floor(x), y - np.floor(y), rng.random((rows, columns))[row, column]


def joint(place_u: Field, place_v: Field, *, width_u: float, width_v: float) -> Field:
    """Return where bricks end, in [0, 1]: 1 in the joint; widths in bricks."""
    side = np.minimum(place_u, 1.0 - place_u) / width_u
    end = np.minimum(place_v, 1.0 - place_v) / width_v
    mask: Field = np.clip(2.0 - 2.0 * np.minimum(side, end), 0.0, 1.0)
    return mask


def leaves(rng: Generator, count: int, length: float) -> tuple[Field, Field]:
    """Return leaves that lie over each other, the later ones on top and lighter.

    Args:
        rng: Draws.
        count: Of leaves.
        length: Of a leaf, as a share of the texture.

    Returns:
        How light each texel is, in [0, 1], 0 in gaps; and a number in [0, 1) for each leaf.
    """
    u, v = grid()
    light, own = np.zeros((SIZE, SIZE)), np.zeros((SIZE, SIZE))
    for place in range(count):
        x, y, angle, shade, size = rng.random(5)
        half = 0.5 * length * (0.75 + 0.5 * size)
        # Only the texels near the leaf are looked at, over the texture's edges too.
        reach = min(int(np.ceil(half * SIZE)) + 1, SIZE // 2 - 1)
        near = np.arange(-reach, reach + 1)
        window = np.ix_((int((1.0 - y) * SIZE) + near) % SIZE, (int(x * SIZE) + near) % SIZE)
        across, up = (u[window] - x + 0.5) % 1.0 - 0.5, (v[window] - y + 0.5) % 1.0 - 0.5
        turn = 2.0 * np.pi * angle
        along, aside = across * np.cos(turn) + up * np.sin(turn), up * np.cos(turn) - across * np.sin(turn)
        share = along / half
        # Two arcs that meet in points.
        inside = np.abs(aside) < 0.42 * half * (1.0 - share * share)
        # A fold along the middle: one side catches more light than the other.
        lit = (0.45 + 0.45 * place / count + 0.2 * (shade - 0.5)) * np.where(aside > 0.0, 1.0, 0.84)
        light[window] = np.where(inside, np.clip(lit, 0.0, 1.0), light[window])
        own[window] = np.where(inside, shade, own[window])
    return light, own


def mixed(one: tuple[float, float, float], other: tuple[float, float, float], share: Field) -> Field:
    """Return colours between two, shape (SIZE, SIZE, 3): the first where the share is 0."""
    picture: Field = np.asarray(one) * (1.0 - share[..., None]) + np.asarray(other) * share[..., None]
    return picture


def grey(value: Field) -> Field:
    """Return a grey picture, shape (SIZE, SIZE, 3)."""
    return np.repeat(value[..., None], 3, axis=2)


class Sheet:
    """A picture to paint rectangles on, in metres from its lower left corner.

    Args:
        picture: Shape (SIZE, SIZE, 3); painted in place.
        metres: What it covers along either axis.
    """

    def __init__(self, picture: Field, metres: float) -> None:
        self.picture = picture
        self._texels = SIZE / metres

    def fill(
        self,
        left: float,
        low: float,
        right: float,
        high: float,
        colour: tuple[float, float, float],
        *,
        top: tuple[float, float, float] | None = None,
        cover: float = 1.0,
    ) -> None:
        """Paint a rectangle, metres, borders to the nearest texel; with ``top`` it changes colour upwards."""
        columns = slice(max(0, round(left * self._texels)), min(SIZE, round(right * self._texels)))
        rows = slice(max(0, SIZE - round(high * self._texels)), min(SIZE, SIZE - round(low * self._texels)))
        part = self.picture[rows, columns]
        share = np.linspace(1.0, 0.0, max(len(part), 1))[: len(part), None, None]
        shade = np.asarray(colour) * (1.0 - share) + np.asarray(colour if top is None else top) * share
        part[:] = part * (1.0 - cover) + shade * cover
