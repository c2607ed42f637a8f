"""The simulated captioner: it writes what a view's true content would be described as, with chosen errors.

It stands in for a vision-language model where there is none; whatever is made with it says so in its label.
"""

import math
from collections.abc import Awaitable, Callable, Sequence

from reasoned_explorer.model import Camera, Goal, PartError, View
from reasoned_explorer.model.draws import choice, key_of, uniform
from reasoned_explorer.perception.context import CaptionerContext
from reasoned_explorer.simulation.caption_errors import (
    GROUND_LOOKALIKES,
    LOOKALIKES,
    NOISY,
    PERFECT,
    SALIENCE,
    CaptionErrors,
    imagined_class,
    parts_of,
)
from reasoned_explorer.simulation.caption_style import (
    BLOCKED_M,
    MIDDLE_M,
    NEAR_M,
    Mention,
    harmless_name,
    write_caption,
)
from reasoned_explorer.simulation.sighting import Sighting, ViewContent
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES

_READABLE_WITHIN_M, _READABLE_FROM_PX = 12.0, 30.0
_SIGN_KINDS = frozenset({"place"})
_SIGN_CLASSES = frozenset({"monument", "information", "museum"})
# A thing that fills at least this share of the picture's width straight ahead stands in the way.
_IN_THE_WAY_SHARE = 0.25
_DEFAULT_CAMERA = Camera()
_TWENTY_BITS, _ELEVEN_BITS = 1.0 / (1 << 20), 1.0 / (1 << 11)
# Keys of draws of a view that belong to no object; objects' keys are their places, from 0 on.
_IMAGINE, _IMAGINED_PLACE, _GROUND, _STYLE = -1, -2, -3, -4

Charge = Callable[[str, tuple[int, ...], int], Awaitable[None]]


class SimulatedCaptioner:
    """Describes views from what a simulator knows to be in them.

    Every draw is keyed by the mission's seed, the view's key and the object, never by order: the same view is always
    described in the same words, whatever was described before.

    Args:
        name: As registered.
        errors: How well it sees and how it errs.
        seed: Of the mission.
        charge: Awaited once for each batch: it charges the time and keeps the ledger; None for neither.
    """

    def __init__(self, name: str, errors: CaptionErrors, *, seed: int = 0, charge: Charge | None = None) -> None:
        self.name = name
        self.label = f"simulated captioner ({name})"
        self.errors = errors
        self._view_seed = key_of(seed, "caption view")
        self._object_seed = key_of(seed, "caption object")
        self._charge = charge
        self._certain = _is_certain(errors)
        self._habits: dict[int, float | None] = {}  # only a memo: each follows from the seed and the object

    async def describe(self, goal: Goal, views: Sequence[View]) -> Sequence[str]:
        """Return one description per view, in the views' order.

        Raises:
            PartError: If a view does not come from a simulator.
        """
        del goal  # a description says what is there, whatever is sought
        contents = []
        for view in views:
            if not isinstance(view.content, ViewContent):
                reason = f"view {view.key} carries no content of a simulator; use a captioner that reads pictures"
                raise PartError("captioner", reason)
            contents.append(view.content)
        if self._charge is not None and views:
            await self._charge("captioner", views[0].key, len(views))
        return [self.caption(view.key, content, view.camera) for view, content in zip(views, contents, strict=True)]

    def caption(self, key: tuple[int, ...], content: ViewContent, camera: Camera = _DEFAULT_CAMERA) -> str:
        """Return the description of one view.

        Args:
            key: Of the view.
            content: What it shows.
            camera: What it was taken with.
        """
        errors = self.errors
        view_key = key_of(self._view_seed, *key)
        mentions = self.noticed(view_key, content, camera)
        if errors.imagine_rate > 0.0:
            mentions.extend(self._imagined(view_key, content))
        middle = content.stretches[len(content.stretches) // 2]
        ground = middle.near
        if errors.ground_error > 0.0:
            wrong, which, _, _ = parts_of(key_of(view_key, _GROUND))
            options = GROUND_LOOKALIKES.get(ground, ())
            if options and wrong < errors.ground_error:
                ground = options[int(which * len(options))]
        return write_caption(
            mentions,
            content,
            key=key_of(view_key, _STYLE),
            ground_ahead=ground,
            blocked_by=_blocked_by(content, camera),
            max_groups=errors.max_groups,
        )

    def noticed(self, view_key: int, content: ViewContent, camera: Camera = _DEFAULT_CAMERA) -> list[Mention]:
        """Return what is noticed of a view's true things, each as it is said to be (`view_key` keys the draws)."""
        errors = self.errors
        ahead_within_rad = camera.horizontal_fov_rad / 6.0
        least_width_px, least_height_px, certain = errors.least_width_px, errors.least_height_px, self._certain
        found = []
        for seen in content.sightings:
            if seen.width_px < least_width_px and seen.height_px < least_height_px:
                continue
            size_px = math.sqrt(seen.width_px * seen.height_px * seen.visible_share)
            name, zone = seen.class_name, 0 if seen.distance_m < NEAR_M else (1 if seen.distance_m <= MIDDLE_M else 2)
            side = 1 if abs(seen.bearing_rad) < ahead_within_rad else (0 if seen.bearing_rad < 0.0 else 2)
            prominence = size_px * SALIENCE.get(name, 1.0)
            twisted = False
            if not certain:
                key = key_of(view_key, seen.object_id)
                habit = self._habit(seen.object_id)
                missed = (key & 0xFFFFF) * _TWENTY_BITS if habit is None else habit
                if missed >= errors.notice_probability(size_px, name):
                    continue
                # The key's other bits, 11 for each draw: rates are kept to one in two thousand.
                zone = _misjudged(zone, (key >> 20 & 0x7FF) * _ELEVEN_BITS, errors.depth_error)
                side = _mistaken(side, (key >> 31 & 0x7FF) * _ELEVEN_BITS, errors.side_error)
                twisted = (key >> 42 & 0x7FF) * _ELEVEN_BITS < errors.relation_error
                sign = self._sign(seen)
                if sign and uniform(key, "sign") >= errors.sign_rate:
                    sign = ""
                if (key >> 53 & 0x7FF) * _ELEVEN_BITS < errors.confuse_rate and name in LOOKALIKES:
                    name, sign = choice(LOOKALIKES[name], key, "lookalike"), ""
            else:
                sign = self._sign(seen)
            ahead_m = seen.distance_m * math.cos(seen.bearing_rad)
            right_m = seen.distance_m * math.sin(seen.bearing_rad)
            found.append(Mention(name, zone, side, ahead_m, right_m, prominence, seen.under, sign, twisted))
        return found

    def _habit(self, object_id: int) -> float | None:
        """The draw that decides about an object at every look, or None where each look decides anew."""
        if object_id not in self._habits:
            always, draw, _, _ = parts_of(key_of(self._object_seed, object_id))
            self._habits[object_id] = draw if always < self.errors.same_object_share else None
        return self._habits[object_id]

    def _sign(self, seen: Sighting) -> str:
        if not seen.name or seen.distance_m > _READABLE_WITHIN_M:
            return ""
        if seen.width_px * seen.visible_share < _READABLE_FROM_PX:
            return ""
        if OBJECT_CLASSES[seen.class_name].kind not in _SIGN_KINDS and seen.class_name not in _SIGN_CLASSES:
            return ""
        return harmless_name(seen.name)

    def _imagined(self, view_key: int, content: ViewContent) -> list[Mention]:
        key = key_of(view_key, _IMAGINE)
        if parts_of(key)[0] >= self.errors.imagine_rate:
            return []
        seen = frozenset(sighting.class_name for sighting in content.sightings)
        key = key_of(view_key, _IMAGINED_PLACE)
        name = imagined_class(seen, self.errors.companion_share, key)
        if name is None:
            return []
        depth, aside, size, _ = parts_of(key_of(key, 1))
        # Most often somewhere in the middle, as large as what is told there.
        zone = 0 if depth < 0.25 else (1 if depth < 0.75 else 2)
        return [Mention(name, zone, int(aside * 3), 0.0, 0.0, 20.0 + 40.0 * size, imagined=True)]


def _is_certain(errors: CaptionErrors) -> bool:
    """Whether nothing about a thing that is large enough is left to chance."""
    rates = (errors.half_seen_px, errors.depth_error, errors.side_error, errors.relation_error, errors.confuse_rate)
    return not any(rates) and errors.ceiling == 1.0 and errors.sign_rate == 1.0


def _misjudged(zone: int, draw: float, rate: float) -> int:
    """At a rate the next step of nearness instead of the true one."""
    if draw >= rate:
        return zone
    return 1 if zone != 1 else (0 if draw < 0.5 * rate else 2)


def _mistaken(side: int, draw: float, rate: float) -> int:
    """At a rate one of the two other sides, each as likely."""
    return side if draw >= rate else (side + (1 if draw < 0.5 * rate else 2)) % 3


def _blocked_by(content: ViewContent, camera: Camera) -> str | None:
    middle = content.stretches[len(content.stretches) // 2]
    if middle.free_m >= BLOCKED_M or not middle.ends_at:
        return None
    if middle.ends_at == "building":
        return "building"
    for seen in content.sightings:
        if seen.distance_m > BLOCKED_M:
            break
        wide = seen.width_px >= _IN_THE_WAY_SHARE * camera.width_px
        if wide and seen.class_name == middle.ends_at and OBJECT_CLASSES[seen.class_name].solid:
            return seen.class_name if seen.class_name != "tree" else None
    return None


def perfect(context: CaptionerContext) -> SimulatedCaptioner:
    """Make the captioner that names everything that can be made out, where it is."""
    return SimulatedCaptioner("perfect", PERFECT, seed=context.seed, charge=context.charge)


def noisy(context: CaptionerContext) -> SimulatedCaptioner:
    """Make the captioner that misses, imagines, misplaces and confuses at the rates of `NOISY` (assumed)."""
    return SimulatedCaptioner("noisy", NOISY, seed=context.seed, charge=context.charge)


def noisier(context: CaptionerContext) -> SimulatedCaptioner:
    """Make a captioner with one and a half times the errors of `NOISY`: how a ranking stands is asked with it."""
    return SimulatedCaptioner("noisier", NOISY.times(1.5), seed=context.seed, charge=context.charge)


def noisiest(context: CaptionerContext) -> SimulatedCaptioner:
    """Make a captioner with twice the errors of `NOISY`."""
    return SimulatedCaptioner("noisiest", NOISY.times(2.0), seed=context.seed, charge=context.charge)
