"""What an answer says, whatever it is wrapped in: JSON, code fences, labelled lines, prose. Tolerant, never guessing.

An answer is understood where it says one thing. One that says several, or something off the scale, or that repeats
what it was shown, is `Unreadable`, with a reason in words of ours alone: the reason goes into the next question, where
nothing that a model or a caption said may stand as an instruction.
"""

import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from reasoned_explorer.minds.prompted.fence import harmless, has_mark, tidy
from reasoned_explorer.minds.prompted.values import LEVEL_WORDS, latin_digits, level_in, share_in, yes_or_no

EMPTY = "it was empty"
CUT_OFF = "it was cut off"
DECLINED = "it declined to answer"
REPEATED = "it repeated the question"
NO_LEVEL = "it said no level from 1 to 5"
NO_FOUND = "it did not say whether the goal is found"
NO_SCENE = "it described no scene"
SEVERAL = "it said several things at once"
NOT_YES_OR_NO = "it said something other than yes or no"

#: Of an answer, thoughts left out, so much is read, and so many statements in it.
_LONGEST_ANSWER = 4000
_MOST_STATEMENTS = 32
_LONGEST_SCENE_WORDS = 120
_SHORTEST_SCENE_WORDS = 4
#: A text this long may be cut out of an answer that holds it; shorter ones may be in it by chance.
_SHORTEST_ECHO_WORDS, _SHORTEST_ECHO = 3, 12
_OPEN_THOUGHT, _THOUGHT_OVER = re.compile(r"<think(?:ing)?>", re.IGNORECASE), re.compile(r"</think(?:ing)?>", re.I)
_CODE_FENCE = re.compile(r"^[ \t]*```[\w-]*[ \t]*$", re.MULTILINE)
_TRAILING_COMMA = re.compile(r",(\s*[}\]])")
_DECLINED = re.compile(
    r"\W*(?:i(?:['’]m| am) (?:sorry|unable|not able)|sorry\b|i (?:can ?not|can['’]t|won['’]t|must decline)|as an ai\b)",
    re.IGNORECASE,
)
_LABEL = r"(?:^|(?<=[\s*_`#({{>.,;\"'-]))(?:{names})[\"'*_`)]*\s*[:=]\s*([^\n]*)"
_LEVEL_NAMES = ("level", "score", "rating")
_THIS = r"(?:it|this|the scene|this scene)"
_PROSE_LEVEL = re.compile(
    rf"\b(?:(?:level|score|rating)(?: (?:is|of|would be|as))?|rate {_THIS}(?: (?:as|at|a|with))?(?: level)?"
    rf"|give {_THIS}(?: an?)?) [*_\"'(]{{0,3}}(\d[^\n]*)",
    re.IGNORECASE,
)
_OUT_OF_FIVE = re.compile(r"(?<![\w.,/-])(\d(?:[.,]\d+)?\s*(?:/|out of)\s*5\b[^\n]*)", re.IGNORECASE)
_NUMBER = re.compile(r"\d(?:[.,]\d+)?(?:\s*(?:/|out of)\s*\d+)?", re.IGNORECASE)
_NAMES_OF_LEVELS = "|".join(sorted(LEVEL_WORDS, key=len, reverse=True))
_BARE_LEVEL = re.compile(
    r"(?:-\s)?[\s*_#>\"'`(]*"
    rf"((?:\d(?:[.,]\d+)?(?:\s*(?:/|out of)\s*5)?(?:\s*[-–—:(]*\s*(?:{_NAMES_OF_LEVELS}))?|{_NAMES_OF_LEVELS})"
    r"[\s*_\"'`).]*)",
    re.IGNORECASE,
)
_BARE_YES_NO = re.compile(
    r"[\s*_#>\"'`(]*(yes|no|true|false)[*_\"'`)]*(?:$|\s*[,.!:;\n—–-](.*))", re.IGNORECASE | re.DOTALL
)
#: After a "yes" with one of these it is not clear what was meant.
_BUT = re.compile(r"\b(?:but|however|although|though|not|no|unless|if)\b|n['’]t\b", re.IGNORECASE)
_PREAMBLE = re.compile(r"^[^\n.]{0,160}:\s*\n+", re.IGNORECASE)
#: An object in another way of writing than JSON's.
_SCENE_WRITTEN = re.compile(r"\{\s*['\"]?scene['\"]?\s*:\s*(['\"])(.*)\1\s*,?\s*\}", re.IGNORECASE | re.DOTALL)
_SCENE_LABEL = re.compile(r"^\W*(?:imagined |next )?scene\W{0,4}:\W{0,4}", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Unreadable:
    """An answer that says nothing that counts.

    Attributes:
        reason: Why, in words that were written here.
    """

    reason: str


@dataclass(frozen=True, slots=True)
class Judgement:
    """What an evaluator's answer says.

    Attributes:
        level: In [1, 5].
        blocked: The way ahead is blocked; not said counts as not blocked, since what is missing bars nothing.
        forbidden: Likewise, the ground ahead is to be shunned.
    """

    level: float
    blocked: bool = False
    forbidden: bool = False


@dataclass(frozen=True, slots=True)
class Finding:
    """What a checker's answer says.

    Attributes:
        found: Whether the goal is there, within reach.
        certainty: How sure it says that it is of that, in [0, 1]; None where it says nothing of it.
        evidence: Words of the scene.
    """

    found: bool
    certainty: float | None = None
    evidence: str = ""


def read_judgement(answer: str, shown: Sequence[str]) -> Judgement | Unreadable:
    """Return what an evaluator's answer says.

    Args:
        answer: As it came.
        shown: The texts that the model was shown as data.
    """
    text = _unwrapped(answer)
    if isinstance(text, Unreadable):
        return text
    said = _said(text, "level", _LEVEL_NAMES, ("blocked", "forbidden"))
    if isinstance(said, Unreadable):
        return said
    level = level_in(said["level"]) if "level" in said else _level_in_prose(_without(text, shown), shown)
    if isinstance(level, Unreadable):
        return level
    if level is None:
        return Unreadable(_why(text, NO_LEVEL))
    flags = [yes_or_no(said[name]) if said.get(name) is not None else False for name in ("blocked", "forbidden")]
    blocked, forbidden = flags
    if blocked is None or forbidden is None:
        return Unreadable(NOT_YES_OR_NO)
    return Judgement(level, blocked, forbidden)


def read_finding(answer: str, shown: Sequence[str]) -> Finding | Unreadable:
    """Return what a checker's answer says; arguments as for `read_judgement`."""
    text = _unwrapped(answer)
    if isinstance(text, Unreadable):
        return text
    said = _said(text, "found", ("found",), ("confidence", "evidence"))
    if isinstance(said, Unreadable):
        return said
    found = yes_or_no(said["found"]) if "found" in said else _found_in_prose(_without(text, shown), shown)
    if found is None:
        return Unreadable(NOT_YES_OR_NO if "found" in said else _why(text, NO_FOUND))
    evidence = said.get("evidence")
    return Finding(found, share_in(said.get("confidence")), tidy(evidence)[:200] if isinstance(evidence, str) else "")


def read_scene(answer: str, shown: Sequence[str]) -> str | Unreadable:
    """Return the scene that a visionary's answer describes, on one line; arguments as for `read_judgement`."""
    text = _unwrapped(answer)
    if isinstance(text, Unreadable):
        return text
    scenes = [found["scene"] for found in _objects_with(text, "scene", ("scene",)) if isinstance(found["scene"], str)]
    if len(set(scenes)) > 1:
        return Unreadable(SEVERAL)
    if not scenes and (written := _SCENE_WRITTEN.fullmatch(text)):
        scenes = [written[2]]
    if not scenes:
        if text.startswith("{"):
            return Unreadable(CUT_OFF if text.count("{") > text.count("}") else NO_SCENE)
        if _DECLINED.match(text):
            return Unreadable(DECLINED)
    told = scenes[0] if scenes else _SCENE_LABEL.sub("", _PREAMBLE.sub("", text.strip(), count=1), count=1)
    scene = _shortened(tidy(told).strip("\"'*_ "))
    if _words(scene) in [_words(harmless(data)) for data in shown]:
        return Unreadable(REPEATED)
    return scene if len(scene.split()) >= _SHORTEST_SCENE_WORDS else Unreadable(NO_SCENE)


def _unwrapped(answer: str) -> str | Unreadable:
    """Return an answer without thoughts and code fences, in the digits 0 to 9."""
    # Some servers leave out the mark that a thought begins with: what counts comes after the last one that ends.
    text = latin_digits(_THOUGHT_OVER.split(answer)[-1][:_LONGEST_ANSWER])
    if has_mark(text):
        return Unreadable(REPEATED)
    if _OPEN_THOUGHT.search(text):
        return Unreadable(CUT_OFF)
    text = _CODE_FENCE.sub("", text).strip()
    return text or Unreadable(EMPTY)


def _said(text: str, main: str, names: Sequence[str], others: Sequence[str]) -> dict[str, Any] | Unreadable:
    """Return what is said under the main name and others, in JSON or else in labelled lines; empty where nothing is."""
    found = _objects_with(text, main, names)
    if found:
        said = [{name: value for name, value in each.items() if name in {main, *others}} for each in found]
    elif text.count("{") > text.count("}"):
        return Unreadable(CUT_OFF)
    else:
        said = [{main: value} for value in _labelled(text, names)]
        rest = {name: values[0] for name in others if (values := _labelled(text, (name,)))}
        said = [each | rest for each in said]
    if len({repr(_plain(each[main])) for each in said}) > 1:
        return Unreadable(SEVERAL)
    return said[0] if said else {}


def _plain(value: object) -> object:
    """Return a value by which two ways of saying the same are the same."""
    level = level_in(value)
    return level if level is not None else yes_or_no(value) if yes_or_no(value) is not None else value


def _labelled(text: str, names: Iterable[str]) -> list[str]:
    pattern = re.compile(_LABEL.format(names="|".join(names)), re.IGNORECASE | re.MULTILINE)
    return [match[1] for match in _overlapping(pattern, text)]


def _overlapping(pattern: re.Pattern[str], text: str) -> list[re.Match[str]]:
    """Return the matches of a pattern, those too that begin within the value of another."""
    found: list[re.Match[str]] = []
    place = 0
    while len(found) < _MOST_STATEMENTS and (match := pattern.search(text, place)):
        found.append(match)
        place = match.start(1) if match.start(1) > place else match.end() + 1
    return found


def _objects_with(text: str, main: str, names: Sequence[str]) -> list[dict[str, Any]]:
    """Return the JSON objects in a text that say the main thing, which may go by several names, keys in lower case."""
    found = []
    for each in _objects(text):
        for holder in _holders(each):
            keys = {key.strip().casefold(): value for key, value in holder.items() if isinstance(key, str)}
            name = next((name for name in names if name in keys), None)
            if name is not None:
                found.append({**keys, main: keys[name]})
    return found


def _holders(value: object, depth: int = 0) -> list[dict[Any, Any]]:
    """Return an object and those within it."""
    if depth > 4 or not isinstance(value, dict | list):
        return []
    inner = value.values() if isinstance(value, dict) else value
    within = [holder for each in inner for holder in _holders(each, depth + 1)]
    return [value, *within] if isinstance(value, dict) else within


def _objects(text: str) -> list[object]:
    found: list[object] = []
    place = text.find("{")
    for _ in range(_MOST_STATEMENTS):
        if place < 0:
            break
        value, end = _object_at(text, place)
        if value is not None:
            found.append(value)
        place = text.find("{", end)
    return found


def _object_at(text: str, place: int) -> tuple[object, int]:
    """Return the object that begins at a place and where it ends; None and the next place where there is none."""
    try:
        return json.JSONDecoder(object_pairs_hook=_said_once).raw_decode(text, place)
    except (ValueError, RecursionError):
        pass
    end = text.find("}", place) + 1
    try:
        return json.loads(_TRAILING_COMMA.sub(r"\1", text[place:end]), object_pairs_hook=_said_once), end
    except (ValueError, RecursionError):
        return None, place + 1


def _said_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    said: dict[str, Any] = {}
    for key, value in pairs:
        if key in said and said[key] != value:
            raise ValueError("said twice")
        said[key] = value
    return said


def _level_in_prose(text: str, shown: Sequence[str]) -> float | Unreadable | None:
    bare = _BARE_LEVEL.fullmatch(text.partition("\n")[0])
    if bare and not _is_shown(text, shown) and (level := level_in(bare[1])) is not None:
        return level
    said = [match for pattern in (_PROSE_LEVEL, _OUT_OF_FIVE) for match in _overlapping(pattern, text)]
    levels = {level_in(match[1]) for match in said if not _is_shown(_statement(match), shown)}
    if len(levels) > 1:
        return Unreadable(SEVERAL)
    return levels.pop() if levels else None


def _found_in_prose(text: str, shown: Sequence[str]) -> bool | None:
    bare = _BARE_YES_NO.match(text)
    said = None if bare is None else yes_or_no(bare[1])
    if bare is None or said is None:
        return None
    words = _words(text)
    if not said and words == _words(bare[1]):
        # Many a scene has a "no" in it: alone it is the model's own unless the scene is no more than that.
        return None if words in [_words(harmless(data)) for data in shown] else False
    if _is_shown(text, shown) or (said and (_is_shown(bare[1], shown) or _BUT.search(bare[2] or ""))):
        return None
    return said


def _statement(match: re.Match[str]) -> str:
    """Return the words of a match up to and with its number."""
    number = _NUMBER.match(match[1])
    return match.string[match.start() : match.start(1) + (number.end() if number else 0)]


def _words(text: str) -> str:
    return " ".join(re.findall(r"\w+", latin_digits(text).casefold()))


def _is_shown(said: str, shown: Sequence[str]) -> bool:
    """Return whether words stand in the model's input: they may not be its own, then."""
    words = _words(said)
    return any(f" {words} " in f" {_words(harmless(data))} " for data in shown)


def _without(text: str, shown: Sequence[str]) -> str:
    """Return an answer without the texts that the model was shown, where it repeats them."""
    left = text
    for data in shown:
        inside = latin_digits(harmless(data))
        if len(inside) >= _SHORTEST_ECHO and len(inside.split()) >= _SHORTEST_ECHO_WORDS:
            left = left.replace(inside, " ")
    return left.strip()


def _why(text: str, otherwise: str) -> str:
    return DECLINED if _DECLINED.match(text) else otherwise


def _shortened(scene: str) -> str:
    """Return a scene of at most so many words that ends after a sentence, where it has one near its end."""
    kept = " ".join(scene.split()[:_LONGEST_SCENE_WORDS])
    end = max(kept.rfind(sign) for sign in ".!?")
    return kept[: end + 1] if end > len(kept) // 2 else kept
