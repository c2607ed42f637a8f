"""What tells people something: bus stops, road signs, traffic lights, boards, columns of posters."""

import math
from itertools import pairwise

import numpy as np

from reasoned_explorer.rendering.lettering import (
    Plane,
    disc,
    facing_back,
    facing_front,
    line,
    rectangle,
    write,
)
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import (
    BLACK,
    DARK_STEEL,
    DARK_WOOD,
    IRON,
    PALE_WOOD,
    SIGN_BLUE,
    SIGN_GREEN,
    SIGN_RED,
    SIGN_WHITE,
    SIGN_YELLOW,
    STEEL,
    plain,
)

_BACK = Surface(Material.METAL, (0.52, 0.54, 0.55))


def _bus_stop(builder: MeshBuilder, variant: int) -> None:
    """A pole with a round H of green on yellow, or with a blue board and the word BUS; below it a timetable."""
    post = STEEL
    if builder.detail == FAR:
        builder.cylinder(post, (0, 0, 0), (0, 0, 2.8), 0.04, sides=10, capped=False)
        sign = plain(0.52, 0.66, 0.16) if variant == 0 else SIGN_BLUE
        builder.sheet(sign, facing_front(0.04).points(rectangle(0, 2.58, 0.4, 0.44)))
        builder.sheet(SIGN_WHITE, facing_front(0.04).points(rectangle(0, 1.56, 0.3, 0.44)))
        return
    builder.cylinder(DARK_STEEL, (0, 0, 0), (0, 0, 0.05), 0.1, 0.08, sides=10)
    builder.cylinder(post, (0, 0, 0), (0, 0, 2.78), 0.035, sides=10)
    planes = (facing_front(0.06), facing_back(-0.06))
    if variant == 0:
        count = builder.sides(24)
        builder.cylinder(SIGN_GREEN, (0, -0.045, 2.6), (0, 0.045, 2.6), 0.2, sides=24)
        for plane in planes:
            builder.decal(SIGN_YELLOW, plane.points(disc(0, 2.6, 0.17, sides=count)))
            write(builder, SIGN_GREEN, "H", _raised(plane), centre=(0, 2.6), height_m=0.22)
        builder.box(SIGN_WHITE, (-0.2, -0.045, 2.16), (0.2, 0.045, 2.34))
        for plane in planes:
            write(builder, BLACK, "BUS 12", plane, centre=(0, 2.25), height_m=0.09)
    else:
        builder.box(SIGN_BLUE, (-0.2, -0.045, 2.1), (0.2, 0.045, 2.8), bevel=0.01)
        for plane in planes:
            _bus(builder, plane, (0.0, 2.55))
            write(builder, SIGN_WHITE, "BUS", plane, centre=(0, 2.24), height_m=0.15)
    builder.box(SIGN_WHITE, (-0.17, -0.045, 1.3), (0.17, 0.045, 1.82))
    if builder.detail <= 1:
        _print(builder, facing_front(0.055), (0.0, 1.56), (0.28, 0.44))


def _raised(plane: Plane) -> Plane:
    """Return a plane a centimetre nearer to the reader."""
    return Plane((plane.origin[0], plane.origin[1] + math.copysign(0.01, plane.origin[1]), 0.0), plane.right)


def _bus(builder: MeshBuilder, plane: Plane, centre: tuple[float, float]) -> None:
    """A bus from the side, white on the board, about 0.3 m wide."""
    u, v = centre
    builder.decal(SIGN_WHITE, plane.points(rectangle(u, v, 0.3, 0.2)))
    if builder.detail > 1:
        return
    near = _raised(plane)
    for place in range(3):
        builder.decal(SIGN_BLUE, near.points(rectangle(u - 0.09 + 0.09 * place, v + 0.03, 0.07, 0.07)))
    for wheel in (-0.09, 0.08):
        builder.decal(SIGN_BLUE, near.points(disc(u + wheel, v - 0.09, 0.042, sides=10)))
        builder.decal(SIGN_WHITE, _raised(near).points(disc(u + wheel, v - 0.09, 0.022, sides=8)))


def _print(
    builder: MeshBuilder, plane: Plane, centre: tuple[float, float], size: tuple[float, float], *, rows: int = 6
) -> None:
    """Lines of small print with a coloured heading."""
    (u, v), (width, height) = centre, size
    builder.decal(SIGN_BLUE, plane.points(rectangle(u, v + height * 0.42, width, height * 0.16)))
    for row in range(rows):
        share = (1.0, 0.8, 0.92)[row % 3]
        at = v + height * (0.26 - 0.74 * row / max(rows - 1, 1))
        left = u - width / 2 * (1 - share)
        builder.decal(plain(0.35, 0.36, 0.38), plane.points(rectangle(left, at, width * share, height * 0.05)))


def _traffic_sign(builder: MeshBuilder, variant: int) -> None:
    """A sign of the road: stop, give way, no entry, parking, or a crossing."""
    shape, colour = (
        (disc(0, 2.2, 0.3247, sides=8, turn_rad=math.pi / 8), SIGN_RED),
        (disc(0, 2.3267, 0.3464, sides=3, turn_rad=math.pi), SIGN_RED),
        (disc(0, 2.2, 0.3, sides=builder.sides(24)), SIGN_RED),
        (rectangle(0, 2.2, 0.6, 0.6), SIGN_BLUE),
        (rectangle(0, 2.2, 0.6, 0.6), SIGN_BLUE),
    )[variant]
    if builder.detail == FAR:
        builder.cylinder(STEEL, (0, -0.02, 0), (0, -0.02, 2.2), 0.03, sides=10, capped=False)
        far_shape = disc(0, 2.2, 0.3, sides=6) if variant == 2 else shape
        front = SIGN_RED.shaded(1.15) if variant == 1 else colour
        builder.decal(front, facing_front(0.05).points(far_shape))
        builder.decal(_BACK, facing_back(-0.05).points(far_shape * np.array([-1, 1]))[::-1])
        return
    builder.cylinder(STEEL, (0, -0.02, 0), (0, -0.02, 2.45), 0.03, sides=8)
    builder.extrude(colour, [(-u, z) for u, z in shape], "y", 0.01, 0.035)
    builder.decal(_BACK, facing_back(-0.0).points(shape * np.array([-1, 1]))[::-1])
    face, near = facing_front(0.043), facing_front(0.05)
    if variant == 0:
        rim = disc(0, 2.2, 0.3, sides=8, turn_rad=math.pi / 8)
        builder.decal(SIGN_WHITE, face.points(rim))
        builder.decal(SIGN_RED, near.points(disc(0, 2.2, 0.28, sides=8, turn_rad=math.pi / 8)))
        write(builder, SIGN_WHITE, "STOP", facing_front(0.058), centre=(0, 2.2), height_m=0.165)
    elif variant == 1:
        builder.decal(SIGN_WHITE, face.points(disc(0, 2.3267, 0.21, sides=3, turn_rad=math.pi)))
    elif variant == 2:
        builder.decal(SIGN_WHITE, face.points(rectangle(0, 2.2, 0.44, 0.11)))
    elif variant == 3:
        write(builder, SIGN_WHITE, "P", face, centre=(0, 2.2), height_m=0.45)
    else:
        builder.decal(SIGN_WHITE, face.points([(0, 2.45), (-0.27, 1.96), (0.27, 1.96)]))
        if builder.detail <= 1:
            _walker(builder, near, (0.0, 2.0), 0.34)


def _walker(builder: MeshBuilder, plane: Plane, foot: tuple[float, float], height: float) -> None:
    """A person who walks over stripes, black."""
    (u, v), k = foot, height
    builder.decal(BLACK, plane.points(disc(u, v + 0.93 * k, 0.09 * k, sides=8)))
    strokes = (
        ([(u + 0.02 * k, v + 0.84 * k), (u, v + 0.42 * k)], 0.17),
        ([(u, v + 0.46 * k), (u - 0.16 * k, v + 0.06 * k)], 0.1),
        ([(u, v + 0.46 * k), (u + 0.18 * k, v + 0.06 * k)], 0.1),
        ([(u, v + 0.78 * k), (u - 0.2 * k, v + 0.5 * k)], 0.07),
        ([(u, v + 0.78 * k), (u + 0.2 * k, v + 0.54 * k)], 0.07),
    )
    for points, width in strokes:
        builder.decal(BLACK, plane.points(line(points, width * k)[0]))
    for place in (-2, -1, 1, 2):
        builder.decal(BLACK, plane.points(rectangle(u + 0.17 * k * place, v, 0.1 * k, 0.06 * k)))


#: By level of detail: darker where the hoods and their shade are left out.
_YELLOW_HOUSING = (SIGN_YELLOW, SIGN_YELLOW, plain(0.70, 0.57, 0.08), plain(0.48, 0.40, 0.07))


def _traffic_signals(builder: MeshBuilder, variant: int) -> None:
    """A mast with a black head of three lights, red, amber and green; one of them is lit."""
    lit = variant % 2  # red or green
    housing = (plain(0.07, 0.08, 0.08), plain(0.07, 0.08, 0.08), _YELLOW_HOUSING[builder.detail])[variant]
    if builder.detail == FAR:
        builder.cylinder(DARK_STEEL, (0, -0.06, 0), (0, -0.06, 2.3), 0.05, sides=10, capped=False)
        builder.box(housing, (-0.17, -0.17, 2.2), (0.17, 0.17, 3.2))
        builder.decal(_lamp("red", lit == 0), facing_front(0.18).points(rectangle(0, 3.0, 0.22, 0.22)))
        builder.decal(_lamp("green", lit == 1), facing_front(0.18).points(rectangle(0, 2.4, 0.22, 0.22)))
        return
    builder.cylinder(DARK_STEEL, (0, -0.06, 0), (0, -0.06, 0.06), 0.11, sides=12)
    builder.cylinder(DARK_STEEL, (0, -0.06, 0), (0, -0.06, 3.1), 0.05, sides=10)
    builder.box(housing, (-0.15, -0.02, 2.24), (0.15, 0.1, 3.18), bevel=0.03)
    back_plate = plain(0.05, 0.05, 0.06)
    builder.box(back_plate, (-0.175, 0.0, 2.22), (0.175, 0.02, 3.2))
    plane = facing_front(0.112)
    for height, name, on in ((3.02, "red", lit == 0), (2.71, "amber", False), (2.4, "green", lit == 1)):
        builder.decal(_lamp(name, on), plane.points(disc(0, height, 0.115, sides=builder.sides(14))))
        if builder.detail <= 1:
            _visor(builder, height)
    if builder.detail <= 1:
        builder.box(SIGN_YELLOW, (-0.05, -0.03, 1.0), (0.05, 0.06, 1.16), bevel=0.01)


def _lamp(name: str, on: bool) -> Surface:  # noqa: FBT001 - lit or not
    colour = {"red": (1.0, 0.10, 0.08), "amber": (1.0, 0.68, 0.05), "green": (0.10, 0.95, 0.45)}[name]
    dim = (0.42 * colour[0], 0.42 * colour[1], 0.42 * colour[2])
    return Surface(Material.GLOW, colour) if on else Surface(Material.PLAIN, dim)


def _visor(builder: MeshBuilder, height: float) -> None:
    """The hood over a light: a half tube."""
    steps = 6 if builder.detail == 0 else 4
    angles = np.linspace(-0.15, math.pi + 0.15, steps)
    rim = np.column_stack([0.125 * np.cos(angles), np.zeros(steps), height + 0.125 * np.sin(angles)])
    for start, end in pairwise(rim):
        out = np.array([0.0, 0.175, 0.0])
        base = np.array([0.0, 0.1, 0.0])
        builder.sheet(BLACK, [start + base, end + base, end + out, start + out])


def _information(builder: MeshBuilder, variant: int) -> None:
    """A board on two posts with a map, and above it a white i on blue (or a little roof of wood)."""
    post, frame = ((DARK_STEEL, IRON), (DARK_WOOD, PALE_WOOD))[variant]
    if builder.detail == FAR:
        for x in (-0.52, 0.52):
            builder.card(post, (x, 0, 0), 0.08, 1.0)
        builder.sheet(SIGN_WHITE, facing_front(0.0).points(rectangle(0, 1.25, 0.9, 0.84)))
        builder.box(SIGN_BLUE if variant == 0 else DARK_WOOD, (-0.6, -0.1, 1.72), (0.6, 0.1, 2.0))
        return
    for x in (-0.54, 0.54):
        builder.box(post, (x - 0.045, -0.045, 0), (x + 0.045, 0.045, 1.95), bevel=0.01)
    builder.box(frame, (-0.5, -0.035, 0.72), (0.5, 0.035, 1.66), bevel=0.01)
    if variant == 0:
        builder.box(SIGN_BLUE, (-0.6, -0.06, 1.68), (0.6, 0.06, 2.0), bevel=0.01)
        builder.box(DARK_STEEL, (-0.6, -0.1, 0), (0.6, 0.1, 0.03))
    else:
        builder.extrude(DARK_WOOD, [(-0.1, 1.84), (0.1, 1.84), (0.0, 2.0)], "x", -0.6, 0.6)
        builder.box(SIGN_BLUE, (-0.13, -0.04, 1.63), (0.13, 0.04, 1.86))
    for y, plane in ((0.045, facing_front(0.045)), (-0.045, facing_back(-0.045))):
        _map(builder, plane)
        top = Plane((0.0, y * (1.55 if variant == 0 else 1.2), 0.0), plane.right)
        _letter_i(builder, top, (0.0, 1.84 if variant == 0 else 1.745), 0.26 if variant == 0 else 0.19)
        if variant == 0:
            write(builder, SIGN_WHITE, "INFO", top, centre=(0.36, 1.84), height_m=0.13)


def _letter_i(builder: MeshBuilder, plane: Plane, centre: tuple[float, float], height: float) -> None:
    """A small i with its dot and feet, the mark of information."""
    (u, v), k = centre, height
    builder.decal(SIGN_WHITE, plane.points(rectangle(u, v - 0.12 * k, 0.2 * k, 0.6 * k)))
    if builder.detail <= 1:
        builder.decal(SIGN_WHITE, plane.points(disc(u, v + 0.37 * k, 0.13 * k, sides=8)))
        builder.decal(SIGN_WHITE, plane.points(rectangle(u, v - 0.42 * k, 0.44 * k, 0.1 * k)))
        builder.decal(SIGN_WHITE, plane.points(rectangle(u - 0.12 * k, v + 0.13 * k, 0.24 * k, 0.1 * k)))


def _map(builder: MeshBuilder, plane: Plane) -> None:
    """A plan of a town: paper, a park, a river, streets, a red dot."""
    builder.decal(SIGN_WHITE, plane.points(rectangle(0, 1.19, 0.9, 0.84)))
    if builder.detail > 1:
        return
    near = _raised(plane)
    builder.decal(plain(0.55, 0.75, 0.45), near.points(rectangle(-0.22, 1.35, 0.3, 0.3)))
    river = [(-0.44, 0.85), (-0.1, 0.98), (0.12, 0.92), (0.44, 1.06)]
    for bar in line(river, 0.08):
        builder.decal(plain(0.45, 0.65, 0.88), near.points(bar))
    nearer = _raised(near)
    for street in ([(-0.02, 0.8), (0.06, 1.58)], [(-0.42, 1.15), (0.42, 1.22)], [(0.06, 1.4), (0.42, 1.5)]):
        builder.decal(plain(0.93, 0.72, 0.30), nearer.points(line(street, 0.03)[0]))
    builder.decal(SIGN_RED, _raised(nearer).points(disc(0.15, 1.2, 0.04, sides=8)))


_POSTERS = (
    (0.85, 0.20, 0.18),
    (0.98, 0.82, 0.25),
    (0.16, 0.38, 0.66),
    (0.95, 0.94, 0.90),
    (0.20, 0.55, 0.40),
    (0.90, 0.50, 0.15),
)


def _advertising(builder: MeshBuilder, variant: int) -> None:
    """A round column covered with posters under a domed roof."""
    body = plain(0.82, 0.80, 0.74)
    roof = plain(0.15, 0.30, 0.24)
    if builder.detail == FAR:
        builder.cylinder(plain(0.66, 0.52, 0.38), (0, 0, 0), (0, 0, 2.9), 0.62, sides=17, capped=False)
        builder.cylinder(roof, (0, 0, 2.9), (0, 0, 3.5), 0.7, 0.0, sides=17, capped=False)
        return
    sides = 20
    builder.lathe(roof, [(0.7, 0.0), (0.7, 0.25), (0.64, 0.35), (0.64, 0.4)], sides=sides)
    builder.lathe(body, [(0.62, 0.38), (0.62, 2.95)], sides=sides)
    builder.lathe(roof, [(0.64, 2.9), (0.7, 2.96), (0.7, 3.05), (0.55, 3.22), (0.3, 3.35), (0.0, 3.4)], sides=sides)
    builder.cylinder(roof, (0, 0, 3.36), (0, 0, 3.5), 0.05, 0.02, sides=6)
    count = builder.sides(sides)
    # Posters lie on whole faces of the column, two rows of them.
    wide = {0: 3, 1: 2, 2: 1}[builder.detail]
    for place, start in enumerate(range(0, count - wide + 1, wide)):
        for row, (low, high) in enumerate(((0.5, 1.65), (1.72, 2.85))):
            surface = plain(*_POSTERS[(place * 2 + row * 3 + variant) % len(_POSTERS)])
            for face in range(start, start + wide):
                a, b = ((face + k + 0.5) * 2 * math.pi / count for k in (0, 1))
                corners = [(0.632 * math.cos(t), 0.632 * math.sin(t)) for t in (a, b)]
                (x0, y0), (x1, y1) = corners
                builder.decal(surface, [(x0, y0, low), (x1, y1, low), (x1, y1, high), (x0, y0, high)])
            if builder.detail <= 1:
                _poster(builder, (start + wide / 2 + 0.5) * 2 * math.pi / count, low, place + row)


def _poster(builder: MeshBuilder, angle: float, low: float, kind: int) -> None:
    """What is printed in the middle of a poster: a disc or bars."""
    out = (math.cos(angle), math.sin(angle))
    plane = Plane((0.645 * out[0], 0.645 * out[1], low), (-out[1], out[0], 0.0))
    if kind % 2:
        builder.decal(SIGN_WHITE, plane.points(disc(0, 0.62, 0.14, sides=8)))
    else:
        builder.decal(BLACK, plane.points(rectangle(0, 0.75, 0.2, 0.24)))
    builder.decal(BLACK if kind % 2 else SIGN_WHITE, plane.points(rectangle(0, 0.25, 0.24, 0.1)))


MAKERS = {
    "bus_stop": Maker(_bus_stop, variants=2),
    "traffic_sign": Maker(_traffic_sign, variants=5),
    "traffic_signals": Maker(_traffic_signals, variants=3),
    "information": Maker(_information, variants=2),
    "advertising": Maker(_advertising, variants=3),
}
