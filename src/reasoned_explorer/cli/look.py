"""``rex look``."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from reasoned_explorer.cli.answers import complain
from reasoned_explorer.cli.console import Output
from reasoned_explorer.cli.look_files import check_target, files_of, write_together
from reasoned_explorer.cli.parsing import BoxDeg, check_view_form, parse_bbox, parse_size, parse_view
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Fault, Gathering, SettingsError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.rendering.conditions import conditions_named
from reasoned_explorer.rendering.readiness import begin, cores, is_ready, make_ready
from reasoned_explorer.world.opening import check_world_name, open_world_with_notes
from reasoned_explorer.world.world import World

if TYPE_CHECKING:
    from reasoned_explorer.rendering.renderer import Picture, Renderer
    from reasoned_explorer.rendering.scene import Scene

#: Sides of pictures, pixels.
SIDE_RANGE_PX = (16, 4096)
#: What each kind of picture is drawn with where nothing else is said: width and height, pixels.
_SIZES = {
    "a view": (1024, 768),
    "--sweep": (448, 448),
    "--rig": (224, 224),
    "--panorama": (2048, 512),
    "--top-down": (1024, 1024),
    "--contact-sheet": (224, 224),
}
#: Options that mean nothing for a kind of picture.
_IDLE: Mapping[str, frozenset[str]] = {
    "a view": frozenset({"--span"}),
    "--sweep": frozenset({"--span"}),
    "--rig": frozenset({"--span", "--size", "--width", "--height", "--fov", "--pitch"}),
    "--panorama": frozenset({"--span", "--fov", "--pitch"}),
    "--top-down": frozenset({"--fov", "--pitch"}),
    "--contact-sheet": frozenset(
        {"--span", "--size", "--width", "--height", "--fov", "--pitch", "--at", "--bbox", "--depth", "--ids"}
    ),
}
_FOV_RANGE_DEG, _SPAN_RANGE_M, _SWEEP_RANGE = (1.0, 170.0), (1.0, 9000.0), (1, 24)
#: Bearings of a rig's cameras, radians, and how high they are, metres (C: the authors' AirSim settings).
_RIGS: Mapping[str, tuple[tuple[float, ...], float]] = {
    "authors": (tuple(math.radians(bearing_deg) for bearing_deg in (-45.0, 0.0, 45.0)), 1.0)
}
#: Cameras are so high where nothing else is said, metres: as our drone's.
_HEIGHT_M = 1.5


@dataclass(frozen=True, slots=True)
class LookOptions:
    """What a person typed; see ``rex look --help``."""

    world: str = "park:7"
    bbox: str | None = None
    seed: int = 0
    at: str | None = None
    out: Path = Path("look.png")
    size: str | None = None
    width_px: int | None = None
    height_px: int | None = None
    fov_deg: float | None = None
    pitch_deg: float | None = None
    conditions: str = "clear"
    panorama: bool = False
    top_down: bool = False
    span_m: float | None = None
    rig: str | None = None
    sweep: int | None = None
    depth: bool = False
    ids: bool = False
    contact_sheet: bool = False

    @property
    def kinds(self) -> list[str]:
        """The kinds of pictures that were asked for: one, if all is well."""
        asked = {
            "--panorama": self.panorama,
            "--top-down": self.top_down,
            "--rig": self.rig is not None,
            "--sweep": self.sweep is not None,
            "--contact-sheet": self.contact_sheet,
        }
        return [kind for kind, is_asked in asked.items() if is_asked] or ["a view"]

    @property
    def given(self) -> set[str]:
        """The options that were given, of those that do not go with everything."""
        values = {
            "--at": self.at,
            "--bbox": self.bbox,
            "--size": self.size,
            "--width": self.width_px,
            "--height": self.height_px,
            "--fov": self.fov_deg,
            "--pitch": self.pitch_deg,
            "--span": self.span_m,
            "--depth": self.depth or None,
            "--ids": self.ids or None,
        }
        return {name for name, value in values.items() if value is not None}

    def checked(self) -> "_Order":
        """Return what is to be drawn, once all has been checked that can be without the world.

        Raises:
            InputError: With everything that is wrong.
        """
        found = Gathering()
        if faults := self._faults():
            found.add(SettingsError("look", faults))
        width_px, height_px = found.take(self._size, (0, 0))
        bbox = found.take(lambda: parse_bbox(self.bbox), None)
        found.check(lambda: conditions_named(self.conditions))
        if not self.contact_sheet:
            found.check(lambda: check_world_name(self.world, seed=max(self.seed, 0), bbox=bbox))
        found.check(lambda: check_view_form(self.at))
        found.check(lambda: check_target(self.out))
        found.finish("look")
        fov_rad = math.radians(90.0 if self.fov_deg is None else self.fov_deg)
        return _Order(
            kind=self.kinds[0],
            camera=Camera(width_px, height_px, fov_rad),
            pitch_rad=math.radians(self.pitch_deg or 0.0),
            bbox=bbox,
            options=self,
        )

    def _size(self) -> tuple[int, int]:
        size = _SIZES[self.kinds[0]]
        if self.size is not None:
            size = parse_size(self.size)
        size = (
            size[0] if self.width_px is None else self.width_px,
            size[1] if self.height_px is None else self.height_px,
        )
        low, high = SIDE_RANGE_PX
        faults = [
            Fault(f"{name} is {side} pixels", f"{low} to {high:,}")
            for name, side in zip(("the width", "the height"), size, strict=True)
            if not low <= side <= high
        ]
        if faults:
            raise SettingsError("look", faults)
        return size

    def _faults(self) -> list[Fault]:
        kinds, given = self.kinds, self.given
        faults = []
        if len(kinds) > 1:
            faults.append(Fault(" and ".join(kinds), "one of them"))
        else:
            idle = sorted(_IDLE[kinds[0]] & given)
            faults += [Fault(f"{name} with {kinds[0]}", "one of them", f"leave {name} out") for name in idle]
        if self.at is None and not {"--top-down", "--contact-sheet"} & set(kinds):
            faults.append(
                Fault("no --at", "x,y,z,heading; lat,lon,z,heading in a real place", "say where to look from")
            )
        if self.seed < 0:
            faults.append(Fault(f"--seed is {self.seed}", "a whole number from 0 on"))
        if "--size" in given and {"--width", "--height"} & given:
            faults.append(Fault("--size with --width or --height", "either"))
        if self.rig is not None and self.rig not in _RIGS:
            faults.append(Fault(f"--rig is {self.rig!r:.60}", f"one of {', '.join(_RIGS)}"))
        ranges = (
            ("--fov", self.fov_deg, _FOV_RANGE_DEG, "degrees"),
            ("--pitch", self.pitch_deg, (-90.0, 90.0), "degrees"),
            ("--span", self.span_m, _SPAN_RANGE_M, "metres"),
            ("--sweep", self.sweep, _SWEEP_RANGE, "views"),
        )
        faults += [
            Fault(f"{name} is {value}", f"{low:g} to {high:,g} {unit}")
            for name, value, (low, high), unit in ranges
            if value is not None and not is_within(value, low, high)
        ]
        return faults


@dataclass(frozen=True, slots=True)
class _Order:
    """What is to be drawn.

    Attributes:
        kind: One of `_SIZES`.
        camera: Of each view.
        pitch_rad: How far it looks up.
        bbox: Of an OpenStreetMap file.
        options: As they were typed.
    """

    kind: str
    camera: Camera
    pitch_rad: float
    bbox: BoxDeg | None
    options: LookOptions


def look_from_options(options: LookOptions) -> None:
    """Draw what was asked for, write it, and say what is seen."""
    order, console = options.checked(), Output()

    def say(line: str) -> None:
        console.print(line, markup=False, soft_wrap=True)

    compiling = not is_ready()
    if compiling:
        say("compiling what draws, which takes a quarter of a minute or so (the first time only):")
    stage: Callable[[str], None] = (lambda what: say(f"  {what} …")) if compiling else (lambda _: None)
    # What is missing is compiled beside the making of the world.
    begin()
    if order.kind == "--contact-sheet":
        from reasoned_explorer.rendering.contact_sheet import contact_sheet

        _make_ready(stage)
        stage("the classes")
        colour = contact_sheet(conditions=conditions_named(options.conditions))
        write_together(files_of(options.out, colour))
        say(f"drawn to {options.out}")
        return
    stage("the world")
    world, notes = open_world_with_notes(options.world, seed=options.seed, bbox=order.bbox)
    for note in notes:
        complain(f"note: {note}; choose a part with --bbox")
    stop_if_asked()
    pose = _pose(order, world)
    picture, heights, scene = _drawn(order, world, pose, stage)
    written = files_of(
        options.out,
        picture.colour,
        depth_m=picture.depth_m if options.depth and not heights else None,
        heights_m=picture.depth_m if options.depth and heights else None,
        instances=picture.instances if options.ids else None,
        classes=scene.classes[picture.instances] if options.ids else None,
        thanks=world.attribution,
    )
    write_together(written)
    say(f"drawn to {', '.join(str(path) for path in written)}")
    if world.attribution:
        say(f"map  {world.attribution}")


def _pose(order: _Order, world: World) -> Pose:
    """Return where the camera is; from above it is the middle of the world unless said otherwise."""
    if order.options.at is None:
        bounds = world.bounds
        return Pose(0.5 * (bounds.min_x_m + bounds.max_x_m), 0.5 * (bounds.min_y_m + bounds.max_y_m))
    height_m = _HEIGHT_M if order.options.rig is None else _RIGS[order.options.rig][1]
    return parse_view(order.options.at, world, height_m=height_m)


def _drawn(order: _Order, world: World, pose: Pose, stage: Callable[[str], None]) -> "tuple[Picture, bool, Scene]":
    """Return the picture, whether its depths are heights above the ground, and its scene."""
    from reasoned_explorer.rendering.renderer import Renderer
    from reasoned_explorer.rendering.scene import Scene

    options, conditions = order.options, conditions_named(order.options.conditions)
    stage("what things look like")
    scene = Scene.of(world, on_progress=lambda what: stage(f"  {what}"))
    stop_if_asked()
    _make_ready(stage)
    stage("light and shadow")
    if order.kind == "--top-down":
        from reasoned_explorer.rendering.overhead import overhead

        bounds = world.bounds
        ratio = order.camera.width_px / order.camera.height_px
        span_m = options.span_m or min(_SPAN_RANGE_M[1], max(bounds.width_m, bounds.height_m * ratio))
        return (
            overhead(
                scene,
                pose.x_m,
                pose.y_m,
                span_m=span_m,
                width_px=order.camera.width_px,
                height_px=order.camera.height_px,
                heading_rad=pose.heading_rad,
                conditions=conditions,
            ),
            True,
            scene,
        )
    return _around(order, Renderer(scene, conditions, threads=cores()), pose), False, scene


def _make_ready(stage: Callable[[str], None]) -> None:
    """Return when all is there that no scene is needed for; what needs no kernels comes first, beside those at work."""
    from reasoned_explorer.rendering.mipmaps import material_textures

    stage("textures")
    material_textures()
    make_ready(stage)


def _around(order: _Order, renderer: "Renderer", pose: Pose) -> "Picture":
    from reasoned_explorer.rendering.panorama import panorama, side_by_side

    options, camera = order.options, order.camera
    if order.kind == "--panorama":
        return panorama(renderer, pose, width_px=camera.width_px, height_px=camera.height_px)
    bearings_rad: tuple[float, ...] = (0.0,)
    if options.rig is not None:
        bearings_rad = _RIGS[options.rig][0]
    elif options.sweep is not None:
        bearings_rad = tuple(ExplorerSettings(views=options.sweep).bearings_rad())
    return side_by_side(renderer, pose, camera, bearings_rad, pitch_rad=order.pitch_rad)
