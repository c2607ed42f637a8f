"""Fronts of what one enters from the street: cafe, restaurant, bar, shop, toilets, pharmacy, cash machine."""

from reasoned_explorer.rendering.lettering import Plane, cross, facing_front, rectangle, write
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import (
    BLACK,
    DARK_STEEL,
    DARK_WOOD,
    LIGHT,
    OAK,
    PALE_WOOD,
    SIGN_BLUE,
    SIGN_GREEN,
    SIGN_RED,
    SIGN_WHITE,
    SIGN_YELLOW,
    STEEL,
    plain,
)
from reasoned_explorer.rendering.models.shopfronts import (
    Front,
    add_blade,
    add_display,
    add_door,
    add_far_front,
    add_front,
    draw_cup,
    draw_cutlery,
    draw_mug,
    draw_person,
)

_CREAM = Surface(Material.PLASTER, (0.92, 0.87, 0.76))
_BROWN = plain(0.30, 0.18, 0.11)
_WINE = plain(0.45, 0.08, 0.12)
_GOLD = plain(0.95, 0.80, 0.40)
_NEON = Surface(Material.GLOW, (1.0, 0.45, 0.20))
_GREEN_CROSS = Surface(Material.GLOW, (0.10, 0.85, 0.35))
_CLOTH_GREEN = plain(0.13, 0.38, 0.25)


def _cafe(builder: MeshBuilder, variant: int) -> None:
    """CAFE, a striped awning, a cup on a sign that stands out, and a board with the menu."""
    cloth = (plain(0.70, 0.30, 0.15), _CLOTH_GREEN)[variant]
    front = Front(6.0, 3.0, _CREAM, DARK_WOOD, _BROWN, SIGN_WHITE, "CAFE", 0.48, (cloth, SIGN_WHITE))
    add_front(builder, front)
    if builder.detail == FAR:
        return
    board = facing_front(0.172)
    for u in (-1.7, 1.7):
        draw_cup(builder, board, (u, 2.68), 0.5, SIGN_WHITE)
    for plane in add_blade(builder, _BROWN, x=2.7, z=1.75):
        draw_cup(builder, plane, (0, 0), 0.34, SIGN_WHITE)
    _menu_board(builder, -0.95)
    _potted(builder, 2.75)


def _menu_board(builder: MeshBuilder, x: float) -> None:
    """A folding blackboard before the wall."""
    builder.extrude(OAK, [(0.44, 0.0), (0.48, 0.0), (0.30, 0.95), (0.26, 0.95)], "x", x - 0.28, x + 0.28)
    if builder.detail <= 1:
        lean = Plane((x, 0.494, 0.0), (-1.0, 0.0, 0.0), (0.0, -0.186, 0.9825))
        builder.decal(BLACK, lean.points(rectangle(0, 0.5, 0.46, 0.78)))
        near = Plane((x, 0.504, 0.0), lean.right, lean.up)
        for row in range(5):
            builder.decal(
                SIGN_WHITE, near.points(rectangle(0, 0.76 - 0.13 * row, (0.3, 0.36, 0.28, 0.34, 0.2)[row], 0.03))
            )


def _potted(builder: MeshBuilder, x: float) -> None:
    """A small evergreen in a pot beside the door."""
    builder.cylinder(plain(0.55, 0.30, 0.20), (x, 0.28, 0), (x, 0.28, 0.35), 0.13, 0.17, sides=10)
    builder.cylinder(plain(0.16, 0.34, 0.14), (x, 0.28, 0.33), (x, 0.28, 1.15), 0.19, 0.0, sides=8)


def _restaurant(builder: MeshBuilder, variant: int) -> None:
    """RESTAURANT, an awning of one colour, fork and knife, the menu in a lit frame."""
    tone, ink = ((_WINE, _GOLD), (plain(0.10, 0.22, 0.30), SIGN_WHITE))[variant]
    front = Front(8.0, 3.0, _CREAM, DARK_WOOD, tone, ink, "RESTAURANT", 0.48, (tone, tone.shaded(1.25)))
    add_front(builder, front)
    if builder.detail == FAR:
        return
    for u in (-2.9, 2.9):
        draw_cutlery(builder, facing_front(0.172), (u, 2.68), 0.5, ink)
    for plane in add_blade(builder, tone, x=-3.8, z=1.75):
        draw_cutlery(builder, plane, (0, 0), 0.36, ink)
    _menu_frame(builder, 0.76)
    for x in (-0.95, 3.8):
        _potted(builder, x)


def _menu_frame(builder: MeshBuilder, x: float) -> None:
    builder.box(DARK_STEEL, (x - 0.05, 0.05, 1.1), (x + 0.33, 0.14, 1.65))
    builder.decal(LIGHT, facing_front(0.152, x=x + 0.14).points(rectangle(0, 1.375, 0.3, 0.46)))


def _bar(builder: MeshBuilder, variant: int) -> None:
    """BAR in letters of light on dark wood, mugs of beer, lanterns, barrels."""
    wall = (plain(0.15, 0.12, 0.11), plain(0.10, 0.22, 0.16))[variant]
    front = Front(6.0, 3.0, wall, DARK_WOOD, plain(0.07, 0.06, 0.06), _NEON, ("BAR", "PUB")[variant], 0.5)
    add_front(builder, front)
    if builder.detail == FAR:
        return
    amber = Surface(Material.GLOW, (1.0, 0.72, 0.15))
    for u in (-1.45, 1.45):
        draw_mug(builder, facing_front(0.172), (u, 2.66), 0.52, amber)
    for plane in add_blade(builder, BLACK, x=2.75, z=2.1):
        draw_mug(builder, plane, (0, 0), 0.36, amber)
    for x in (-0.74, 0.74):
        builder.box(LIGHT, (x - 0.06, 0.08, 1.85), (x + 0.06, 0.2, 2.1))
    profile = [(0.17, 0.0), (0.21, 0.2), (0.22, 0.4), (0.21, 0.6), (0.17, 0.8)]
    for x in (-2.5, 2.5):
        builder.lathe(OAK, profile, (x, 0.26, 0), sides=12)
        if builder.detail == 0:
            for z in (0.15, 0.62):
                builder.lathe(DARK_STEEL, [(0.215, z), (0.22, z + 0.05)], (x, 0.26, 0), sides=12)


_SHOPS = (
    ("SHOP", plain(0.75, 0.12, 0.14), SIGN_WHITE),
    ("MARKET", plain(0.12, 0.45, 0.22), SIGN_WHITE),
    ("BAKERY", plain(0.86, 0.62, 0.25), _BROWN),
    ("FASHION", plain(0.12, 0.12, 0.14), SIGN_WHITE),
    ("BOOKS", plain(0.10, 0.24, 0.46), _GOLD),
    ("STORE", plain(0.92, 0.55, 0.10), SIGN_WHITE),
)
_GOODS = [
    plain(0.86, 0.20, 0.18), plain(0.95, 0.75, 0.20), plain(0.20, 0.45, 0.75), plain(0.85, 0.85, 0.80),
    plain(0.25, 0.60, 0.35), plain(0.70, 0.35, 0.60),
]  # fmt: skip


def _shop(builder: MeshBuilder, variant: int) -> None:
    """A wide window full of goods under a sign that says what is sold."""
    word, sign, ink = _SHOPS[variant]
    cloth = (sign, SIGN_WHITE) if variant in (0, 1, 2) else None
    wall = Surface(Material.PLASTER, (0.85, 0.84, 0.80))
    add_front(builder, Front(6.0, 3.0, wall, DARK_STEEL, sign, ink, word, 0.48, cloth))
    if builder.detail == FAR:
        return
    add_display(builder, _GOODS, 3.0)
    if variant == 1:
        for place, surface in enumerate((_GOODS[0], _GOODS[4], _GOODS[1])):
            x = 1.0 + 0.62 * place
            builder.box(PALE_WOOD, (x - 0.28, 0.12, 0.0), (x + 0.28, 0.48, 0.45))
            builder.box(surface, (x - 0.24, 0.16, 0.4), (x + 0.24, 0.46, 0.52), bevel=0.05)
    if cloth is None:
        for plane in add_blade(builder, sign, x=-2.8, z=2.1):
            write(builder, ink, word[0], plane, centre=(0, 0), height_m=0.28)


_PALE_DOOR = plain(0.55, 0.62, 0.66)


def _toilets(builder: MeshBuilder, variant: int) -> None:
    """WC on blue, one door for women and one for men, with their figures."""
    del variant
    wall = Surface(Material.PLASTER, (0.80, 0.82, 0.82))
    front = Front(3.0, 2.6, wall, STEEL, SIGN_BLUE, SIGN_WHITE, "WC", 0.36, pane=_PALE_DOOR)
    if builder.detail == FAR:
        add_far_front(builder, front)
        return
    builder.box(wall, (-1.5, 0, 0), (1.5, 0.07, 2.6))
    builder.box(SIGN_BLUE, (-1.46, 0.04, 2.06), (1.46, 0.16, 2.58))
    write(builder, SIGN_WHITE, "WC", facing_front(0.172), centre=(0, 2.32), height_m=0.42)
    for u in (-1.05, 1.05):
        draw_person(builder, facing_front(0.172), (u, 2.1), 0.44, SIGN_WHITE, skirt=u > 0)
    for x in (-0.72, 0.72):
        add_door(builder, DARK_STEEL, width=0.95, height=2.0, leaf=_PALE_DOOR, x=x)
        plane = facing_front(0.144, x=x)
        builder.decal(SIGN_BLUE, plane.points(rectangle(0, 1.4, 0.5, 0.66)))
        draw_person(builder, facing_front(0.156, x=x), (0, 1.12), 0.56, SIGN_WHITE, skirt=x < 0)
    for plane in add_blade(builder, SIGN_BLUE, x=0.0, z=1.7, size=0.36):
        write(builder, SIGN_WHITE, "WC", plane, centre=(0, 0), height_m=0.2)


def _pharmacy(builder: MeshBuilder, variant: int) -> None:
    """PHARMACY in white on green, with crosses of green light."""
    del variant
    wall = Surface(Material.PLASTER, (0.93, 0.95, 0.93))
    front = Front(6.0, 3.0, wall, SIGN_GREEN, SIGN_GREEN, SIGN_WHITE, "PHARMACY", 0.46)
    add_front(builder, front)
    if builder.detail == FAR:
        return
    for u in (-2.4, 2.4):
        builder.decal(SIGN_WHITE, facing_front(0.172).points(rectangle(u, 2.68, 0.54, 0.54)))
        builder.decal(SIGN_GREEN, facing_front(0.184).points(cross(u, 2.68, 0.46)))
    outline = [(0.29 + y, 2.02 + z) for y, z in cross(0, 0, 0.42, arm=0.36).tolist()]
    for x in (-2.85, 2.85):
        builder.extrude(_GREEN_CROSS, outline, "x", x - 0.05, x + 0.05)
        builder.box(DARK_STEEL, (x - 0.02, 0.05, 2.0), (x + 0.02, 0.12, 2.04))
    add_display(builder, [SIGN_WHITE, plain(0.30, 0.70, 0.45), plain(0.85, 0.93, 0.88), plain(0.55, 0.75, 0.90)], 3.0)
    if builder.detail <= 1:
        for x in (-1.8, 1.8):
            builder.decal(SIGN_GREEN, facing_front(0.148, x=x).points(cross(0, 1.85, 0.42)))


def _atm(builder: MeshBuilder, variant: int) -> None:
    """A cash machine: the word ATM in light, a screen, keys, a slot with notes."""
    body = (plain(0.10, 0.25, 0.52), plain(0.72, 0.10, 0.10))[variant]
    if builder.detail == FAR:
        mixed = plain(*(0.72 * part + 0.25 for part in body.colour))
        builder.box(mixed, (-0.5, 0, 0), (0.5, 0.3, 1.8))
        builder.decal(SIGN_WHITE.shaded(0.8), facing_front(0.31).points(rectangle(0, 1.62, 0.8, 0.26)))
        builder.decal(plain(0.45, 0.55, 0.60), facing_front(0.31).points(rectangle(0, 1.2, 0.6, 0.4)))
        return
    builder.box(STEEL, (-0.48, 0.0, 0.0), (0.48, 0.12, 1.78))
    builder.box(body, (-0.46, 0.08, 0.06), (0.46, 0.22, 0.98), bevel=0.02)
    builder.extrude(
        body, [(0.08, 0.9), (0.3, 0.9), (0.3, 0.96), (0.14, 1.06), (0.14, 1.45), (0.08, 1.45)], "x", -0.46, 0.46
    )
    builder.box(body, (-0.5, 0.08, 1.44), (0.5, 0.3, 1.8), bevel=0.03)
    builder.decal(
        Surface(Material.GLOW, (0.98, 0.98, 0.95)), facing_front(0.312).points(rectangle(0, 1.62, 0.86, 0.27))
    )
    write(builder, body, "ATM", facing_front(0.322), centre=(0, 1.62), height_m=0.22)
    screen = facing_front(0.152)
    builder.decal(BLACK, screen.points(rectangle(-0.08, 1.26, 0.52, 0.34)))
    near = facing_front(0.162)
    builder.decal(Surface(Material.GLOW, (0.45, 0.75, 0.95)), near.points(rectangle(-0.08, 1.26, 0.46, 0.28)))
    if builder.detail <= 1:
        for row in range(3):
            builder.decal(SIGN_WHITE, facing_front(0.172).points(rectangle(-0.08, 1.34 - 0.08 * row, 0.3, 0.03)))
        builder.decal(SIGN_GREEN, screen.points(rectangle(0.33, 1.32, 0.14, 0.05)))
        builder.decal(SIGN_YELLOW, screen.points(rectangle(0.33, 1.2, 0.14, 0.05)))
        slope = Plane((0.0, 0.235, 1.022), (-1.0, 0.0, 0.0), (0.0, -0.848, 0.53))
        for key in range(12):
            u, v = -0.1 + 0.065 * (key % 3), -0.06 + 0.045 * (key // 3)
            builder.decal(SIGN_WHITE, slope.points(rectangle(u, v, 0.045, 0.03)))
    builder.decal(BLACK, facing_front(0.232).points(rectangle(0, 0.8, 0.4, 0.07)))
    builder.decal(plain(0.55, 0.75, 0.60), facing_front(0.242).points(rectangle(0, 0.78, 0.26, 0.05)))
    builder.decal(SIGN_WHITE, facing_front(0.232).points(rectangle(0, 0.45, 0.6, 0.3)))
    write(
        builder, SIGN_BLUE if variant == 0 else SIGN_RED, "CASH", facing_front(0.242), centre=(0, 0.45), height_m=0.16
    )


MAKERS = {
    "cafe": Maker(_cafe, variants=2, relief_m=0.100),
    "restaurant": Maker(_restaurant, variants=2, relief_m=0.106),
    "bar": Maker(_bar, variants=2, relief_m=0.112),
    "shop": Maker(_shop, variants=len(_SHOPS), relief_m=0.118),
    "toilets": Maker(_toilets, relief_m=0.124),
    "pharmacy": Maker(_pharmacy, relief_m=0.130),
    "atm": Maker(_atm, variants=2, relief_m=0.136),
}
