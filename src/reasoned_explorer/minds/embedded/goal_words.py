"""The words of goal sentences that name nothing: how one asks, what one takes back, where one is to go."""

import re

from reasoned_explorer.minds.embedded.lexicon import word_set

CONTRACTIONS = (
    ("can't", "can not"), ("cannot", "can not"), ("won't", "will not"), ("n't", " not"), ("i'm", "i am"),
    ("i'd", "i would"), ("i've", "i have"), ("i'll", "i will"), ("where's", "where is"), ("there's", "there is"),
    ("that's", "that is"), ("it's", "it is"), ("let's", "let us"), ("we're", "we are"), ("dont ", "do not "),
    ("what's", "what is"), ("kids'", "kids"), ("we'd", "we would"),
)  # fmt: skip

_FIND = (
    r"find|locate|look for|looking for|search for|searching for|search|seek|spot|show|take|bring|lead|guide|get|go|"
    r"navigate|"
    r"head|walk|drive|fly|move|travel|reach|hunt for|track down|point|direct|fetch|discover|identify|give|see|visit|"
    r"finding|go and find|go find|go to|i need|i want|i require|we need|we want|i would like|we would like|i would "
    r"love|"
    r"i am searching for|i am looking for|we are looking for|need|want|wanted|is there|are there|do you see|can you "
    r"see|"
    r"where is|where are|where can i find|where can we find|where could i find|where do i find|where can i get|"
    r"where do i get|what about|your goal is|your task is|the goal is|the target is|goal|target|destination|i have to "
    r"find|"
    r"i must find|i am trying to find|help me find|any idea where there is|do you know where there is|do you know of"
)
#: One leading piece of "could you please find me the nearest"; `frame` is set where it says that something is sought.
FRAMES = re.compile(
    r"^(?:(?:please|hey|hi|hello|ok|okay|robot|drone|dear|kindly|now|so|well|then|and|but|just|quickly|excuse me|sorry|"
    r"um|uh|could you|can you|would you|will you|would you mind|i want you to|i would like you to|i need you to|"
    r"you should|you must|you need to|try to|help me to|help me|let us|we should|first|thanks|thank you|good robot|"
    r"urgently|asap|for me|for us|me|us|to|out|the way|my way|directions)(?=\s|$)"
    rf"|(?P<frame>(?:{_FIND})(?: (?:for me|for us|me|us))?(?: to)?)(?=\s|$))[\s,]*"
)

#: Where a new clause begins without a comma.
CLAUSE_STARTS = re.compile(
    r"\s+(?:but|while|and then|then)\s+(?!not (?:a|an|the)\b)"
    r"|\s+until\s+(?:you |we )?(?=find|see|reach|get|there)"
    r"|\s+and\s+(?=(?:please |always |only |also )?(?:stay|keep|avoid|do not|never|follow|walk|go|use|take|make sure|"
    r"remain|"
    r"stick|find|look|search|get|show|bring|head|without|be)\b)"
    r"|\s+(?=(?:without (?:\w+ing|ever \w+ing)|avoiding|staying|keeping|following|sticking|remaining|never|do not|"
    r"keep|stay|"
    r"avoid|follow)\b)"
)

_GO = (
    r"walk|go|travel|drive|move|fly|head|navigate|roll|run|proceed|be|walking|going|traveling|travelling|driving|moving|"
    r"flying|heading|navigating|proceeding|being"
)
_FILL = r"(?:please |always |only |strictly |just |to |closely |you |must |should |make sure |that |not )*"
_REST = r"(?P<ground>[^,]+)"
#: Patterns that take clauses about ground out of a sentence, with whether the ground is wanted. Shunned ones come
#: first: "stay off the grass" must not be read as "stay".
GROUND_PATTERNS: tuple[tuple[bool, re.Pattern[str]], ...] = (
    (
        True,
        re.compile(rf"\s(?:do not|never|without(?: ever)?|not) (?:leave|leaving|step off|stepping off|stray from|"
                   rf"straying from|get off|getting off|depart from|wander off|wandering off|go off|going off) "
                   rf"{_REST}"),
    ),
    (
        False,
        re.compile(rf"\s(?:and |but )?{_FILL}(?:avoid|avoiding)(?: to)?(?: all| any)?"
                   r"(?: (?:walking|crossing|stepping|going|"
                   r"driving|travel(?:l)?ing|treading|entering|using|moving|flying|touching|the use of|being|contact "
                   r"with))?"
                   rf"(?: on| onto| over| across| through| into| in| near)? {_REST}"),
    ),
    (
        False,
        re.compile(r"\s(?:and |but )?(?:do not|never|without(?: ever)?|not|must not|may not|should not|can not|no) "
                   r"(?:cross|step|walk|go|drive|travel|tread|enter|touch|use|set foot|setting foot|run|move|fly|"
                   r"trample|be|"
                   r"crossing|stepping|walking|going|driving|travel(?:l)?ing|treading|entering|touching|using|running|"
                   r"moving|"
                   r"flying|trampling|being)(?: on| onto| over| across| through| into| in| upon| along)? " + _REST),
    ),
    (
        False,
        re.compile(rf"\s(?:and |but )?{_FILL}"
                   r"(?:stay|keep|staying|keeping|remain|remaining|steer|steering|walk|go|walking|"
                   r"going)(?: \w+)? (?:off|out of|away from|clear of|well clear of|far from) " + _REST),
    ),
    (False, re.compile(rf"\s(?:but |and )?not (?:on|onto|over|across|along|through|via) {_REST}")),
    (
        True,
        re.compile(rf"\s(?:and |but )?{_FILL}(?:stay|keep|remain|stick|staying|keeping|remaining|sticking)"
                   r"(?: \w+ly| only)?"
                   rf"(?: to| on| onto| along| by| within| inside| upon)(?: only)?(?: on)? {_REST}"),
    ),
    (
        True,
        re.compile(rf"\s(?:and |but )?{_FILL}(?:{_GO})(?: only| \w+ly| always)?"
                   rf"(?: on| onto| along| by| within| via| over| down| across| through)(?: only)?(?: on)? {_REST}"),
    ),
    (
        True,
        re.compile(rf"\s(?:and |but )?{_FILL}(?:use|using|take|taking|follow|following)(?: only| always)? {_REST}"),
    ),
    (True, re.compile(rf"\s(?:and |but )?(?:only )?(?:along|via|by way of|by means of|only on|only over) {_REST}")),
)  # fmt: skip

#: Places that mean where one is: they narrow nothing.
HERE = re.compile(
    r"\s(?:(?:close |near )?(?:to )?(?:near|around|close to|in|at|by|close by|within)\s)(?:here|me|us|this area|the "
    r"area|"
    r"my position|my location|this place|this neighborhood|this neighbourhood|the neighborhood|the neighbourhood|town|"
    r"the city|walking distance|the vicinity|peace|the open air|the open)(?=\s|$)"
    r"|\s(?:nearby|close by|around here|here|right now|right away|as soon as possible|as fast as possible|"
    r"outdoors|"
    r"please|for me|for us|today|tonight|quickly|asap|thanks|thank you|immediately|this afternoon|at once)(?=\s|$)"
    r"|\soutside(?=\s*(?:,|$))"
)

NEGATION_PATTERN = re.compile(
    r"\s(?:,\s)?(?:(?P<not_that>(?:that is |which is |it is |and |but )*(?:not|no|but not|other than|except|except for|"
    r"rather than|instead of|anything but)(?= (?:a|an|the|any|one of)\s)|other than|except for|except|rather than|"
    r"instead of)|(?:that (?:has|have) |with |where there (?:is|are) |and |but )*(?:without|no|not any|free of|away "
    r"from|"
    r"far from|far away from|with no|not (?:right |directly |too |very )?(?:near|close to|next to|under)|lacking)) "
    r"(?:too many |many |any |"
    r"other )?"
    r"(?P<what>(?:(?! that | which | where | near | under | to | , | with | and stay | but ).)+)"
)

RELATION_OF = {
    **dict.fromkeys(
        (
            "near", "near to", "close to", "next to", "beside", "besides", "by", "alongside", "adjacent to", "around",
            "at", "opposite", "across from", "in the vicinity of", "not far from", "within reach of", "right by",
            "right next to", "surrounded by", "along", "between", "nearby", "within sight of", "bordering", "outside",
            "outside of", "accompanied by", "to the left of", "to the right of", "attached to", "leaning against",
            "facing", "at the edge of", "overlooking", "with a view of", "with a view over", "next door to", "past",
        ),
        "near",
    ),
    **dict.fromkeys(
        ("under", "underneath", "beneath", "below", "in the shade of", "in the shadow of", "shaded by", "covered by",
         "sheltered by"),
        "under",
    ),
    **dict.fromkeys(("on", "on top of", "upon", "atop"), "on"),
    **dict.fromkeys(("in", "inside", "within", "in the middle of", "inside of", "in the center of", "amid"), "in"),
    **dict.fromkeys(("in front of", "right in front of"), "in_front"),
    **dict.fromkeys(("behind", "at the back of"), "behind"),
    **dict.fromkeys(("with", "that has", "which has", "that have", "having", "where there is", "where there are"),
    "with"),
}  # fmt: skip
_RELATIONS = "|".join(re.escape(words) for words in sorted(RELATION_OF, key=lambda words: -len(words)))
#: A relation and what leads to it: "that stands next to".
NEAR_PATTERN = re.compile(
    r"(?:^|\s)(?:,\s)?(?:(?:that|which|and) )?(?:(?:is|are|stands|sits|lies|standing|located|situated|sitting|"
    r"placed|"
    r"right|directly|just|very|must be|should be) )*"
    rf"(?P<relation>{_RELATIONS})(?=\s(?!foot\b|order\b|case\b|general\b|least\b|fact\b|time\b|my\b|the way\b|peace\b|"
    r"the shade\b(?! of)|the sun\b|the rain\b|a hurry\b|public\b|a hot\b|a rainy\b|the open\b|total\b|sale\b|bike\b|"
    r"duty\b))"
)
#: "Do not find me …", "I do not want …", but not "I do not want to hurry".
NOT_SOUGHT = re.compile(
    r"(?:^|, )(?:(?:i|we|you|please|robot|drone|hey|but|and|now) )*(?:do not|never|not)(?: ever| please| just)* "
    r"(?:find|locate|look for|search for|search|seek|show|give|fetch|reach|go to|navigate to|drive to|fly to|walk to|"
    r"head to|head for|go and find|(?:take|bring|lead|guide|get) (?:me|us) (?:to|a|an|the|any)|"
    r"(?:want|need|like|require)(?! to\b))\b|\b(?:anything|everything) but(?=\s)"
)
#: A word at the end of a clause that asks for more.
HANGING = re.compile(
    rf"(?:^|\s)(?P<word>{_RELATIONS}|avoid|avoiding|without|away from|far from|other than|rather than|instead of|"
    r"except for|except|not|no|and|or|of|for|from|to|into|onto|across|between|beyond|over|above|through|towards|"
    r"toward|after|before|than)(?:\s(?:a|an|the|some|any|my|our|your|this|that|its))*$"
)
#: Where the noun phrase ends and its purpose begins.
PURPOSE = re.compile(
    r"\s(?:to|for|where|that|which|so|because|since|i|we|you|who|when|in order|as)\s(?!the (?:left|right)\b)"
)

NP_END = word_set("np_end")
#: Words that may follow a head without making another of it.
ADJECTIVE_TAIL = word_set("adjective_tail")
GENERIC_HEADS = word_set("generic_heads")
STOP_WORDS = word_set("stop_words")
SMALL_TALK = word_set("small_talk")
INTANGIBLE = word_set("intangible")

_CLUSTERS_START = word_set("clusters_start")
_CLUSTERS_END = word_set("clusters_end")
_CONSONANTS = re.compile(r"[bcdfghjklmnpqrstvwxz]+")


_ODD_PAIRS = re.compile(r"(.)\1\1|q(?!u|$)|[jvxq]{2}|[bcdfgjkmpqvwxz]x|j[bcdfghklmnpqrstvwxz]")


def is_wordlike(word: str) -> bool:
    """Tell whether an unknown word could be English: letters, a vowel, no run of consonants that English lacks."""
    letters = word.replace("'", "").replace("-", "")
    if len(letters) < 3 or not letters.isalpha():
        return False
    if not letters.isascii():
        return True  # a name, perhaps
    if not re.search(r"[aeiouy]", letters) or _ODD_PAIRS.search(letters):
        return False
    return all(_run_fits(match, len(letters)) for match in _CONSONANTS.finditer(letters))


def _run_fits(match: re.Match[str], length: int) -> bool:
    run = match.group()
    if len(run) < 3:
        return True
    if match.start() == 0:
        return run[:3] in _CLUSTERS_START
    if match.end() == length:
        return run[-3:] in _CLUSTERS_END
    return len(run) <= 5
