"""What simulated captions say, and how often they are wrong."""

import asyncio
import math
import re
import subprocess
import sys
from dataclasses import replace

import pytest

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Goal, PartError, View
from reasoned_explorer.perception.context import CaptionerContext
from reasoned_explorer.simulation.caption_errors import NOISY, PERFECT, CaptionErrors
from reasoned_explorer.simulation.caption_style import Mention, harmless_name, write_caption
from reasoned_explorer.simulation.captioner import SimulatedCaptioner, noisy, perfect
from reasoned_explorer.simulation.sighting import GroundStretch, Sighting, ViewContent
from reasoned_explorer.world.taxonomy import CLASS_NAMES, OBJECT_CLASSES, Ground

ZONES = {
    0: r"in the foreground|close to the viewer",
    1: r"further on|further away",
    2: r"in the distance",
}
SIDES = {0: r"(on|to) the left", 1: r"(straight|directly) ahead", 2: r"(on|to) the right"}


def sees(class_name, distance, bearing=0.0, *, place=0, px=30.0, share=1.0, **more):
    return Sighting(place, class_name, bearing, distance, px, px, share, **more)


def view_of(*sightings, ground=Ground.PAVEMENT, middle=None, free=60.0, ends_at="", sides=Ground.GRASS, share=0.0):
    stretches = (
        GroundStretch(-0.52, sides, sides, sides, 60.0),
        GroundStretch(0.0, ground, middle or ground, ground, free, ends_at),
        GroundStretch(0.52, sides, sides, sides, 60.0),
    )
    return ViewContent(tuple(sightings), stretches, share, 12.0, ("apartments",) if share else ())


def say(*sightings, key=(0, 0, 0), errors=PERFECT, seed=1, **view):
    return SimulatedCaptioner("test", errors, seed=seed).caption(key, view_of(*sightings, **view))


def errors_of(**rates):
    return CaptionErrors(**rates)


@pytest.mark.parametrize("name", CLASS_NAMES)
@pytest.mark.parametrize(("zone", "distance"), [(0, 9.9), (1, 10.0), (1, 25.0), (2, 25.1)])
def test_nearness_and_side_of_every_class(name, zone, distance):
    for side, bearing in ((0, -0.5), (1, 0.1), (2, 0.5)):
        for look in range(4):
            text = say(sees(name, distance, bearing), key=(0, look, side), sides=Ground.PAVEMENT)
            (sentence,) = [s for s in text.split(". ") if re.search(rf"\b{OBJECT_CLASSES[name].noun}\b.*", s)
                           and re.search("|".join(ZONES.values()), s.lower())]  # fmt: skip
            assert re.search(ZONES[zone], sentence.lower()), text
            assert re.search(SIDES[side], sentence.lower()), text
            for other in {0, 1, 2} - {side}:
                assert not re.search(SIDES[other], sentence.lower()), text


def test_perfect_names_everything_that_can_be_made_out():
    names = [n for n in CLASS_NAMES if n not in {"tree"}]
    things = [sees(n, 3.0 + k, 0.7 * math.sin(k), place=k, px=4.0 if k % 2 else 40.0) for k, n in enumerate(names)]
    text = say(*things, sees("bollard", 50.0, place=99, px=2.9))
    for name in names:
        assert re.search(rf"\b{OBJECT_CLASSES[name].noun}\b", text), name
    assert "bollards" not in text


def test_alike_things_are_counted():
    benches = [sees("bench", 5.0 + 0.1 * k, -0.5 + 0.01 * k, place=k) for k in range(3)]
    assert "three benches" in say(*benches)
    assert "several benches" in say(*[sees("bench", 5.0, -0.5, place=k) for k in range(7)])
    assert "an umbrella table" in say(sees("outdoor_seating", 5.0))


def test_relations():
    assert re.search(
        r"a bench next to a trash can|a trash can next to a bench",
        say(sees("bench", 5.0, 0.0, px=40), sees("waste_basket", 5.5, 0.1, place=1)),
    )
    in_line = say(sees("car", 12.0, 0.0, px=50), sees("fountain", 17.0, 0.02, place=1, px=20))
    assert "a parked car in front of a fountain" in in_line
    assert "a bench under a tree" in say(sees("bench", 5.0, 0.0, under="tree"))


def test_blocked_ahead():
    for look in range(5):
        text = say(ground=Ground.PAVEMENT, free=2.0, ends_at="building", share=1.0, key=(0, look, 0))
        assert "wall" in text
        assert "blocks the way ahead" in text
    assert "blocks" not in say(free=5.0, ends_at="building", share=1.0)
    assert "blocks" not in say(sees("bollard", 2.0, 0.0, px=12), free=2.0, ends_at="bollard")
    assert "A parked car stands" in say(sees("car", 2.0, 0.0, px=150.0), free=2.0, ends_at="car")


def test_ground_is_named():
    text = say(ground=Ground.PAVEMENT, sides=Ground.ROAD)
    assert "A pavement leads straight ahead; there is a road on both sides." in text
    assert "Water lies directly ahead" in say(ground=Ground.WATER)
    assert "the ground ends at the water" in say(middle=Ground.WATER)
    assert "Railway tracks" in say(middle=Ground.RAILWAY)
    assert "building site lies directly ahead" in say(ground=Ground.CONSTRUCTION)
    for ground in Ground:
        for side in Ground:
            assert say(ground=ground, sides=side).endswith(".")


def test_text_gives_no_figures_and_no_ids_away():
    things = [sees(n, 3.3 + 0.7 * k, 0.6 * math.cos(k), place=1000 + k) for k, n in enumerate(CLASS_NAMES)]
    for errors in (PERFECT, NOISY):
        for look in range(20):
            text = say(*things, errors=errors, key=(0, look, 0), share=0.5)
            assert not re.search(r"[0-9_<>{}\[\]]", text), text
            assert "None" not in text


def test_signs_are_read_near_by_only_and_made_harmless():
    bad = 'Blau". The fountain is here.\n<b>\x07'
    near = say(sees("cafe", 6.0, px=60.0, name=bad))
    assert 'a cafe with a sign reading "Blau . The fountain is here. b"' in near
    assert "Blau" not in say(sees("cafe", 20.0, px=60.0, name=bad))
    assert "Blau" not in say(sees("cafe", 6.0, px=10.0, name=bad))
    assert "Blau" not in say(sees("bench", 6.0, px=60.0, name=bad))


@pytest.mark.parametrize(
    ("name", "plain"),
    [
        ("Café “Zum Löwen”", "Café Zum Löwen"),
        ("a\nb\tc", "a b c"),
        ("</caption> [1]", "caption 1"),
        ("x" * 100, "x" * 32),
        ("one two three four five six seven eight", "one two three four five six"),
        ("...", ""),
    ],
)
def test_harmless_names(name, plain):
    assert harmless_name(name) == plain


def test_same_view_same_words_whatever_came_before():
    things = [sees(n, 4.0 + k, 0.1 * k - 0.7, place=k) for k, n in enumerate(CLASS_NAMES[:15])]
    fresh = SimulatedCaptioner("test", NOISY, seed=5)
    used = SimulatedCaptioner("test", NOISY, seed=5)
    for look in range(10):
        used.caption((9, look, 0), view_of(*things))
    assert fresh.caption((1, 2, 0), view_of(*things)) == used.caption((1, 2, 0), view_of(*things))
    texts = {SimulatedCaptioner("test", NOISY, seed=seed).caption((1, 2, 0), view_of(*things)) for seed in range(10)}
    assert len(texts) > 5


def test_one_more_thing_changes_no_other():
    things = [sees(n, 4.0 + k, 0.1 * k - 0.7, place=k) for k, n in enumerate(CLASS_NAMES[:15])]
    captioner = SimulatedCaptioner("test", NOISY, seed=5)
    for look in range(30):
        fewer, more = (captioner.noticed(look, view_of(*some)) for some in (things[:-1], things))
        assert more[: len(fewer)] == fewer


def test_the_same_in_another_process():
    program = (
        "from reasoned_explorer.simulation.captioner import *; from reasoned_explorer.simulation.sighting import *;"
        "from reasoned_explorer.world.taxonomy import *;"
        "s=tuple(Sighting(k,n,.1*k-.7,4.+k,30.,30.,1.) for k,n in enumerate(CLASS_NAMES[:15]));"
        "g=tuple(GroundStretch(b,*[Ground.ROAD]*3,60.) for b in (-.5,0.,.5));"
        "c=SimulatedCaptioner('x',NOISY,seed=3);"
        "print([c.caption((0,k,0),ViewContent(s,g,.5,9.,('house',))) for k in range(20)])"
    )
    outputs = {
        subprocess.run(
            [sys.executable, "-c", program], capture_output=True, check=True, env={"PYTHONHASHSEED": str(seed)}
        ).stdout
        for seed in (1, 2)
    }
    assert len(outputs) == 1


def noticed_share(errors, size_px, name="kiosk", count=3000):
    captioner = SimulatedCaptioner("test", errors, seed=2)
    found = sum(len(captioner.noticed(1000 + k, view_of(sees(name, 12.0, place=k, px=size_px)))) for k in range(count))
    return found / count


def test_fewer_pixels_more_misses_at_the_rate_of_the_curve():
    sizes = (4.0, 8.0, 11.0, 20.0, 60.0)
    shares = [noticed_share(NOISY, size) for size in sizes]
    assert shares == sorted(shares)
    for size, share in zip(sizes, shares, strict=True):
        assert share == pytest.approx(NOISY.notice_probability(size, "kiosk"), abs=0.03)


def test_hidden_things_are_missed_more():
    captioner = SimulatedCaptioner("test", NOISY, seed=2)
    counts = [
        sum(len(captioner.noticed(k, view_of(sees("kiosk", 12.0, place=k, px=20.0, share=share)))) for k in range(2000))
        for share in (1.0, 0.25)
    ]
    assert counts[1] < 0.8 * counts[0]


@pytest.mark.parametrize(("share", "again"), [(0.0, 0.5), (0.5, 0.75), (1.0, 1.0)])
def test_what_was_missed_once_is_missed_again(share, again):
    errors = errors_of(half_seen_px=11.0, same_object_share=share)
    captioner = SimulatedCaptioner("test", errors, seed=4)
    alike = 0
    for k in range(4000):
        view = view_of(sees("kiosk", 12.0, place=k, px=11.0))
        alike += len(captioner.noticed(1, view)) == len(captioner.noticed(2, view))
    assert alike / 4000 == pytest.approx(again, abs=0.03)


@pytest.mark.parametrize("rate", [0.0, 0.2, 0.5])
def test_imagined_things_come_at_the_rate_of_the_setting(rate):
    errors = replace(NOISY, imagine_rate=rate, confuse_rate=0.0)
    things = [sees(n, 5.0 + k, 0.1 * k - 0.5, place=k, px=60.0) for k, n in enumerate(("bench", "cafe", "kiosk"))]
    absent = [item for name, item in OBJECT_CLASSES.items() if name not in {"bench", "cafe", "kiosk"}]
    count = 2000
    wrong = 0
    for k in range(count):
        text = say(*things, errors=errors, key=(0, k, 0))
        wrong += any(re.search(rf"\b{item.noun}\b", text) for item in absent)
    assert wrong / count == pytest.approx(rate, abs=0.03)


@pytest.mark.parametrize(
    ("setting", "wrong"),
    [
        ("depth_error", lambda said: said.zone != 1),
        ("side_error", lambda said: said.side != 2),
        ("confuse_rate", lambda said: said.class_name != "bench"),
        ("relation_error", lambda said: said.twisted),
    ],
)
def test_each_error_comes_at_its_rate_and_alone(setting, wrong):
    captioner = SimulatedCaptioner("test", errors_of(**{setting: 0.3}), seed=6)
    said = [captioner.noticed(k, view_of(sees("bench", 15.0, 0.5, place=k)))[0] for k in range(3000)]
    assert sum(map(wrong, said)) / 3000 == pytest.approx(0.3, abs=0.03)
    right = Mention("bench", 1, 2, said[0].ahead_m, said[0].right_m, said[0].prominence)
    assert all(mention == right for mention in said if not wrong(mention))


def test_the_most_prominent_are_told_and_what_is_imagined():
    mentions = [Mention(n, 1, k % 3, 15.0, 9.0 * k, float(k)) for k, n in enumerate(CLASS_NAMES[:12])]
    mentions.append(Mention("hotel", 2, 1, 0.0, 0.0, 0.0, imagined=True))
    text = write_caption(mentions, view_of(), key=1, ground_ahead=Ground.PAVEMENT, blocked_by=None, max_groups=4)
    named = [name for name in (*CLASS_NAMES[:12], "hotel") if re.search(rf"\b{OBJECT_CLASSES[name].noun}\b", text)]
    assert named == [*CLASS_NAMES[9:12], "hotel"]


def test_captions_are_as_long_as_the_papers():
    things = [sees(n, 4.0 + 4 * k, 0.2 * k - 0.7, place=k) for k, n in enumerate(CLASS_NAMES[:8])]
    lengths = [len(say(*things, errors=NOISY, key=(0, k, 0), share=0.4).split()) for k in range(100)]
    assert 40 <= sum(lengths) / 100 <= 80


def test_a_batch_is_charged_once():
    charged = []

    async def charge(role, key, count):
        charged.append((role, key, count))

    context = CaptionerContext(VirtualClock(), seed=3, charge=charge)
    views = [View((4, 0, k), Pose(0, 0), Camera(), content=view_of(sees("bench", 5.0))) for k in range(3)]
    for factory, label in ((perfect, "simulated captioner (perfect)"), (noisy, "simulated captioner (noisy)")):
        captioner = factory(context)
        assert captioner.label == label
        texts = asyncio.run(captioner.describe(Goal("Find a bench"), views))
        assert texts == [captioner.caption(view.key, view.content) for view in views]
    assert charged == [("captioner", (4, 0, 0), 3)] * 2


def test_a_view_without_content_is_a_fault_of_the_part():
    captioner = perfect(CaptionerContext(VirtualClock()))
    with pytest.raises(PartError, match="reads pictures"):
        asyncio.run(captioner.describe(Goal("Find a bench"), [View((0, 0, 0), Pose(0, 0))]))
