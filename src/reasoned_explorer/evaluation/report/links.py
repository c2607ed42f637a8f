"""How a number is linked to its missions."""

from urllib.parse import urlencode


def link(**filters: object) -> str:
    """Return the address, inside the page, of the missions that a filter leaves; None is left out.

    Filters that the page understands: ``method``, ``level``, ``city``, ``place``, ``outcome`` (``success``, ``oracle``,
    ``seen``, ``small``, ``large`` or the key of a cause), ``radius`` (metres: success at this R), ``within`` (seconds:
    success with CT + TT up to it), ``versus`` with ``by`` (missions in which two methods differ in success or oracle
    success, or, with ``by=any``, all that both have).
    """
    return "#" + urlencode([(name, str(value)) for name, value in filters.items() if value is not None])
