"""What Kosmos-2 writes, in words."""

import pytest

from reasoned_explorer.calls.local.coding import without_marks

WRITTEN = {
    # As its authors show it.
    "<image> the picture </image><grounding> An image of<phrase> a snowman</phrase><object><patch_index_0044>"
    "<patch_index_0863></object> warming himself by<phrase> a fire</phrase><object><patch_index_0005>"
    "<patch_index_0911></object>.": "the picture An image of a snowman warming himself by a fire.",
    "<phrase> two benches</phrase><object><patch_index_0001><patch_index_0002></delimiter_of_multi_objects/>"
    "<patch_index_0003><patch_index_0004></object>, and a tree": "two benches, and a tree",
    # Marks that are not closed take no words with them.
    "<object> a bench <patch_index_0001> by</phrase> a path</s>": "a bench by a path",
    "a sign that reads 3 < 5 > 2": "a sign that reads 3 < 5 > 2",
    "<patch_index_0001>": "",
}


@pytest.mark.parametrize("text", WRITTEN)
def test_marks_are_left_out_and_words_are_not(text: str) -> None:
    assert without_marks(text) == WRITTEN[text]
